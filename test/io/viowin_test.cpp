// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/viowin.h"

#include <gtest/gtest.h>

#include <cstring>
#include <limits>
#include <string>
#include <vector>

#include "common/random_states.h"
#include "glissade/losses/huber.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

using Kind = ViowinMarginalPrior::Kind;

/// Three keyframes, four landmarks, everything that a file can hold, in numbers of all lengths.
ViowinWindow MakeWindow(std::uint64_t seed) {
  test::Random random(seed);
  ViowinWindow w;
  w.id = static_cast<std::int64_t>(seed);
  w.camera = {461.1, 459.7, 376.3, 240.9, 752, 480, 0.7};
  w.T_b_c = random.RandomPose(0.1);
  w.gravity = Vector3(0.0, -0.0, -9.80665);
  for (int k = 0; k < 3; ++k) {
    const VertexSpeedBias speed_bias(random.Vec3(1.0), random.Vec3(0.1), random.Vec3(1e-300));
    w.keyframes.push_back({0.1 * k, random.RandomPose(2.0), speed_bias});
    w.ground_truth.push_back({0.1 * k, random.RandomPose(2.0), speed_bias});
  }
  for (int l = 0; l < 4; ++l) {
    ViowinLandmark landmark{l % 3, random.Uniform(0, 752), random.Uniform(0, 480), 0.3, 1.0 / 3,
                            {}};
    for (int j = 0; j < 3; ++j) {
      if (j != landmark.host) landmark.observations.push_back({j, 1e-7 * j, random.Uniform(0, 1)});
    }
    w.landmarks.push_back(landmark);
  }
  w.pose_priors.push_back({0, 3, random.RandomPose(1.0), {1, 2, 3, 4, 5, 6}});
  w.pose_priors.push_back({2, 1, random.RandomPose(1.0), {0.1, 0.2, 0.3, 0, 5e20, 6}});
  w.speed_bias_priors.push_back({1, w.keyframes[1].speed_bias, {1, 2, 3, 4, 5, 6, 7, 8, 9}});
  ViowinImu term{0, 1, {}, {}};
  term.imu.dt = 0.1;
  term.imu.dp = random.Vec3(1.0);
  term.imu.dq = random.Rotation(0.2);
  term.imu.dv = random.Vec3(1.0);
  term.imu.ba_lin = random.Vec3(0.1);
  term.imu.bg_lin = random.Vec3(0.1);
  for (Matrix3* m :
       {&term.imu.dp_dba, &term.imu.dp_dbg, &term.imu.dq_dbg, &term.imu.dv_dba, &term.imu.dv_dbg}) {
    for (int i = 0; i < 9; ++i)
      m->data()[i] = random.Uniform(-1, 1);
  }
  term.sqrt_information.setZero();
  for (int r = 0; r < 15; ++r) {
    for (int c = r; c < 15; ++c)
      term.sqrt_information(r, c) = random.Uniform(-30, 30);
  }
  w.imu.push_back(term);
  ViowinMarginalPrior prior;
  prior.blocks = {{Kind::kPose, 1}, {Kind::kSpeedBias, 1}, {Kind::kInverseDepth, 3}};
  const Pose pose = random.RandomPose(2.0);
  prior.x0.assign(pose.data, pose.data + 7);
  for (int i = 0; i < 10; ++i)
    prior.x0.push_back(random.Uniform(-1, 1));
  for (int i = 0; i < 5; ++i)
    prior.r0.push_back(random.Uniform(-1, 1));
  for (int i = 0; i < 5 * 16; ++i)
    prior.jacobian.push_back(random.Uniform(-1, 1));
  w.marginal_priors.push_back(prior);
  return w;
}

/// All numbers of a window, bit by bit.
std::vector<double> Numbers(const ViowinWindow& w) {
  std::vector<double> all{static_cast<double>(w.id),
                          w.camera.fx,
                          w.camera.fy,
                          w.camera.cx,
                          w.camera.cy,
                          static_cast<double>(w.camera.width),
                          static_cast<double>(w.camera.height),
                          w.camera.sigma_px};
  const auto add = [&](const double* x, std::size_t n) { all.insert(all.end(), x, x + n); };
  add(w.T_b_c.data, 7);
  add(w.gravity.data(), 3);
  for (const auto* list : {&w.keyframes, &w.ground_truth}) {
    for (const auto& k : *list) {
      all.push_back(k.stamp);
      add(k.T_w_b.data, 7);
      add(k.speed_bias.data, 9);
    }
  }
  for (const auto& l : w.landmarks) {
    all.insert(all.end(), {static_cast<double>(l.host), l.u_host, l.v_host, l.rho, l.rho_true});
    for (const auto& o : l.observations)
      all.insert(all.end(), {static_cast<double>(o.frame), o.u, o.v});
  }
  for (const auto& p : w.pose_priors) {
    all.insert(all.end(), {static_cast<double>(p.frame), static_cast<double>(p.use)});
    add(p.T_w_b.data, 7);
    add(p.sqrt_information.data(), 6);
  }
  for (const auto& p : w.speed_bias_priors) {
    all.push_back(p.frame);
    add(p.prior.data, 9);
    add(p.sqrt_information.data(), 9);
  }
  for (const auto& t : w.imu) {
    all.insert(all.end(), {static_cast<double>(t.i), static_cast<double>(t.j), t.imu.dt});
    add(t.imu.dp.data(), 3);
    add(t.imu.dq.coeffs().data(), 4);
    add(t.imu.dv.data(), 3);
    add(t.imu.ba_lin.data(), 3);
    add(t.imu.bg_lin.data(), 3);
    for (const Matrix3* m :
         {&t.imu.dp_dba, &t.imu.dp_dbg, &t.imu.dq_dbg, &t.imu.dv_dba, &t.imu.dv_dbg}) {
      add(m->data(), 9);
    }
    add(t.sqrt_information.data(), 225);
  }
  for (const auto& p : w.marginal_priors) {
    for (const auto& b : p.blocks)
      all.insert(all.end(), {static_cast<double>(b.kind), static_cast<double>(b.index)});
    for (const auto* list : {&p.x0, &p.r0, &p.jacobian})
      add(list->data(), list->size());
  }
  return all;
}

bool SameBits(const std::vector<ViowinWindow>& a, const std::vector<ViowinWindow>& b) {
  if (a.size() != b.size()) return false;
  for (std::size_t k = 0; k < a.size(); ++k) {
    const auto x = Numbers(a[k]), y = Numbers(b[k]);
    if (x.size() != y.size() || std::memcmp(x.data(), y.data(), 8 * x.size()) != 0) return false;
  }
  return true;
}

std::string SmallFile(const TempFiles& files) {
  EXPECT_TRUE(WriteViowin({MakeWindow(1)}, files.Path("small.txt")).ok());
  return files.Read("small.txt");
}

/// `text` with word `word` (from 0; negative from the end) of the n-th line that begins with
/// `keyword` replaced.
std::string WithWord(const std::string& text, const std::string& keyword, int n, int word,
                     const std::string& replacement, int* line_number) {
  std::istringstream in(text);
  std::string line, out;
  for (int number = 1; std::getline(in, line); ++number) {
    if (line.compare(0, keyword.size() + 1, keyword + " ") == 0 && n-- == 0) {
      std::istringstream words(line);
      std::vector<std::string> list;
      for (std::string w; words >> w;)
        list.push_back(w);
      list[word >= 0 ? static_cast<std::size_t>(word)
                     : list.size() - static_cast<std::size_t>(-word)] = replacement;
      line.clear();
      for (const auto& w : list)
        line += w + " ";
      *line_number = number;
    }
    out += line + "\n";
  }
  return out;
}

TEST(Viowin, RoundTripKeepsEveryBit) {
  TempFiles files;
  const std::vector<ViowinWindow> windows{MakeWindow(1), MakeWindow(2), MakeWindow(3)};
  for (const char* name : {"a.txt", "a.txt.gz", "a.txt.bz2"}) {
    ASSERT_TRUE(WriteViowin(windows, files.Path(name)).ok());
    const auto again = ReadViowin(files.Path(name));
    ASSERT_TRUE(again.ok()) << again.status().message();
    EXPECT_TRUE(SameBits(*again, windows)) << name;
    ASSERT_TRUE(WriteViowin(*again, files.Path("b.txt")).ok());
  }
  EXPECT_EQ(files.Read("a.txt"), files.Read("b.txt"));
  EXPECT_EQ(files.Read("a.txt").substr(0, 9), "VIOWIN 2\n");
}

TEST(Viowin, VersionOneHasNoMarginalPrior) {
  TempFiles files;
  std::string text = SmallFile(files);
  text[7] = '1';
  EXPECT_NE(ReadViowin(files.Write("v1.txt", text)).status().message().find("expected END"),
            std::string::npos);
  auto window = MakeWindow(1);
  window.marginal_priors.clear();
  ASSERT_TRUE(WriteViowin({window}, files.Path("v2.txt")).ok());
  text = files.Read("v2.txt");
  text.replace(0, 9, "VIOWIN 1\n# a comment\n");
  const auto read = ReadViowin(files.Write("v1.txt", text));
  ASSERT_TRUE(read.ok()) << read.status().message();
  EXPECT_TRUE(SameBits(*read, {window}));
}

TEST(Viowin, WhatMakesNoSenseIsNamedWithItsLine) {
  TempFiles files;
  const std::string good = SmallFile(files);
  const struct {
    const char* keyword;
    int n, word;
    const char* replacement;
    const char* message;
  } cases[] = {
      {"VIOWIN", 0, 1, "3", "version of VIOWIN"},
      {"CAMERA", 0, 1, "0", "fx"},
      {"CAMERA", 0, 2, "-460", "fy"},
      {"CAMERA", 0, 5, "0", "width"},
      {"CAMERA", 0, 7, "0", "sigma_px"},
      {"CAMERA", 0, 7, "-1", "sigma_px"},
      {"CAMERA", 0, 7, "nan", "finite"},
      {"EXTRINSIC", 0, 4, "7", "extrinsic"},
      {"GRAVITY", 0, 1, "inf", "gravity"},
      {"KEYFRAMES", 0, 1, "-3", "number of keyframes"},
      {"KEYFRAMES", 0, 1, "0", "number of keyframes"},
      {"KEYFRAMES", 0, 1, "2.5", "number of keyframes"},
      {"KF", 1, 1, "2", "expected keyframe 1"},
      {"KF", 1, 3, "NaN", "pose of keyframe 1"},
      {"KF", 2, 6, "3", "quaternion"},
      {"GT", 0, 0, "KF", "expected GT"},
      {"LANDMARKS", 0, 1, "-1", "number of landmarks"},
      {"LM", 0, 2, "3", "unknown keyframe 3"},
      {"LM", 0, 2, "-1", "unknown keyframe -1"},
      {"LM", 0, 5, "nan", "rho_init"},
      {"LM", 1, 7, "-2", "number of observations"},
      {"LM", 2, 8, "99", "unknown keyframe 99"},
      {"LM", 2, 8, "2", "own host"},
      {"LM", 2, 9, "x1", "found 'x1'"},
      {"POSE_PRIORS", 0, 1, "-1", "number of pose priors"},
      {"PP", 0, 1, "5", "unknown keyframe 5"},
      {"PP", 0, 2, "4", "use"},
      {"PP", 1, -1, "-2", "negative weight"},
      {"PS", 0, 1, "3", "unknown keyframe 3"},
      {"PS", 0, -1, "-1e-3", "negative weight"},
      {"IMU", 0, 1, "-9", "number of IMU terms"},
      {"IM", 0, 1, "1", "from keyframe 1 to itself"},
      {"IM", 0, 2, "3", "unknown keyframe 3"},
      {"IM", 0, 3, "0", "dt"},
      {"IM", 0, 7, "0.7", "rotation"},
      {"IM", 0, -1, "-inf", "U of IMU term"},
      {"MARG_PRIOR", 0, 1, "0", "number of states"},
      {"MARG_PRIOR", 0, 2, "-5", "number of rows"},
      {"MARG_PRIOR", 0, 3, "q", "'p', 's' or 'l'"},
      {"MARG_PRIOR", 0, 4, "3", "unknown keyframe 3"},
      {"MARG_PRIOR", 0, 8, "4", "unknown landmark 4"},
      {"MARG_PRIOR", 0, 13, "9", "x0 of a marginal prior"},
      {"MARG_PRIOR", 0, -1, "nan", "J of a marginal prior"},
  };
  for (const auto& c : cases) {
    SCOPED_TRACE(std::string(c.keyword) + " " + std::to_string(c.word) + ": " + c.replacement);
    int line = 0;
    const std::string path =
        files.Write("bad.txt", WithWord(good, c.keyword, c.n, c.word, c.replacement, &line));
    const Status status = ReadViowin(path).status();
    EXPECT_EQ(status.code(), StatusCode::kParseError);
    EXPECT_NE(status.message().find(c.message), std::string::npos) << status.message();
    EXPECT_EQ(status.message().find(path + ":" + std::to_string(line) + ": "), 0u)
        << status.message() << "\nexpected line " << line;
  }
}

TEST(Viowin, FilesCutAnywhereAreRefused) {
  TempFiles files;
  const std::string good = SmallFile(files);
  ASSERT_TRUE(ReadViowin(files.Write("cut.txt", good)).ok());
  for (std::size_t size = 0; size + 4 < good.size(); size += 1 + size / 50) {
    const Status status = ReadViowin(files.Write("cut.txt", good.substr(0, size))).status();
    EXPECT_EQ(status.code(), StatusCode::kParseError) << size;
  }
  ASSERT_FALSE(files.WriteCompressed("whole.gz", good).empty());
  const std::string whole = files.Read("whole.gz");
  EXPECT_FALSE(ReadViowin(files.Write("cut.gz", whole.substr(0, whole.size() / 2))).ok());
}

TEST(Viowin, GarbageIsRefused) {
  TempFiles files;
  test::Random random(7);
  std::string noise;
  for (int k = 0; k < 5000; ++k)
    noise += static_cast<char>(random.Uniform(0, 256));
  EXPECT_FALSE(ReadViowin(files.Write("noise", noise)).ok());
  EXPECT_FALSE(ReadViowin(files.Write("after.txt", SmallFile(files) + "more\n")).ok());
  EXPECT_EQ(ReadViowin(files.Path("absent.txt")).status().code(), StatusCode::kIoError);
  // A count that lies costs no memory.
  int line = 0;
  const std::string lie = WithWord(SmallFile(files), "LANDMARKS", 0, 1, "2147483647", &line);
  EXPECT_EQ(ReadViowin(files.Write("lie.txt", lie)).status().code(), StatusCode::kParseError);
}

TEST(Viowin, WhatCouldNotBeReadBackIsNotWritten) {
  TempFiles files;
  const std::string path = files.Path("a.txt");
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<ViowinWindow> bad(8, MakeWindow(1));
  bad[0].camera.sigma_px = 0.0;
  bad[1].landmarks[0].observations[0].frame = 3;
  bad[2].imu[0].j = 0;
  bad[3].imu[0].sqrt_information(3, 1) = 1.0;
  bad[4].marginal_priors[0].jacobian.pop_back();
  bad[5].keyframes[1].speed_bias.data[4] = nan;
  bad[6].ground_truth.pop_back();
  bad[7].marginal_priors[0].blocks[1] = {Kind::kPose, 1};
  for (const ViowinWindow& window : bad) {
    EXPECT_FALSE(WriteViowin({MakeWindow(2), window}, path).ok());
    Graph graph;
    EXPECT_FALSE(AddToGraph(window, WindowKind::kVisualInertial, {}, &graph).ok());
    EXPECT_EQ(graph.NumVertices(), 0);
  }
  EXPECT_FALSE(WriteViowin({}, path).ok());
  EXPECT_EQ(files.Count(), 0);
}

TEST(Viowin, AddToGraph) {
  ViowinWindow window = MakeWindow(1);
  Graph vision;
  auto handles = AddToGraph(window, WindowKind::kVision, {.loss = Huber{2.0}}, &vision);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(handles->poses.size(), 3u);
  EXPECT_EQ(handles->speed_biases.size(), 0u);
  EXPECT_EQ(handles->depths.size(), 4u);
  EXPECT_EQ(handles->reprojections.size(), 8u);
  EXPECT_EQ(vision.NumEdges(), 8 + 2);
  EXPECT_EQ(vision.Get(handles->depths[2]).rho, window.landmarks[2].rho);

  // The second landmark in the marginal prior: then its depths are not eliminated.
  window.marginal_priors[0].blocks[1] = {Kind::kInverseDepth, 0};
  window.marginal_priors[0].x0.resize(7 + 1 + 1);
  window.marginal_priors[0].jacobian.resize(5 * (6 + 1 + 1));
  Graph inertial;
  handles = AddToGraph(window, WindowKind::kVisualInertial, {}, &inertial);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(handles->speed_biases.size(), 3u);
  EXPECT_EQ(inertial.NumEdges(), 8 + 1 + 1 + 1 + 1);
  EXPECT_TRUE(inertial.Cost().ok());

  Graph none;
  EXPECT_FALSE(AddToGraph(window, WindowKind::kVision, {.loss = Huber{-1.0}}, &none).ok());
  EXPECT_EQ(none.NumVertices(), 0);
}

}  // namespace
}  // namespace glissade
