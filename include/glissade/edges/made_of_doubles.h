// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <type_traits>
#include <utility>

/// \file
/// Whether a type is doubles and nothing else: what members of kLanes must be (edges/lanes.h), as
/// their bytes are read as doubles.
namespace glissade::internal {

template <class M>
constexpr bool IsMadeOfDoubles();

/// Initializes a member that is no aggregate (braces go on into those), if it is made of doubles,
/// or if it is not.
template <bool kDoubles>
struct SomeMember {
  // clang-format off
  template <class U>
    requires(!std::is_aggregate_v<U>) && (IsMadeOfDoubles<U>() == kDoubles)
  operator U() const;  // NOLINT: implicit
  // clang-format on
};

/// Whether the aggregate M has something else after as many members made of doubles.
template <class M, std::size_t... Before>
constexpr bool HasOtherAfter(std::index_sequence<Before...>) {
  return requires {
    M{(static_cast<void>(Before), std::declval<SomeMember<true>>())...,
      std::declval<SomeMember<false>>()};
  };
}

template <class M, std::size_t... N>
constexpr bool HasOther(std::index_sequence<N...>) {
  return (HasOtherAfter<M>(std::make_index_sequence<N>{}) || ...);
}

/// Whether as many doubles as there is room for initialize M: matrices and quaternions of Eigen,
/// whose constructors do not tell the scalar.
template <class M, std::size_t... N>
constexpr bool TakesDoubles(std::index_sequence<N...>) {
  if constexpr (requires { typename M::Scalar; }) {
    if (!std::is_same_v<typename M::Scalar, double>) return false;
  }
  return requires(const double& x) {
    M{(static_cast<void>(N), x)...};
  };
}

/// Whether M is its array `data`: Pose, vertices.
template <class M>
constexpr bool IsItsData() {
  if constexpr (requires { sizeof(M::data); }) {
    return sizeof(M::data) == sizeof(M) && IsMadeOfDoubles<decltype(M::data)>();
  } else {
    return false;
  }
}

/// double, arrays of it, structs of these, and classes that tell: those that as many doubles
/// initialize, or that are their array `data`.
template <class M>
constexpr bool IsMadeOfDoubles() {
  if constexpr (std::is_array_v<M>) {
    return IsMadeOfDoubles<std::remove_all_extents_t<M>>();
  } else if constexpr (!std::is_class_v<M>) {
    return std::is_same_v<std::remove_cv_t<M>, double>;
  } else if constexpr (std::is_empty_v<M> || sizeof(M) % sizeof(double) != 0 ||
                       alignof(M) % alignof(double) != 0 || !std::is_trivially_destructible_v<M>) {
    return false;
  } else {
    constexpr std::size_t kCount = sizeof(M) / sizeof(double);
    if constexpr (std::is_aggregate_v<M>) {
      return !HasOther<M>(std::make_index_sequence<kCount>{});
    } else {
      return IsItsData<M>() || TakesDoubles<M>(std::make_index_sequence<kCount>{});
    }
  }
}

template <class M>
inline constexpr bool kMadeOfDoubles = IsMadeOfDoubles<M>();

}  // namespace glissade::internal
