// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <cstddef>
#include <cstring>
#include <type_traits>

#include "glissade/base/handle.h"
#include "glissade/base/status.h"

namespace glissade {

/// What a type must offer to be a robust loss: rho(s) of the squared whitened residual s = r' Omega
/// r and its first two derivatives, rho(0) = 0, rho'(0) = 1 for a loss that is quadratic near zero.
/// The cost of an edge is rho(s) / 2. Plain value, trivially copyable, at most 32 bytes.
///
///     struct GemanMcClure {
///       double width;
///       void Evaluate(double s, double rho[3]) const;   // rho, rho', rho''
///       Status Validate() const;                        // optional
///     };
// clang-format 14 takes concepts apart.
// clang-format off
template <class L>
concept LossType = std::is_trivially_copyable_v<L> && sizeof(L) <= 32 && alignof(L) <= 8 &&
                   requires(const L loss, double s, double* rho) { loss.Evaluate(s, rho); };
// clang-format on

/// A loss of any type, held by value. Default: the trivial loss rho(s) = s.
class Loss {
 public:
  Loss() = default;

  template <LossType L>
  Loss(const L& loss)  // NOLINT: implicit, `.loss = Huber{1.0}` is how it is written
      : type_(&kTypeInfo<L>),
        evaluate_([](const void* self, double s, double* rho) {
          static_cast<const L*>(self)->Evaluate(s, rho);
        }),
        validate_([](const void* self) -> Status {
          if constexpr (requires(const L& l) {
                          { l.Validate() } -> std::same_as<Status>;
                        }) {
            return static_cast<const L*>(self)->Validate();
          } else {
            static_cast<void>(self);
            return {};
          }
        }) {
    std::memcpy(storage_, &loss, sizeof(L));
  }

  /// True for rho(s) = s; the hot path then skips all of it.
  [[nodiscard]] bool trivial() const { return evaluate_ == nullptr; }

  /// rho[0..2] = rho(s), rho'(s), rho''(s).
  void Evaluate(double s, double rho[3]) const {
    if (trivial()) {
      rho[0] = s;
      rho[1] = 1.0;
      rho[2] = 0.0;
    } else {
      evaluate_(storage_, s, rho);
    }
  }

  [[nodiscard]] Status Validate() const { return trivial() ? Status() : validate_(storage_); }

  /// The loss's type, null for the trivial loss; As<L>() gives the value back.
  [[nodiscard]] const TypeInfo* type() const { return type_; }
  template <LossType L>
  [[nodiscard]] const L* As() const {
    return type_ == &kTypeInfo<L> ? reinterpret_cast<const L*>(storage_) : nullptr;
  }

  friend bool operator==(const Loss& a, const Loss& b) {
    return a.type_ == b.type_ && std::memcmp(a.storage_, b.storage_, sizeof(storage_)) == 0;
  }

 private:
  const TypeInfo* type_ = nullptr;
  void (*evaluate_)(const void*, double, double*) = nullptr;
  Status (*validate_)(const void*) = nullptr;
  alignas(8) std::byte storage_[32] = {};
};

}  // namespace glissade
