// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "glissade/base/status.h"

namespace glissade::internal {

/// A JSON text (RFC 8259) as a tree, for small files: calibrations. Each value knows its line.
struct JsonValue {
  enum class Kind { kNull, kBool, kNumber, kString, kArray, kObject };
  Kind kind = Kind::kNull;
  std::int64_t line = 1;
  bool boolean = false;
  double number = 0.0;  ///< finite
  std::string string;
  std::vector<JsonValue> items;                            ///< of an array
  std::vector<std::pair<std::string, JsonValue>> members;  ///< of an object, names unique

  /// The member of that name; null where there is none, or where this is no object.
  [[nodiscard]] const JsonValue* Find(std::string_view name) const;
};

/// "number", "object", ...
std::string_view ToString(JsonValue::Kind kind);

/// Reads a file, plain or compressed, of at most 256 kB and 64 levels. kIoError, or kParseError
/// with "path:line: what was expected".
Result<JsonValue> ReadJson(const std::string& path);

}  // namespace glissade::internal
