// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The front door: `glissade solve ...` becomes the program ba_solve beside this one.
#include <fmt/format.h>
#include <unistd.h>

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <vector>

#include "common/commands.h"
#include "common/nearest_name.h"
#include "common/program.h"
#include "common/program_folder.h"

namespace glissade::app {
namespace {

constexpr const char* kName = "glissade";

constexpr const char* kDescription =
    "Sparse bundle adjustment and sliding-window visual-inertial estimation.";

constexpr const char* kExamples =
    R"(
'glissade help COMMAND' or 'glissade COMMAND --help' says all about one; each is also a program of its
own, named in brackets. In all of them --json FILE writes the figures, and after Ctrl-C what there is
until then is written. Besides there are make_data and sim_images, which simulate data, testMonoBA, the
smallest example, and marginal_study.

Examples:
  glissade solve problem-49-7776-pre.txt.gz --loss huber:2 --output solved.ply
  glissade check data/flight
  glissade replay data/flight --output flight.tum
  glissade report flight.tum data/flight --report flight.html
  glissade run MH_05 --output mh05.tum --report mh05.html
  glissade help solve

Exit code: that of the command (0, 1 where its work failed, 130 after Ctrl-C); 2 where a command or an
option makes no sense.)";

std::string Footer() {
  std::string text;
  std::string_view group;
  for (const Command& command : Commands()) {
    if (command.group != group) text += fmt::format("{}:\n", command.group);
    group = command.group;
    text += fmt::format("  {:<8}{} [{}]\n", command.name, command.help, command.program);
  }
  return text + kExamples;
}

struct Options {
  std::string command;
};

void AddOptions(Program& program, Options& o) {
  program.cli().add_option("COMMAND", o.command, "One of those below, or help")->required();
}

/// Becomes the program; comes back only where that cannot be.
Outcome Start(const Command& command, const std::vector<std::string>& arguments) {
  const std::string path = (ProgramFolder() / command.program).string();
  std::string name = fmt::format("{} {}", kName, command.name);
  std::vector<std::string> texts = arguments;
  std::vector<char*> argv = {name.data()};
  for (std::string& text : texts)
    argv.push_back(text.data());
  argv.push_back(nullptr);
  std::fflush(nullptr);
  execv(path.c_str(), argv.data());
  const int error = errno;
  if (error != ENOENT) {
    return {kExitFailed, fmt::format("{}: {}: {}", command.name, path, std::strerror(error))};
  }
#ifdef GLISSADE_HAVE_VISION
  const char* vision = "it has a package of its own (glissade-vision), which is not installed";
#else
  const char* vision = "this glissade was built without it (it needs OpenCV and yaml-cpp)";
#endif
  return BadInput(fmt::format("{}: there is no {}: {}", command.name, path,
                              command.needs_vision ? vision : "it was not built or not installed"));
}

Outcome Unknown(const std::string& word) {
  std::vector<std::string_view> names = {"help"};
  for (const Command& command : Commands())
    names.push_back(command.name);
  std::string_view meant = NearestName(word, names);
  for (const Command& command : Commands()) {
    if (command.program == word) meant = command.name;
  }
  std::string why = fmt::format("there is no command '{}'", word);
  if (!meant.empty()) why += fmt::format("; did you mean '{}'?", meant);
  return BadInput(why + " (see --help)");
}

/// The command's work. `help` alone is none: main() has it.
Outcome Run(const std::string& word, std::vector<std::string> arguments) {
  std::string name = word;
  if (word == "help") {
    if (arguments.size() != 1) return BadInput("help: takes one command (see --help)");
    name = arguments[0];
    arguments = {"--help"};
  }
  for (const Command& command : Commands()) {
    if (command.name == name) return Start(command, arguments);
  }
  return Unknown(name);
}

}  // namespace
}  // namespace glissade::app

int main(int argc, char** argv) {
  using namespace glissade::app;
  const std::string footer = Footer();
  Program program(kName, kDescription, footer.c_str());
  const std::vector<std::string> words(argv + 1, argv + argc);
  // Its own options come before a command; what comes after it is the command's.
  const bool has_command = !words.empty() && !words[0].starts_with('-');
  if (!has_command) {
    return program.Main<Options>(argc, argv, AddOptions,
                                 [](const Options& o) { return Run(o.command, {}); });
  }
  const bool about_all = words[0] == "help" && (words.size() == 1 || words[1] == "help");
  if (about_all) {
    std::string help = "--help";
    char* asks_for_help[] = {argv[0], help.data()};
    return program.Main<Options>(2, asks_for_help, AddOptions, [](Options&) { return Outcome(); });
  }
  return program.Report(Run(words[0], {words.begin() + 1, words.end()}));
}
