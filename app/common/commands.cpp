// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/commands.h"

#include <cctype>

namespace glissade::app {

namespace {

constexpr std::string_view kBundleAdjustment = "Bundle adjustment";
constexpr std::string_view kRecordings = "Recordings of cameras and an IMU";
constexpr std::string_view kWindows = "Sliding windows";
constexpr std::string_view kStudies = "Studies";

constexpr Command kCommands[] = {
    {"solve", "ba_solve", kBundleAdjustment, "FILE",
     "bundle adjustment of a BAL file, a COLMAP model or a simulated city"},
    {"check", "vio_check", kRecordings, "DIR",
     "say what is wrong with a recording before it is solved"},
    {"run", "vio_run", kRecordings, "DIR",
     "visual-inertial odometry from images: a trajectory, a page to look at", true},
    {"replay", "vio_replay", kRecordings, "DIR",
     "the same from tracked features (VIOTRACKS), with faults on request"},
    {"report", "traj_eval", kRecordings, "ESTIMATE REFERENCE",
     "judge a trajectory by a reference: ATE, RPE, a page to look at"},
    {"window", "window_solve", kWindows, "FILE",
     "solve the windows of a VIOWIN file: costs, times and their split"},
    {"sweep", "prior_weight_sweep", kStudies, "",
     "accuracy, iterations and time against the weight of pose priors"},
    {"gauge", "gauge_study", kStudies, "",
     "fixed, free or prior? Gauges compared in simulation and on recordings"},
};

bool IsOfWord(char c) {
  return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_';
}

}  // namespace

std::span<const Command> Commands() {
  return kCommands;
}

std::string CalledAs(std::string_view program, std::string_view argv0) {
  for (const Command& command : kCommands) {
    const std::string name = std::string("glissade ").append(command.name);
    if (command.program == program && argv0 == name) return name;
  }
  return std::string(program);
}

std::string WithCommandNames(std::string text) {
  for (const Command& command : kCommands) {
    const std::string name = std::string("glissade ").append(command.name);
    std::size_t at = 0;
    while ((at = text.find(command.program, at)) != std::string::npos) {
      const std::size_t end = at + command.program.size();
      const bool begins = at == 0 || !(IsOfWord(text[at - 1]) || text[at - 1] == '/');
      const bool ends = end == text.size() || !IsOfWord(text[end]);
      if (begins && ends) text.replace(at, command.program.size(), name);
      at += begins && ends ? name.size() : command.program.size();
    }
  }
  return text;
}

}  // namespace glissade::app
