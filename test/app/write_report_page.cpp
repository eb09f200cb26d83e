// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// write_report_page DATA.json PAGE.html: what report_page_test.py makes pages with. The text "NaN"
// stands for the number.
// write_report_page --base64 FILE: the file in base64, on standard output.
#include <fmt/format.h>

#include <cstdio>
#include <fstream>
#include <iterator>
#include <limits>
#include <nlohmann/json.hpp>
#include <string>

#include "page/report_page.h"

namespace {

void PutNan(nlohmann::ordered_json* value) {
  if (value->is_structured()) {
    for (auto& part : *value)
      PutNan(&part);
  } else if (*value == "NaN") {
    *value = std::numeric_limits<double>::quiet_NaN();
  }
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const std::string first = argv[1];
  std::ifstream file(first == "--base64" ? argv[2] : argv[1], std::ios::binary);
  const std::string text{std::istreambuf_iterator<char>(file), {}};
  if (first == "--base64") {
    fmt::print("{}\n", glissade::app::ToBase64(text));
    return 0;
  }
  glissade::Status status = glissade::app::CheckReportPage();
  if (status.ok()) {
    auto data = nlohmann::ordered_json::parse(text);
    PutNan(&data);
    status = glissade::app::WriteReportPage(data, argv[2]);
  }
  if (!status.ok()) fmt::print(stderr, "{}: {}\n", ToString(status.code()), status.message());
  return status.ok() ? 0 : 1;
}
