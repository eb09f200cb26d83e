// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <initializer_list>
#include <optional>
#include <string>
#include <string_view>

#include "glissade/base/status.h"

/// \file
/// How all apps treat their command line: what cannot be done is said in one line on stderr, with
/// exit code 2, before anything is written.
namespace glissade::app {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;    ///< the work was begun and could not be finished
inline constexpr int kExitBadInput = 2;  ///< option or file that makes no sense; nothing written

/// "NAME: WHY" in one line on stderr. Returns `exit_code`, to be returned from main.
int Refuse(std::string_view name, std::string_view why, int exit_code = kExitBadInput);

/// Parses the command line. A value means that the program ends with it: 0 after --help, 2 after an
/// error, which has been printed.
std::optional<int> Parse(CLI::App& app, int argc, char** argv);

/// The first that is not ok, else ok.
Status FirstError(std::initializer_list<Status> checks);

/// "--name: must be a finite number >= low, not x" where it is not.
Status CheckAtLeast(std::string_view name, double x, double low);
/// "--name: must be an integer from low to high, not x" where it is not.
Status CheckRange(std::string_view name, long long x, long long low, long long high);
/// Whether a file can be created or replaced at `path`; empty: nothing to write, ok.
Status CheckWritable(std::string_view name, const std::string& path);
/// Refuses two options that name the same file to write.
Status CheckDifferent(std::string_view name_a, const std::string& path_a, std::string_view name_b,
                      const std::string& path_b);

}  // namespace glissade::app
