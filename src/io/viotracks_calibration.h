// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <string>

#include "glissade/base/status.h"
#include "glissade/io/viotracks.h"

namespace glissade::internal {

/// Reads calibration.json of a recording (JSON, by nlohmann-json), plain or compressed, of at most
/// 256 kB and 64 levels. kIoError (also where the library was built without nlohmann-json), or
/// kParseError: "path:line: what" where it is no JSON, "path: /cameras/0/fx: what" (a JSON pointer,
/// RFC 6901) where it is no calibration.
Status ReadCalibration(const std::string& path, Viotracks* data);

}  // namespace glissade::internal
