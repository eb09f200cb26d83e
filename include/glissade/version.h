// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

/// \file
/// The version of the headers. CMakeLists.txt reads it from here. Before 1.0 a minor version may
/// change interfaces and the name of shared libraries (SOVERSION is MAJOR.MINOR); a patch changes
/// neither.

// NOLINTBEGIN(cppcoreguidelines-macro-usage): for the preprocessor of those who support two
// versions
#define GLISSADE_VERSION_MAJOR 0
#define GLISSADE_VERSION_MINOR 1
#define GLISSADE_VERSION_PATCH 0
/// 10000 * major + 100 * minor + patch, to be compared.
#define GLISSADE_VERSION_NUMBER \
  (10000 * GLISSADE_VERSION_MAJOR + 100 * GLISSADE_VERSION_MINOR + GLISSADE_VERSION_PATCH)
// NOLINTEND(cppcoreguidelines-macro-usage)
