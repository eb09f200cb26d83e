// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "page/report_page.h"

#include <fmt/format.h>

#include <cmath>
#include <cstdlib>
#include <fstream>
#include <iterator>
#include <nlohmann/json.hpp>
#include <vector>

#include "common/output_file.h"
#include "common/program_folder.h"

namespace glissade::app {

namespace {

using nlohmann::ordered_json;

// report_page.html, report_page/*.css and report_page/*.js, as CMake has found them.
#include "report_page_parts.inc"

template <std::size_t N>
std::string_view Text(const unsigned char (&bytes)[N]) {
  return {reinterpret_cast<const char*>(bytes), N};
}

/// Replaces what would end the element <script> that holds the text. "<\/" is "</" to JavaScript,
/// in strings and in regular expressions, which is where a library has it.
std::string ForScriptElement(std::string text) {
  std::size_t at = 0;
  while ((at = text.find("</", at)) != std::string::npos) {
    std::string word = text.substr(at + 2, 6);
    for (char& c : word)
      if (c >= 'A' && c <= 'Z') c = static_cast<char>(c - 'A' + 'a');
    if (word == "script") text.insert(at + 1, "\\");
    at += 2;
  }
  return text;
}

/// A leaf as ASCII without "<", so that nothing in it means anything to HTML. What is no UTF-8 is
/// replaced.
void AppendLeaf(const ordered_json& leaf, std::string* out) {
  for (const char c : leaf.dump(-1, ' ', true, ordered_json::error_handler_t::replace)) {
    if (c == '<') {
      out->append("\\u003c");
    } else {
      out->push_back(c);
    }
  }
}

/// JSON with as many digits as a picture can show: seven, but all of a time's.
void AppendJson(const ordered_json& value, bool exact, std::string* out) {
  if (value.is_object()) {
    out->push_back('{');
    for (auto it = value.begin(); it != value.end(); ++it) {
      if (it != value.begin()) out->push_back(',');
      AppendLeaf(it.key(), out);
      out->push_back(':');
      AppendJson(it.value(), it.key() == "t", out);
    }
    out->push_back('}');
  } else if (value.is_array()) {
    out->push_back('[');
    for (std::size_t k = 0; k < value.size(); ++k) {
      if (k > 0) out->push_back(',');
      AppendJson(value[k], exact, out);
    }
    out->push_back(']');
  } else if (value.is_number_float() && !exact && std::isfinite(value.get<double>())) {
    fmt::format_to(std::back_inserter(*out), "{:.7g}", value.get<double>());
  } else {
    AppendLeaf(value, out);
  }
}

std::string PlotlyFile() {
  if (const char* named = std::getenv("GLISSADE_PLOTLY_JS"); named != nullptr && *named != '\0') {
    return named;
  }
  return (ProgramFolder() / GLISSADE_SHARE_FROM_BIN / "plotly.min.js").lexically_normal().string();
}

Result<std::string> ReadPlotly() {
  const std::string file = PlotlyFile();
  std::ifstream stream(file, std::ios::binary);
  std::string text{std::istreambuf_iterator<char>(stream), {}};
  if (stream && text.find("Plotly") != std::string::npos) return text;
  return Status(StatusCode::kIoError,
                fmt::format("{}: {}: the report needs plotly.js: pip install plotly, then "
                            "configure and build glissade again, or name a plotly.min.js in the "
                            "environment's GLISSADE_PLOTLY_JS",
                            file, stream ? "no plotly.js" : "cannot be read"));
}

/// The page in its order. Its placeholders are lines of the template.
std::vector<std::string_view> PartsOf(std::string_view plotly, std::string_view data) {
  struct Place {
    std::string_view mark, text;
  };
  const Place places[] = {{"@STYLE@", Text(kReportPageStyle)},
                          {"@PLOTLY@", plotly},
                          {"@SCRIPT@", Text(kReportPageScript)},
                          {"@DATA@", data}};
  std::vector<std::string_view> parts;
  std::string_view rest = Text(kReportPageTemplate);
  for (const Place& place : places) {
    const std::size_t at = rest.find(place.mark);
    parts.push_back(rest.substr(0, at));
    parts.push_back(place.text);
    rest.remove_prefix(at + place.mark.size());
  }
  parts.push_back(rest);
  return parts;
}

}  // namespace

Status CheckReportPage() {
  return ReadPlotly().status();
}

Status WriteReportPage(const ordered_json& data, const std::string& file) {
  if (!data.is_object()) return {StatusCode::kInvalidArgument, "the report's data are no object"};
  Result<std::string> plotly = ReadPlotly();
  if (!plotly.ok()) return plotly.status();
  const std::string script = ForScriptElement(std::move(plotly).value());
  std::string json;
  AppendJson(data, false, &json);
  std::string page;
  page.reserve(script.size() + json.size() + 100'000);
  for (const std::string_view part : PartsOf(script, json))
    page += part;
  return WriteFile(file, page);
}

std::string ToBase64(std::string_view bytes) {
  constexpr std::string_view digits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  text.reserve((bytes.size() + 2) / 3 * 4);
  for (std::size_t k = 0; k < bytes.size(); k += 3) {
    const std::size_t given = std::min<std::size_t>(3, bytes.size() - k);
    unsigned three = 0;  // bytes, the first one uppermost
    for (std::size_t i = 0; i < 3; ++i)
      three = three << 8 | (i < given ? static_cast<unsigned char>(bytes[k + i]) : 0u);
    for (std::size_t i = 0; i < 4; ++i)
      text.push_back(i <= given ? digits[three >> (18 - 6 * i) & 63u] : '=');
  }
  return text;
}

}  // namespace glissade::app
