// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/lie/pose.h"

namespace glissade::internal {

/// The poses of a file, 12 numbers a line; more than `most` are refused at the line of the first.
Result<std::vector<Pose>> ReadKittiPoses(const std::string& path, std::size_t most);

}  // namespace glissade::internal
