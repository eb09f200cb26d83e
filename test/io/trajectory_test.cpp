// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/trajectory.h"

#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "common/data_dir.h"
#include "common/random_states.h"
#include "glissade/io/euroc.h"
#include "io/decimal_seconds.h"
#include "temp_file.h"

namespace glissade {
namespace {

using eval::StampedPose;
using eval::Trajectory;

constexpr std::int64_t kMin = std::numeric_limits<std::int64_t>::min();
constexpr std::int64_t kMax = std::numeric_limits<std::int64_t>::max();

TEST(DecimalSeconds, AreReadToTheNanosecond) {
  const std::pair<const char*, std::int64_t> cases[] = {
      {"0", 0},
      {"-0.0", 0},
      {"1", 1'000'000'000},
      {"+1.5", 1'500'000'000},
      {"-1.5", -1'500'000'000},
      {".000000001", 1},
      {"7.", 7'000'000'000},
      {"1403636579.763555584", 1403636579763555584},
      {"1.403636579763555584e9", 1403636579763555584},
      {"1.403636579763555527e+09", 1403636579763555527},
      {"1403636579763555584E-9", 1403636579763555584},
      {"0.0000000014", 1},
      {"0.0000000015", 2},
      {"-0.0000000015", -2},
      {"0.00000000049999999999999999", 0},
      {"0.9999999999", 1'000'000'000},
      {"9223372036.854775807", kMax},
      {"9223372036.8547758074", kMax},
      {"-9223372036.854775808", kMin},
      {"0e999999999999", 0},
      {"1e-999999999999", 0},
      {"000000000000000000000000000001.000000000000000000000000", 1'000'000'000},
  };
  for (const auto& [text, expected] : cases) {
    const auto found = internal::NanosecondsOf(text);
    ASSERT_TRUE(found.has_value()) << text;
    EXPECT_EQ(*found, expected) << text;
  }
  for (const char* text : {"",
                           "-",
                           "+",
                           ".",
                           "e5",
                           ".e5",
                           "1e",
                           "1e+",
                           "1e+-5",
                           "1e++5",
                           "1 ",
                           " 1",
                           "1.2.3",
                           "nan",
                           "inf",
                           "0x10",
                           "1e5.0",
                           "--1",
                           "+-1",
                           "9223372036.854775808",
                           "9223372036.8547758075",
                           "-9223372036.854775809",
                           "1e10",
                           "1e999999999999",
                           "12345678901234567890"}) {
    EXPECT_FALSE(internal::NanosecondsOf(text).has_value()) << text;
  }
}

TEST(DecimalSeconds, RoundTrip) {
  test::Random random(1);
  std::vector<std::int64_t> stamps = {0, 1, -1, 999'999'999, -999'999'999, kMin, kMax, kMin + 1};
  for (int k = 0; k < 10000; ++k)
    stamps.push_back(static_cast<std::int64_t>(random.Uniform(-9.2e18, 9.2e18)) + k);
  for (const std::int64_t stamp : stamps) {
    const std::string text = internal::SecondsOf(stamp);
    EXPECT_EQ(text.size() - text.find('.'), 10u) << text;
    const auto back = internal::NanosecondsOf(text);
    ASSERT_TRUE(back.has_value()) << text;
    EXPECT_EQ(*back, stamp);
  }
  EXPECT_EQ(internal::SecondsOf(-1), "-0.000000001");
}

Trajectory RandomTrajectory(int n) {
  test::Random random(2);
  Trajectory trajectory;
  std::int64_t stamp = 1403636579763555584;
  for (int k = 0; k < n; ++k) {
    stamp += 1 + static_cast<std::int64_t>(random.Uniform(0, 1e7));
    Pose pose = random.RandomPose(100.0);
    pose.Normalize();
    trajectory.push_back({stamp, pose});
  }
  return trajectory;
}

void ExpectSame(const Trajectory& a, const Trajectory& b) {
  ASSERT_EQ(a.size(), b.size());
  for (std::size_t k = 0; k < a.size(); ++k) {
    EXPECT_EQ(a[k].stamp_ns, b[k].stamp_ns);
    EXPECT_EQ(Vector3(a[k].T_w_b.p()), Vector3(b[k].T_w_b.p()));
    for (int i = 3; i < 7; ++i)
      EXPECT_NEAR(a[k].T_w_b.data[i], b[k].T_w_b.data[i], 3e-16);
  }
}

TEST(TrajectoryFiles, RoundTrip) {
  const TempFiles files;
  const Trajectory wrote = RandomTrajectory(500);
  for (const char* name : {"a.tum", "a.tum.gz", "a.tum.bz2"}) {
    ASSERT_TRUE(WriteTumTrajectory(wrote, files.Path(name)).ok());
    for (const auto& read :
         {ReadTumTrajectory(files.Path(name)), ReadTrajectory(files.Path(name))}) {
      ASSERT_TRUE(read.ok()) << read.status().message();
      ExpectSame(*read, wrote);
    }
  }
  for (const char* name : {"a.csv", "a.csv.gz"}) {
    ASSERT_TRUE(WriteEurocTrajectory(wrote, files.Path(name)).ok());
    for (const auto& read :
         {ReadEurocTrajectory(files.Path(name)), ReadTrajectory(files.Path(name))}) {
      ASSERT_TRUE(read.ok()) << read.status().message();
      ExpectSame(*read, wrote);
    }
  }
  EXPECT_LT(files.Read("a.tum.gz").size(), files.Read("a.tum").size());
  ASSERT_TRUE(WriteTumTrajectory({}, files.Path("none")).ok());
  EXPECT_EQ(ReadTrajectory(files.Path("none"))->size(), 0u);
}

TEST(TrajectoryFiles, GroundTruthRoundTripWithSpeeds) {
  const TempFiles files;
  std::vector<GroundTruthState> wrote(2);
  wrote[0].stamp_ns = -5;
  wrote[0].speed_bias = VertexSpeedBias({1, 2, 3}, {4, 5, 6}, {7, 8, 1.0 / 3});
  wrote[1].stamp_ns = 5;
  wrote[1].speed_bias = VertexSpeedBias();
  ASSERT_TRUE(WriteEurocGroundTruth(wrote, files.Path("gt.csv")).ok());
  const auto read = ReadEurocGroundTruth(files.Path("gt.csv"));
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->size(), 2u);
  ASSERT_TRUE((*read)[0].speed_bias.has_value());
  for (int i = 0; i < 9; ++i)
    EXPECT_EQ((*read)[0].speed_bias->data[i], wrote[0].speed_bias->data[i]);
  wrote[1].speed_bias.reset();
  EXPECT_EQ(WriteEurocGroundTruth(wrote, files.Path("no.csv")).code(),
            StatusCode::kInvalidArgument);
  EXPECT_EQ(files.Count(), 1);
}

TEST(TrajectoryFiles, WhatOthersWrite) {
  const TempFiles files;
  // TUM: four decimals, tabs, comments, Windows line ends; evo: exponents.
  const auto tum = ReadTrajectory(
      files.Write("tum.txt",
                  "# ground truth\n#,timestamp, tx\n\n"
                  "1305031098.6659 1.3563 0.6305 1.6380 0.6132 0.5962 -0.3311 -0.3986\r\n"
                  "1305031098.6758\t1.3543  0.6306 1.6360 0.6129 0.5966 -0.3316 -0.3980  \n"
                  "1.305031098685799837e+09 1 2 3 0 0 0 1"));
  ASSERT_TRUE(tum.ok()) << tum.status().message();
  ASSERT_EQ(tum->size(), 3u);
  EXPECT_EQ((*tum)[0].stamp_ns, 1305031098665900000);
  EXPECT_EQ((*tum)[2].stamp_ns, 1305031098685799837);
  EXPECT_EQ((*tum)[1].T_w_b.p()[2], 1.6360);
  EXPECT_LT((*tum)[1].T_w_b.data[5], 0.0);
  EXPECT_NEAR((*tum)[1].T_w_b.q().norm(), 1.0, 1e-15);
  const auto euroc = ReadTrajectory(
      files.Write("e.csv", "#timestamp, p_x\n1403636580838555648,4.6,-1.7,0.7,1,0,0,0\n"));
  ASSERT_TRUE(euroc.ok()) << euroc.status().message();
  EXPECT_EQ((*euroc)[0].stamp_ns, 1403636580838555648);
  EXPECT_EQ((*euroc)[0].T_w_b.data[6], 1.0);
}

TEST(TrajectoryFiles, HostileFilesAreRefusedByLine) {
  const TempFiles files;
  const std::pair<const char*, const char*> cases[] = {
      {"1 0 0 0 0 0 0\n", ":1: expected stamp px py pz qx qy qz qw: 8 fields, found 7"},
      {"1 0 0 0 0 0 0 1 1\n", ":1: expected stamp px py pz qx qy qz qw: 8 fields, found 9"},
      {"# c\n1 0 0 0 0 0 0 1\n2 0 0 0 0 0 0 x\n",
       ":3: expected quaternion (a finite number), found 'x'"},
      {"1 0 nan 0 0 0 0 1\n", ":1: expected position"},
      {"1 0 inf 0 0 0 0 1\n", ":1: expected position"},
      {"1 0 1e999 0 0 0 0 1\n", ":1: expected position"},
      {"t 0 0 0 0 0 0 1\n", ":1: expected stamp (seconds, that fit int64 nanoseconds), found 't'"},
      {"nan 0 0 0 0 0 0 1\n", ":1: expected stamp"},
      {"1e30 0 0 0 0 0 0 1\n", ":1: expected stamp"},
      {"1 0 0 0 0 0 0 0\n", ":1: quaternion has norm 0"},
      {"1 0 0 0 1 1 0 0\n", ":1: quaternion has norm 1.41"},
      {"1 0 0 0 1e300 1e300 0 0\n", ":1: quaternion has norm"},
      {"2 0 0 0 0 0 0 1\n\n2 0 0 0 0 0 0 1\n",
       ":3: stamp 2.000000000 is not later than 2.000000000"},
      {"2 0 0 0 0 0 0 1\n1 0 0 0 0 0 0 1\n", ":2: stamp 1.000000000 is not later"},
      {"\x01\x02\x7f binary", ":1: expected"},
  };
  for (const auto& [content, message] : cases) {
    const std::string path = files.Write("f", content);
    const auto read = ReadTumTrajectory(path);
    EXPECT_EQ(read.status().code(), StatusCode::kParseError) << content;
    EXPECT_EQ(read.status().message().find(path + message), 0u) << read.status().message();
    EXPECT_EQ(ReadTrajectory(path).status().message(), read.status().message());
    EXPECT_TRUE(read->empty());
  }
  EXPECT_EQ(ReadTrajectory(files.Path("absent")).status().code(), StatusCode::kIoError);
  EXPECT_FALSE(ReadTrajectory(files.Path(".")).ok());
  EXPECT_EQ(ReadTrajectory(files.Write("long", std::string(1 << 18, '1'))).status().code(),
            StatusCode::kParseError);
  EXPECT_EQ(ReadTrajectory(files.Write("c", "1,2,3\n")).status().code(), StatusCode::kParseError);
}

TEST(TrajectoryFiles, AnyCutOrChangedByteGivesAStatusOrATrajectory) {
  const TempFiles files;
  ASSERT_TRUE(WriteTumTrajectory(RandomTrajectory(3), files.Path("good")).ok());
  const std::string good = files.Read("good");
  test::Random random(5);
  for (int trial = 0; trial < 400; ++trial) {
    std::string bad = good;
    bad[static_cast<std::size_t>(random.Uniform(0, static_cast<double>(good.size())))] =
        static_cast<char>(random.Uniform(0, 256));
    if (trial % 3 == 0) {
      bad.resize(static_cast<std::size_t>(random.Uniform(0, static_cast<double>(good.size()))));
    }
    const auto read = ReadTrajectory(files.Write("bad", bad));
    if (read.ok()) {
      EXPECT_TRUE(eval::ValidateTrajectory(*read, "read").ok());
    } else {
      EXPECT_NE(read.status().message().find(files.Path("bad")), std::string::npos);
    }
  }
}

TEST(TrajectoryFiles, WritersRefuseWhatIsNone) {
  const TempFiles files;
  const Trajectory good = RandomTrajectory(3);
  std::vector<Trajectory> bad(3, good);
  bad[0][1].stamp_ns = good[0].stamp_ns;
  bad[1][2].T_w_b.data[0] = std::nan("");
  bad[2][0].T_w_b.data[6] += 0.1;
  for (const Trajectory& trajectory : bad) {
    EXPECT_FALSE(WriteTumTrajectory(trajectory, files.Path("x")).ok());
    EXPECT_FALSE(WriteEurocTrajectory(trajectory, files.Path("x")).ok());
  }
  EXPECT_EQ(files.Count(), 0);
  const std::string nowhere = files.Path("no") + "/such/file";
  EXPECT_EQ(WriteTumTrajectory(good, nowhere).code(), StatusCode::kIoError);
  EXPECT_EQ(WriteEurocTrajectory(good, nowhere).code(), StatusCode::kIoError);
  // What was there before stays.
  files.Write("kept", "kept");
  EXPECT_FALSE(WriteTumTrajectory(bad[0], files.Path("kept")).ok());
  EXPECT_EQ(files.Read("kept"), "kept");
}

TEST(KittiTrajectory, RoundTrip) {
  const TempFiles files;
  const Trajectory wrote = RandomTrajectory(200);
  ASSERT_TRUE(WriteKittiTrajectory(wrote, files.Path("poses.txt"), files.Path("times.txt")).ok());
  EXPECT_EQ(FindTrajectoryFormat(files.Path("poses.txt")).value(), TrajectoryFormat::kKitti);
  const auto read = ReadTrajectory(files.Path("poses.txt"), {.times = files.Path("times.txt")});
  ASSERT_TRUE(read.ok()) << read.status().message();
  ASSERT_EQ(read->size(), wrote.size());
  for (std::size_t k = 0; k < wrote.size(); ++k) {
    EXPECT_EQ((*read)[k].stamp_ns, wrote[k].stamp_ns);
    EXPECT_EQ(Vector3((*read)[k].T_w_b.p()), Vector3(wrote[k].T_w_b.p()));
    EXPECT_LT(((*read)[k].T_w_b.R() - wrote[k].T_w_b.R()).norm(), 1e-14);
  }
  ASSERT_TRUE(WriteTrajectory(wrote, files.Path("k.gz"), TrajectoryFormat::kKitti).ok());
  const auto rate = ReadTrajectory(files.Path("k.gz"), {.rate_hz = 30.0});
  ASSERT_TRUE(rate.ok()) << rate.status().message();
  EXPECT_EQ((*rate)[0].stamp_ns, 0);
  EXPECT_EQ((*rate)[1].stamp_ns, 33333333);
  EXPECT_EQ((*rate)[3].stamp_ns, 100000000);
  EXPECT_EQ(files.Count(), 3);
  for (const auto format : {TrajectoryFormat::kTum, TrajectoryFormat::kEuroc}) {
    ASSERT_TRUE(WriteTrajectory(wrote, files.Path("t"), format).ok());
    EXPECT_EQ(FindTrajectoryFormat(files.Path("t")).value(), format);
    ExpectSame(ReadTrajectory(files.Path("t")).value(), wrote);
  }
}

TEST(KittiTrajectory, AsTheBenchmarkHasIt) {
  const TempFiles files;
  const std::string path =
      files.Write("00.txt",
                  "1.000000e+00 9.0e-12 2.3e-11 5.6e-17 9.0e-12 1.0e+00 2.4e-10 "
                  "1.1e-16 2.3e-11 2.4e-10 1.0e+00 -2.2e-16\n"
                  "0 0 1 0.5 0 1 0 -0.25 -1 0 0 2\n");
  const std::string times = files.Write("times.txt", "0.000000e+00\n1.037359e-01\n");
  const auto read = ReadKittiTrajectory(path, {.times = times});
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_EQ((*read)[1].stamp_ns, 103735900);
  EXPECT_EQ(Vector3((*read)[1].T_w_b.p()), Vector3(0.5, -0.25, 2.0));
  // The body's z axis is the world's x axis.
  EXPECT_LT(((*read)[1].T_w_b.R().col(2) - Vector3(1, 0, 0)).norm(), 1e-15);
}

TEST(KittiTrajectory, WhatIsWrongIsNamed) {
  const TempFiles files;
  const std::string good = "1 0 0 0 0 1 0 0 0 0 1 0\n";
  const std::string path = files.Write("k", good + good);
  EXPECT_NE(ReadTrajectory(path).status().message().find("no stamps: give a file of times or a "),
            std::string::npos);
  const std::string two = files.Write("two", "1\n2\n");
  for (const KittiStamps& stamps :
       {KittiStamps{}, KittiStamps{two, 1.0}, KittiStamps{"", -1.0}, KittiStamps{"", 2e9},
        KittiStamps{"", std::nan("")}, KittiStamps{"", 1e-10}}) {
    EXPECT_EQ(ReadKittiTrajectory(path, stamps).status().code(), StatusCode::kInvalidArgument);
  }
  const auto message = [&](const std::string& poses, const std::string& times) {
    return ReadKittiTrajectory(files.Write("p", poses), {.times = files.Write("t", times)})
        .status()
        .message();
  };
  const std::string p = files.Path("p"), t = files.Path("t");
  EXPECT_EQ(message(good, "1\n2\n"), p + ": has 1 poses, and " + t + " has 2 times");
  EXPECT_EQ(message(good + good, "1\n"), p + ":2: more poses than times");
  EXPECT_EQ(message(good + good, "1\n1\n"), t + ":2: time is not later than the one before");
  EXPECT_EQ(message(good, "x\n"),
            t + ":1: expected time (seconds, that fit int64 nanoseconds), found 'x'");
  EXPECT_EQ(message("1 0 0 0 0 1 0 0 0 0 -1 0\n", "1\n"), p + ":1: the pose is no rigid motion");
  EXPECT_EQ(message("2 0 0 0 0 2 0 0 0 0 2 0\n", "1\n"), p + ":1: the pose is no rigid motion");
  EXPECT_EQ(message(good + "1 0 0 0 0 1 0 0 0 0 1\n", "1\n2\n").find(p + ":2: expected a pose"),
            0u);
  EXPECT_EQ(message(good + "1 0 0 0 0 1 0 nan 0 0 1 0\n", "1\n2\n").find(p + ":2: expected entry"),
            0u);
  Trajectory bad = RandomTrajectory(3);
  bad[1].stamp_ns = bad[0].stamp_ns;
  const int before = files.Count();
  EXPECT_FALSE(WriteKittiTrajectory(bad, files.Path("x"), files.Path("y")).ok());
  EXPECT_FALSE(
      WriteKittiTrajectory(RandomTrajectory(2), files.Path("x"), files.Path("no/such")).ok());
  EXPECT_EQ(files.Count(), before);
}

TEST(TrajectoryFiles, RecordedGroundTruthRoundTrips) {
  const auto path = test::DataDir() / "vio/euroc_v101_map/groundtruth.csv.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << path << " is not there";
  const TempFiles files;
  const auto truth = ReadEurocTrajectory(path.string());
  ASSERT_TRUE(truth.ok()) << truth.status().message();
  ASSERT_GT(truth->size(), 1000u);
  ASSERT_TRUE(WriteTumTrajectory(*truth, files.Path("t.tum")).ok());
  const auto back = ReadTrajectory(files.Path("t.tum"));
  ASSERT_TRUE(back.ok()) << back.status().message();
  ExpectSame(*back, *truth);
}

}  // namespace
}  // namespace glissade
