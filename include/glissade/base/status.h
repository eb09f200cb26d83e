// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <concepts>
#include <string>
#include <type_traits>
#include <utility>

#include "glissade/base/handle.h"

/// \file
/// Errors are values: a call that can fail on what the caller gave it returns a Status or a
/// Result<T>, names the culprit, and leaves the state as it was. Nothing here throws.
namespace glissade {

enum class StatusCode {
  kOk = 0,
  kInvalidArgument,   ///< an argument or option that makes no sense
  kUnknownHandle,     ///< null, removed, or of another graph
  kNotFinite,         ///< NaN or Inf where a number is required
  kNotPositive,       ///< information not positive semi-definite, sigma not positive
  kDuplicate,         ///< the same observation twice
  kEliminatedPair,    ///< an edge between two eliminated vertices
  kRepeatedVertex,    ///< one vertex twice in one edge
  kUnderPrior,        ///< would take a marginal prior with it
  kNothingToSolve,    ///< no edge, and so no cost
  kSingular,          ///< a block without information that would have to be inverted
  kEvaluationFailed,  ///< an edge has no value at this point
  kIoError,           ///< a file cannot be opened, read or written
  kParseError,        ///< a file's content is malformed
  kOutOfMemory,       ///< std::bad_alloc on the way; the message is short: nothing is allocated
};

std::string_view ToString(StatusCode code);

/// Outcome of a call: kOk, or what went wrong and with whom.
class Status {
 public:
  Status() = default;
  Status(StatusCode code, std::string message) : code_(code), message_(std::move(message)) {}
  Status(StatusCode code, std::string message, AnyVertex culprit)
      : code_(code), message_(std::move(message)), vertex_(culprit) {}
  Status(StatusCode code, std::string message, AnyEdge culprit, AnyEdge other = {})
      : code_(code), message_(std::move(message)), edge_(culprit), other_edge_(other) {}
  Status(StatusCode code, std::string message, AnyVertex culprit, AnyEdge edge)
      : code_(code), message_(std::move(message)), vertex_(culprit), edge_(edge) {}

  [[nodiscard]] bool ok() const { return code_ == StatusCode::kOk; }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] StatusCode code() const { return code_; }
  /// One line for people; empty when ok.
  [[nodiscard]] const std::string& message() const { return message_; }
  /// The vertex or edge at fault; null where there is none. A duplicate names both edges.
  [[nodiscard]] AnyVertex vertex() const { return vertex_; }
  [[nodiscard]] AnyEdge edge() const { return edge_; }
  [[nodiscard]] AnyEdge other_edge() const { return other_edge_; }

 private:
  StatusCode code_ = StatusCode::kOk;
  std::string message_;
  AnyVertex vertex_;
  AnyEdge edge_;
  AnyEdge other_edge_;
};

/// A T or the Status that says why there is none.
///
/// Converts to what T converts to, and to a default-constructed T on failure: for handles that is
/// the null handle, which every call refuses, so `graph.AddEdge(e, {graph.AddVertex(v), ...})` can
/// be written straight down and still cannot go wrong unnoticed.
template <class T>
class [[nodiscard]] Result {
 public:
  Result(T value) : value_(std::move(value)) {}         // NOLINT: implicit by design
  Result(Status status) : status_(std::move(status)) {  // NOLINT: implicit by design
    if (status_.ok()) status_ = Status(StatusCode::kInvalidArgument, "Result without a value");
  }

  [[nodiscard]] bool ok() const { return status_.ok(); }
  explicit operator bool() const { return ok(); }
  [[nodiscard]] const Status& status() const { return status_; }

  /// The value; a default-constructed T when !ok().
  [[nodiscard]] const T& value() const& { return value_; }
  [[nodiscard]] T& value() & { return value_; }
  // By value from a temporary: `for (x : graph.EdgesOf(v).value())` must not loop over what is
  // gone.
  [[nodiscard]] T value() && { return std::move(value_); }
  const T& operator*() const& { return value_; }
  T& operator*() & { return value_; }
  T operator*() && { return std::move(value_); }
  const T* operator->() const { return &value_; }
  T* operator->() { return &value_; }

  template <class U>
  requires(!std::same_as<U, bool> && !std::same_as<std::remove_cvref_t<U>, Result> &&
           !std::same_as<U, Status> && std::convertible_to<const T&, U>)
  operator U() const {  // NOLINT: implicit by design
    return static_cast<U>(value_);
  }
  /// The same for what can only be moved (a Graph).
  operator T() && requires(!std::copy_constructible<T>) {  // NOLINT: implicit by design
    return std::move(value_);
  }

 private:
  T value_{};
  Status status_;
};

}  // namespace glissade
