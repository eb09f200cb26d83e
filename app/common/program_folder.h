// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <filesystem>

namespace glissade::app {

/// The folder that the running program lies in, links resolved; where the system does not tell, the
/// one that programs are installed in.
std::filesystem::path ProgramFolder();

}  // namespace glissade::app
