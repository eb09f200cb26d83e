// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string_view>

namespace glissade::app {

/// The name that somebody may have meant who typed `word`: one that begins with it, or differs by
/// at most two letters that are missing, wrong, too many or swapped with their neighbour (by one in
/// words of up to four letters). Empty where there is none.
std::string_view NearestName(std::string_view word, std::span<const std::string_view> names);

}  // namespace glissade::app
