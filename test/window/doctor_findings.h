// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <string>
#include <vector>

#include "glissade/window/data_doctor.h"
#include "window/shaken_recording.h"

namespace glissade::test {

inline constexpr double kDegree = std::numbers::pi / 180.0;
/// Where it is not rotations that are looked at.
inline const DoctorOptions kQuick{.max_frame_pairs = 40};

/// Kinds of the findings that are more than information, each once.
inline std::vector<std::string> Serious(const DoctorReport& report) {
  std::vector<std::string> kinds;
  for (const DoctorFinding& f : report.findings) {
    if (f.severity == DoctorSeverity::kInfo) continue;
    const std::string kind(ToString(f.kind));
    if (std::find(kinds.begin(), kinds.end(), kind) == kinds.end()) kinds.push_back(kind);
  }
  return kinds;
}

inline std::string Told(const DoctorReport& report) {
  std::string text;
  for (const DoctorFinding& f : report.findings) {
    text.append(ToString(f.severity)).append(" ").append(ToString(f.kind)).append(": ");
    text.append(f.message).append("\n");
  }
  return text;
}

/// The finding of a kind, which must be the only kind that is serious.
inline DoctorFinding Only(const DoctorReport& report, DoctorKind kind) {
  EXPECT_EQ(Serious(report), std::vector<std::string>{std::string(ToString(kind))}) << Told(report);
  const DoctorFinding* f = report.Find(kind);
  EXPECT_FALSE(f != nullptr && (f->message.empty() || f->advice.empty() || f->sensor.empty()));
  return f != nullptr ? *f : DoctorFinding();
}

inline DoctorFinding Only(ShakenRecording& recording, DoctorKind kind) {
  return Only(Diagnose(recording.Input(), kQuick), kind);
}

inline std::int64_t Shifted(std::int64_t stamp, double seconds) {
  return stamp + std::llround(1e9 * seconds);
}

}  // namespace glissade::test
