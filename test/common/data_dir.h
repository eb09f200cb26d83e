// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace glissade::test {

/// The source tree that the tests were built from.
std::filesystem::path SourceDir();

/// Where the large data sets are: $GLISSADE_DATA, else beside the source tree. Need not exist:
/// tests of what lies there skip themselves.
std::filesystem::path DataDir();

}  // namespace glissade::test
