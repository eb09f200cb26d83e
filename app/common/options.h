// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <CLI/CLI.hpp>
#include <cstdint>
#include <functional>
#include <initializer_list>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "glissade/base/status.h"

/// \file
/// Options of all apps. What an option cannot take is said by the option, as it is read:
/// "--threads: must be an integer from 1 to 1024, not 0". Numbers are read whole: no "10x", no "",
/// no octal.
namespace glissade::app {

CLI::Option* AddInteger(CLI::App& cli, const std::string& name, int* value, int low, int high,
                        const std::string& help);
/// --seed N, "Seed of WHAT (default 1)": an integer from 0 to 4294967295.
CLI::Option* AddSeed(CLI::App& cli, std::uint32_t* value, const std::string& what);
/// A number from low to high, both included and finite.
CLI::Option* AddNumber(CLI::App& cli, const std::string& name, double* value, double low,
                       double high, const std::string& help);
/// Numbers separated by commas, at least one.
CLI::Option* AddNumbers(CLI::App& cli, const std::string& name, std::vector<double>* values,
                        double low, double high, const std::string& help);
/// One of some words.
CLI::Option* AddChoice(CLI::App& cli, const std::string& name, std::string* value,
                       std::vector<std::string> words, const std::string& help);

/// "none, huber or tukey".
std::string Listed(const std::vector<std::string>& words);

/// The number that a text is, as above. Refuses with "NAME: must be a number from ...".
Result<double> ParseNumber(std::string_view name, std::string_view text, double low, double high);

/// The first that is not ok, else ok.
Status FirstError(std::initializer_list<Status> checks);

/// Throws what CLI11 reports as a wrong value of an option, with a message that names it.
[[noreturn]] void RefuseOption(const std::string& message);

/// Help of at most 96 columns: descriptions are broken between words. scripts/help_text.py reads
/// it, and makes manual pages and completions of it.
class HelpFormatter : public CLI::Formatter {
 public:
  using Rewrite = std::function<std::string(std::string)>;
  /// `rewrite` has the last word on all texts.
  explicit HelpFormatter(Rewrite rewrite = nullptr) : rewrite_(std::move(rewrite)) {}

  std::string make_help(const CLI::App* cli, std::string name,
                        CLI::AppFormatMode mode) const override;
  std::string make_option_name(const CLI::Option* option, bool is_positional) const override;
  std::string make_option_opts(const CLI::Option* option) const override;
  std::string make_option_desc(const CLI::Option* option) const override;

 private:
  Rewrite rewrite_;
};

}  // namespace glissade::app
