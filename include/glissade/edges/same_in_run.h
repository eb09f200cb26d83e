// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <type_traits>

#include "glissade/edges/lanes.h"

/// \file
/// Whether edges that share a run agree in all members that are not in kLanes: a pack takes those
/// of its first edge for all (edges/evaluate_in_packs.h).
namespace glissade::internal {

/// What a SameSensor or SameInRun compares with, unless there are several of that name.
template <class Result, class Class, class Other>
std::remove_cvref_t<Other> ComparedWith(Result (Class::*)(Other) const);

/// Finds the one for E among several.
template <class E, class Result, class Class>
void ComparesWith(Result (Class::*)(const E&) const);

template <class Base>
struct WithOneMore : Base {
  char more;
};
/// Whether an edge has no member that its base does not know: it is as large, and the base's
/// padding has no room for one.
template <class E, class Base>
inline constexpr bool kAddsNothing = [] {
  if constexpr (std::is_same_v<E, Base>) {
    return true;
  } else if constexpr (std::is_base_of_v<Base, E>) {
    return sizeof(E) == sizeof(Base) && sizeof(WithOneMore<Base>) > sizeof(Base);
  } else {
    return false;
  }
}();

/// Whether a SameInRun of E, or else its SameSensor, knows all of E, or kLanes does. One that is
/// inherited does not know what E adds.
template <class E>
inline constexpr bool kKnowsWhatDiffers = [] {
  if constexpr (kAllInLanes<E>) {
    return true;
  } else if constexpr (requires(const E& e) { e.SameInRun(e); }) {
    if constexpr (requires { ComparedWith(&E::SameInRun); }) {
      return kAddsNothing<E, decltype(ComparedWith(&E::SameInRun))>;
    } else {
      return requires {
        ComparesWith<E>(&E::SameInRun);
      };
    }
  } else if constexpr (requires(const E& e) { e.SameSensor(e); }) {
    if constexpr (requires { ComparedWith(&E::SameSensor); }) {
      return kAddsNothing<E, decltype(ComparedWith(&E::SameSensor))>;
    } else {
      return requires {
        ComparesWith<E>(&E::SameSensor);
      };
    }
  } else {
    return false;
  }
}();

}  // namespace glissade::internal
