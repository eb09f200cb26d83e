// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/program.h"

#include <fmt/format.h>

#include <cstdio>
#include <exception>
#include <filesystem>
#include <memory>
#include <new>
#include <optional>
#include <string_view>
#include <utility>

#include "common/commands.h"
#include "common/interrupt.h"
#include "common/nearest_name.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/version.h"

namespace glissade::app {

namespace {

namespace fs = std::filesystem;

/// Whether a file can be created or replaced at the path; nothing is left behind.
Status CheckWritable(const std::string& option, const std::string& path) {
  OutputFile probe;
  if (Status status = probe.Open(path); !status.ok()) {
    return {status.code(), fmt::format("{}: {}", option, status.message())};
  }
  return {};
}

/// A name that ends in '/' is one also where nothing is there yet.
bool IsFolder(const std::string& path) {
  std::error_code error;
  return path.ends_with('/') || fs::is_directory(path, error);
}

/// Whether files can be created in a folder, or the folder itself in the one above.
Status CheckFolder(const std::string& option, const std::string& path) {
  fs::path folder(path);
  if (!folder.has_filename()) folder = folder.parent_path();
  std::error_code error;
  if (!fs::exists(folder, error)) folder = folder.parent_path();
  if (folder.empty()) folder = ".";
  return CheckWritable(option, (folder / ".glissade").string());
}

bool SameFile(const std::string& a, const std::string& b) {
  if (a == "-" || b == "-") return a == b;
  std::error_code error;
  if (fs::weakly_canonical(a, error) != fs::weakly_canonical(b, error)) return false;
  return !fs::exists(a, error) || fs::is_regular_file(a, error);  // a device takes both
}

std::string FirstOf(const std::string& names) {
  return names.substr(0, names.find(','));
}

Outcome Guarded(const std::function<Outcome()>& work) {
  try {
    return work();
  } catch (const std::bad_alloc&) {
    return {kExitFailed, "out of memory"};
  } catch (const std::exception& error) {
    return {kExitFailed, error.what()};
  }
}

}  // namespace

Outcome BadInput(std::string why) {
  return {kExitBadInput, std::move(why)};
}

Outcome BadInput(const Status& status) {
  return {kExitBadInput, status.message()};
}

Outcome Failed(const Status& status) {
  return {kExitFailed, status.message()};
}

Program::Program(const char* name, const char* description, const char* footer)
    : cli_(description, name) {
  cli_.footer(footer);
  cli_.formatter(std::make_shared<HelpFormatter>());
  cli_.set_help_flag("-h,--help", "Print this and exit");
  cli_.set_version_flag(
      "--version", [this] { return VersionText(cli_.get_name()); },
      "Print version, instruction sets and what was compiled in, and exit");
}

CLI::Option* Program::AddOutput(const std::string& name, std::string* path,
                                const std::string& help) {
  outputs_.push_back({FirstOf(name), path, true});
  return cli_.add_option(name, *path, help + "; -: to standard output")->type_name("FILE");
}

CLI::Option* Program::AddOutputFile(const std::string& name, std::string* path,
                                    const std::string& help) {
  outputs_.push_back({FirstOf(name), path, false});
  return cli_.add_option(name, *path, help)->type_name("FILE");
}

CLI::Option* Program::AddOutputPath(const std::string& name, std::string* path,
                                    const std::string& help) {
  outputs_.push_back({FirstOf(name), path, false, true});
  return cli_.add_option(name, *path, help)->type_name("PATH");
}

Status Program::CheckOutputs() const {
  for (std::size_t i = 0; i < outputs_.size(); ++i) {
    const Output& output = outputs_[i];
    if (cli_.count(output.option) == 0) continue;
    const auto refused = [&](const std::string& why) {
      return Status(StatusCode::kInvalidArgument, output.option + ": " + why);
    };
    if (output.path->empty()) return refused("the name of the file is empty");
    for (std::size_t j = 0; j < i; ++j) {
      if (!outputs_[j].path->empty() && SameFile(*output.path, *outputs_[j].path)) {
        return refused("names the same file as " + outputs_[j].option + ", " + *output.path);
      }
    }
    if (*output.path == "-") {
      if (!output.to_stdout) return refused("needs a file, not standard output (-)");
      continue;
    }
    const bool folder = output.may_be_folder && IsFolder(*output.path);
    const Status s = folder ? CheckFolder(output.option, *output.path)
                            : CheckWritable(output.option, *output.path);
    if (!s.ok()) return s;
  }
  return {};
}

/// What is said of an option that the program does not have; empty where there is none. CLI11 would
/// rather speak of what is missing.
std::string Program::UnknownOption() const {
  for (const std::string& word : cli_.remaining()) {
    if (!word.starts_with('-') || word == "-" || word == "--") continue;
    const std::string name = word.substr(0, word.find('='));
    std::vector<std::string> own;
    for (const CLI::Option* option : cli_.get_options()) {
      if (option->nonpositional()) own.push_back("--" + option->get_lnames().front());
    }
    std::string why = fmt::format("unknown option {}", name);
    const std::vector<std::string_view> names(own.begin(), own.end());
    const std::string_view meant = NearestName(name, names);
    if (!meant.empty()) why += fmt::format("; did you mean {}?", meant);
    return why;
  }
  return "";
}

int Program::Say(const std::string& why, int exit_code) const {
  std::string line = fmt::format("{}: {}", cli_.get_name(), why);
  for (char& c : line) {
    if (c == '\n' || c == '\r') c = ' ';
  }
  std::fflush(stdout);
  std::fprintf(stderr, "%s\n", line.c_str());
  return exit_code;
}

int Program::Run(int argc, char** argv, const std::function<Outcome()>& work) {
  // Whoever reads through a pipe sees every line when it is there.
  std::setvbuf(stdout, nullptr, _IOLBF, 1 << 16);
  if (const std::string name = CalledAs(cli_.get_name(), argc > 0 ? argv[0] : "");
      name != cli_.get_name()) {
    cli_.name(name);
    cli_.formatter(std::make_shared<HelpFormatter>(WithCommandNames));
  }
  try {
    cli_.parse(argc, argv);
  } catch (const CLI::Success& done) {
    return cli_.exit(done);
  } catch (const CLI::ParseError& error) {
    const std::string unknown = UnknownOption();
    return Say(fmt::format("{} (see --help)", unknown.empty() ? error.what() : unknown),
               kExitBadInput);
  }
  if (const Status s = CheckOutputs(); !s.ok()) return Say(s.message(), kExitBadInput);
  for (const Output& output : outputs_) {
    if (*output.path == "-") KeepStdoutForData();
  }
  CatchInterrupts();
  Outcome outcome = Guarded(work);
  if (outcome.exit_code == kExitOk && (std::fflush(stdout) != 0 || std::ferror(stdout) != 0)) {
    outcome = {kExitFailed, "standard output cannot be written"};
  }
  if (outcome.exit_code == kExitOk && Interrupted()) {
    outcome = {InterruptedExitCode(), "interrupted: this is what there was until then"};
  }
  return Report(outcome);
}

int Program::Report(const Outcome& outcome) const {
  return outcome.exit_code == kExitOk ? kExitOk : Say(outcome.why, outcome.exit_code);
}

}  // namespace glissade::app
