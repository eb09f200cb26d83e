// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <span>
#include <string>
#include <string_view>

/// \file
/// The subcommands of `glissade`, each a program of its own: `glissade solve` starts ba_solve
/// beside it. So a command loads the libraries that it needs itself, and no others.
namespace glissade::app {

struct Command {
  std::string_view name;       ///< "solve"
  std::string_view program;    ///< "ba_solve"
  std::string_view group;      ///< what its neighbours in the help are about
  std::string_view arguments;  ///< "FILE"
  std::string_view help;       ///< one line
  bool needs_vision = false;   ///< built only where OpenCV is
};

/// In the order of the help, group by group.
std::span<const Command> Commands();

/// "glissade solve" where `program` has been started under that name (argv[0]), else the program's
/// own name.
std::string CalledAs(std::string_view program, std::string_view argv0);

/// A text of the help with "glissade solve" in place of "ba_solve", and so for all of them.
std::string WithCommandNames(std::string text);

}  // namespace glissade::app
