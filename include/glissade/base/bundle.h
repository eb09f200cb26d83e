// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <utility>

namespace glissade::internal {

template <std::size_t I, class T>
struct BundleItem {
  T value;
};
template <class Indices, class... T>
struct BundleOf;
template <std::size_t... I, class... T>
struct BundleOf<std::index_sequence<I...>, T...> : BundleItem<I, T>... {};

/// As std::tuple, which however writes zeros into members that nothing else initializes: here they
/// stay as they are.
template <class... T>
using Bundle = BundleOf<std::index_sequence_for<T...>, T...>;

template <std::size_t I, class T>
T& Get(BundleItem<I, T>& bundle) {
  return bundle.value;
}
template <std::size_t I, class T>
const T& Get(const BundleItem<I, T>& bundle) {
  return bundle.value;
}

}  // namespace glissade::internal
