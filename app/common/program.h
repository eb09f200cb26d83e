// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <functional>
#include <string>
#include <vector>

#include "glissade/base/status.h"

namespace glissade::app {

inline constexpr int kExitOk = 0;
inline constexpr int kExitFailed = 1;    ///< the work was begun and could not be finished
inline constexpr int kExitBadInput = 2;  ///< option or file that makes no sense; nothing written

/// What became of the work: where it went wrong, why, in one line.
struct Outcome {
  int exit_code = kExitOk;
  std::string why;
};
Outcome BadInput(std::string why);
Outcome BadInput(const Status& status);
Outcome Failed(const Status& status);

/// What all apps have in common: the command line, --help, --version, files to write, interrupts,
/// exit codes. What cannot be done is said in one line on stderr, with exit code 2, before anything
/// is written.
class Program {
 public:
  /// The name is that of the executable; description and footer are shown by --help. Started by
  /// `glissade`, it goes by its subcommand's name (commands.h).
  Program(const char* name, const char* description, const char* footer);
  Program(const Program&) = delete;
  Program& operator=(const Program&) = delete;

  CLI::App& cli() { return cli_; }

  /// An option for a file to write; "-" is standard output, and text for people goes to standard
  /// error then. No two options may name one file, and all must be writable when work begins. A
  /// name may be followed by a former one, which is taken too and not shown: "--output,--out".
  CLI::Option* AddOutput(const std::string& name, std::string* path, const std::string& help);
  /// --json FILE, the figures of a run.
  void AddJson(std::string* path) { AddOutput("--json", path, "Write the figures (JSON) to FILE"); }
  /// The same, but not to standard output (what may be compressed).
  CLI::Option* AddOutputFile(const std::string& name, std::string* path, const std::string& help);
  /// A file to write, or a folder.
  CLI::Option* AddOutputPath(const std::string& name, std::string* path, const std::string& help);

  /// Parses, runs the work, and gives what main returns. Exceptions end here.
  int Run(int argc, char** argv, const std::function<Outcome()>& work);
  /// Says what became of work that was done without Run, likewise, and gives what main returns.
  int Report(const Outcome& outcome) const;
  /// All of main: options that `add` puts on the command line, for `work`.
  template <class Options, class Add, class Work>
  int Main(int argc, char** argv, const Add& add, const Work& work) {
    Options options;
    add(*this, options);
    return Run(argc, argv, [&] { return work(options); });
  }

 private:
  struct Output {
    std::string option;
    const std::string* path;
    bool to_stdout;
    bool may_be_folder = false;
  };
  [[nodiscard]] Status CheckOutputs() const;
  [[nodiscard]] std::string UnknownOption() const;
  int Say(const std::string& why, int exit_code) const;

  CLI::App cli_;
  std::vector<Output> outputs_;
};

}  // namespace glissade::app
