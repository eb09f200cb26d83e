// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <chrono>
#include <string>

namespace glissade::app {

/// One line on the terminal that is written over while something takes long, and gone afterwards.
/// On standard error; where that is no terminal, nothing is shown.
class StatusLine {
 public:
  StatusLine();
  ~StatusLine() { Clear(); }
  StatusLine(const StatusLine&) = delete;
  StatusLine& operator=(const StatusLine&) = delete;

  /// Shows the text instead of the one before, cut to the width of a terminal; not in the first
  /// second, and not more than five times a second.
  void Show(const std::string& text);
  /// Shows "WHAT, 34 %" likewise.
  void ShowPart(const std::string& what, double part);
  /// Shows the text at once, before something of unknown length.
  void ShowNow(const std::string& text);
  /// Before anything else is printed.
  void Clear();

 private:
  using Clock = std::chrono::steady_clock;
  bool on_terminal_;
  bool shown_ = false;
  Clock::time_point next_;  // nothing before
};

}  // namespace glissade::app
