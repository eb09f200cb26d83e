// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/status_line.h"

#include <fmt/format.h>
#include <unistd.h>

#include <algorithm>
#include <cstdio>

namespace glissade::app {

using std::chrono::milliseconds;

StatusLine::StatusLine()
    : on_terminal_(isatty(STDERR_FILENO) == 1), next_(Clock::now() + milliseconds(1000)) {}

void StatusLine::Show(const std::string& text) {
  if (Clock::now() >= next_) ShowNow(text);
}

void StatusLine::ShowNow(const std::string& text) {
  constexpr std::size_t kWidth = 79;
  if (!on_terminal_) return;
  std::fflush(stdout);
  // To the beginning of the line, the text, and nothing behind it.
  fmt::print(stderr, "\r{}\x1b[K", text.substr(0, kWidth));
  std::fflush(stderr);
  shown_ = true;
  next_ = std::max(next_, Clock::now() + milliseconds(200));
}

void StatusLine::ShowPart(const std::string& what, double part) {
  Show(fmt::format("{}, {:.0f} %", what, 100.0 * part));
}

void StatusLine::Clear() {
  if (!shown_) return;
  fmt::print(stderr, "\r\x1b[K");
  std::fflush(stderr);
  shown_ = false;
}

}  // namespace glissade::app
