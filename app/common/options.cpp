// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "common/options.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>
#include <sstream>
#include <utility>

namespace glissade::app {

namespace {

/// CLI11's own message would begin with the option's name once more.
class WrongValue : public CLI::ParseError {
 public:
  explicit WrongValue(std::string message)
      : ParseError("WrongValue", std::move(message), CLI::ExitCodes::ValidationError) {}
};

template <class T>
bool ReadWhole(std::string_view text, T* value) {
  const char* end = text.data() + text.size();
  const auto [rest, error] = std::from_chars(text.data(), end, *value);
  return error == std::errc() && rest == end;
}

template <class T>
CLI::Option* AddWhole(CLI::App& cli, const std::string& name, T* value, T low, T high,
                      const std::string& help) {
  return cli
      .add_option_function<std::string>(
          name,
          [=](const std::string& text) {
            T read{};
            if (!ReadWhole(text, &read) || read < low || read > high) {
              RefuseOption(fmt::format("{}: must be an integer from {} to {}, not '{}'", name, low,
                                       high, text));
            }
            *value = read;
          },
          help)
      ->type_name("N");
}

}  // namespace

void RefuseOption(const std::string& message) {
  throw WrongValue(message);
}

Result<double> ParseNumber(std::string_view name, std::string_view text, double low, double high) {
  double value = 0.0;
  if (ReadWhole(text, &value) && std::isfinite(value) && value >= low && value <= high) {
    return value;
  }
  return Status(
      StatusCode::kInvalidArgument,
      fmt::format("{}: must be a number from {:g} to {:g}, not '{}'", name, low, high, text));
}

CLI::Option* AddInteger(CLI::App& cli, const std::string& name, int* value, int low, int high,
                        const std::string& help) {
  return AddWhole(cli, name, value, low, high, help);
}

CLI::Option* AddSeed(CLI::App& cli, std::uint32_t* value, const std::string& what) {
  return AddWhole<std::uint32_t>(cli, "--seed", value, 0, 4294967295u,
                                 fmt::format("Seed of {} (default {})", what, *value));
}

CLI::Option* AddNumber(CLI::App& cli, const std::string& name, double* value, double low,
                       double high, const std::string& help) {
  return cli
      .add_option_function<std::string>(
          name,
          [=](const std::string& text) {
            const Result<double> number = ParseNumber(name, text, low, high);
            if (!number.ok()) RefuseOption(number.status().message());
            *value = *number;
          },
          help)
      ->type_name("X");
}

CLI::Option* AddNumbers(CLI::App& cli, const std::string& name, std::vector<double>* values,
                        double low, double high, const std::string& help) {
  return cli
      .add_option_function<std::string>(
          name,
          [=](const std::string& text) {
            values->clear();
            for (std::size_t begin = 0; begin <= text.size();) {
              const std::size_t comma = std::min(text.find(',', begin), text.size());
              const Result<double> number =
                  ParseNumber(name, text.substr(begin, comma - begin), low, high);
              if (!number.ok()) RefuseOption(number.status().message());
              values->push_back(*number);
              begin = comma + 1;
            }
          },
          help)
      ->type_name("X,X,...");
}

std::string Listed(const std::vector<std::string>& words) {
  std::string list;
  for (std::size_t k = 0; k < words.size(); ++k) {
    if (k > 0) list += k + 1 < words.size() ? ", " : " or ";
    list += words[k];
  }
  return list;
}

CLI::Option* AddChoice(CLI::App& cli, const std::string& name, std::string* value,
                       std::vector<std::string> words, const std::string& help) {
  const std::string type = fmt::format("{}", fmt::join(words, "|"));
  return cli
      .add_option_function<std::string>(
          name,
          [=](const std::string& text) {
            if (std::find(words.begin(), words.end(), text) == words.end()) {
              RefuseOption(fmt::format("{}: must be {}, not '{}'", name, Listed(words), text));
            }
            *value = text;
          },
          help)
      ->type_name(type);
}

Status FirstError(std::initializer_list<Status> checks) {
  for (const Status& status : checks) {
    if (!status.ok()) return status;
  }
  return {};
}

std::string HelpFormatter::make_help(const CLI::App* cli, std::string name,
                                     CLI::AppFormatMode mode) const {
  std::string text = Formatter::make_help(cli, std::move(name), mode);
  return rewrite_ ? rewrite_(std::move(text)) : text;
}

/// Former names are taken, but not shown.
std::string HelpFormatter::make_option_name(const CLI::Option* option, bool is_positional) const {
  if (is_positional) return option->get_name(true, false);
  std::string name;
  for (const std::string& letter : option->get_snames())
    name += "-" + letter + ",";
  return name + "--" + option->get_lnames().front();
}

/// What an option takes; whether a positional must be there is said by the line of usage.
std::string HelpFormatter::make_option_opts(const CLI::Option* option) const {
  if (option->get_type_size() == 0 || option->get_type_name() == "TEXT") return "";
  const bool many = option->get_expected_max() == CLI::detail::expected_max_vector_size;
  std::string takes = " " + option->get_type_name() + (many ? " ..." : "");
  // At least two spaces before the description: what reaches into them has a line of its own.
  const std::string name = make_option_name(option, option->get_positional());
  if (2 + name.size() + takes.size() + 1 == get_column_width()) takes += ' ';
  return takes;
}

std::string HelpFormatter::make_option_desc(const CLI::Option* option) const {
  const std::size_t width = 96 - get_column_width();
  std::string description = option->get_description();
  for (const CLI::Option* other : option->get_needs()) {
    description += " (needs " + other->get_name() + ")";
  }
  for (const CLI::Option* other : option->get_excludes()) {
    description += " (not with " + other->get_name() + ")";
  }
  if (rewrite_) description = rewrite_(std::move(description));
  std::istringstream words(description);
  std::string text, word;
  std::size_t column = 0;
  while (words >> word) {
    if (column > 0) {
      const bool fits = column + 1 + word.size() <= width;
      text += fits ? ' ' : '\n';
      column = fits ? column + 1 : 0;
    }
    text += word;
    column += word.size();
  }
  return text;
}

}  // namespace glissade::app
