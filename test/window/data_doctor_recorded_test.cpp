// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The data doctor on recordings: simulated ones of the library, and real ones.
#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "common/data_dir.h"
#include "common/sanitized.h"
#include "glissade/io/diagnose.h"
#include "glissade/io/viotracks.h"
#include "glissade/sim/recording.h"

namespace glissade {
namespace {

std::string Serious(const DoctorReport& report) {
  std::string text;
  for (const DoctorFinding& f : report.findings) {
    if (f.severity != DoctorSeverity::kInfo) text.append(f.message).append("\n");
  }
  return text;
}

TEST(DataDoctorRecorded, SimulatedFlightsAreHealthy) {
  for (std::uint64_t seed = 1; seed <= (test::kSanitized ? 2 : 20); ++seed) {
    sim::RecordingOptions options;
    options.seed = options.world.seed = seed;
    const auto data = sim::MakeRecording(options);
    ASSERT_TRUE(data.ok());
    EXPECT_EQ(Serious(Diagnose(*data, {.max_frame_pairs = 60})), "") << seed;
  }
}

class Recorded : public ::testing::Test {
 protected:
  /// False where the recording is not there, or sanitizers make it take minutes.
  bool Read(const std::string& name) {
    const auto folder = test::DataDir() / "vio" / name;
    if (test::kSanitized || !std::filesystem::exists(folder)) return false;
    auto data = ReadViotracks(folder.string());
    EXPECT_TRUE(data.ok()) << data.status().message();
    report_ = Diagnose(*data);
    return true;
  }
  DoctorReport report_;
};

TEST_F(Recorded, Euroc) {
  for (const char* name : {"euroc_v101_map", "euroc_mh05_map"}) {
    if (!Read(name)) GTEST_SKIP() << "no " << name;
    EXPECT_EQ(Serious(report_), "") << name;
    ASSERT_TRUE(report_.facts.time_offset_s && report_.facts.extrinsic_error);
    EXPECT_NEAR(*report_.facts.time_offset_s, 0.0, 0.002);
    EXPECT_LT(report_.facts.extrinsic_error->norm(), 0.007);
  }
}

TEST_F(Recorded, MalagaIsLate) {
  if (!Read("malaga_parking6L")) GTEST_SKIP() << "no malaga_parking6L";
  const DoctorFinding* f = report_.Find(DoctorKind::kTimeOffset);
  ASSERT_NE(f, nullptr);
  EXPECT_EQ(f->severity, DoctorSeverity::kError);
  EXPECT_NEAR(f->estimate.value_or(0.0), -0.11, 0.02);
  EXPECT_LT(f->sigma.value_or(1.0), 0.01);
  // A car that turns about one axis: nothing is claimed of the others.
  for (const DoctorKind kind : {DoctorKind::kGyroAxes, DoctorKind::kExtrinsicRotation,
                                DoctorKind::kGyroUnits, DoctorKind::kGravity}) {
    EXPECT_EQ(report_.Find(kind), nullptr) << ToString(kind);
  }
}

TEST_F(Recorded, KittiHasNoImu) {
  if (!Read("kitti_0930_0020")) GTEST_SKIP() << "no kitti_0930_0020";
  const DoctorFinding* f = report_.Find(DoctorKind::kNoImu);
  ASSERT_NE(f, nullptr);
  EXPECT_EQ(f->severity, DoctorSeverity::kInfo);
  EXPECT_NE(report_.Worst(), DoctorSeverity::kError) << Serious(report_);
  EXPECT_NE(report_.Find(DoctorKind::kFewTracks), nullptr);
}

}  // namespace
}  // namespace glissade
