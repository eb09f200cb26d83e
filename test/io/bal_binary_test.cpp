// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>
#include <sys/stat.h>

#include <cmath>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <limits>
#include <string>
#include <thread>

#include "glissade/io/bal.h"
#include "io/bal_binary.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

BalProblem Small() {
  BalProblem problem;
  for (int k = 0; k < 3; ++k) {
    VertexCameraBal camera;
    for (int i = 0; i < 9; ++i)
      camera.data[i] = 1.0 / (k + 3.0) - i;
    problem.cameras.push_back(camera);
  }
  for (int j = 0; j < 4; ++j)
    problem.points.emplace_back(j / 7.0, -0.0, 1e-300 * j);
  for (int j = 0; j < 4; ++j) {
    for (int k = 0; k < 3; ++k)
      problem.observations.push_back({k, j, k / 3.0, -j / 9.0});
  }
  return problem;
}

bool SameBits(const BalProblem& a, const BalProblem& b) {
  const auto same = [](const auto& x, const auto& y) {
    return x.size() == y.size() && std::memcmp(x.data(), y.data(), x.size() * sizeof(x[0])) == 0;
  };
  return same(a.cameras, b.cameras) && same(a.points, b.points) &&
         same(a.observations, b.observations);
}

/// The file of Small(), byte by byte.
std::string SmallFile(const TempFiles& files) {
  EXPECT_TRUE(WriteBal(Small(), files.Path("small.bbal")).ok());
  return files.Read("small.bbal");
}

TEST(BalBinary, ComesBackAsTheSameBitsWhateverItsName) {
  TempFiles files;
  const std::string bytes = SmallFile(files);
  EXPECT_EQ(bytes.size(), 48u + 3 * 72 + 4 * 24 + 12 * 24);
  EXPECT_EQ(bytes.substr(1, 4), "BBAL");
  EXPECT_EQ(files.Count(), 1);
  auto back = ReadBal(files.Path("small.bbal"));
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_TRUE(SameBits(*back, Small()));
  back = ReadBal(files.Write("named.txt", bytes));
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_TRUE(SameBits(*back, Small()));
  // And text in a .bbal is text.
  ASSERT_TRUE(WriteBal(Small(), files.Path("text.txt")).ok());
  back = ReadBal(files.Write("text.bbal", files.Read("text.txt")));
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_TRUE(SameBits(*back, Small()));
}

TEST(BalBinary, LongListsComeInParts) {
  TempFiles files;
  BalProblem problem = Small();
  problem.observations.resize((1 << 20) + 1000);
  for (std::size_t k = 0; k < problem.observations.size(); ++k) {
    const int i = static_cast<int>(k);
    problem.observations[k] = {i % 3, i % 4, i / 8.0, -i / 16.0};
  }
  const std::string path = files.Path("long.bbal");
  ASSERT_TRUE(WriteBal(problem, path).ok());
  auto back = ReadBal(path);
  ASSERT_TRUE(back.ok()) << back.status().message();
  EXPECT_TRUE(SameBits(*back, problem));
  EXPECT_EQ(back->observations.capacity(), problem.observations.size());
}

TEST(BalBinary, EveryPrefixAndEveryLongerFileIsRefused) {
  TempFiles files;
  const std::string good = SmallFile(files);
  for (std::size_t size = 0; size < good.size(); ++size) {
    const auto back = ReadBal(files.Write("cut", good.substr(0, size)));
    ASSERT_EQ(back.status().code(), StatusCode::kParseError) << size;
    ASSERT_NE(back.status().message().find("cut"), std::string::npos);
    ASSERT_TRUE(back.value().observations.empty());
  }
  for (const std::size_t more : {1, 24, 100000}) {
    const auto back = ReadBal(files.Write("more", good + std::string(more, '\0')));
    EXPECT_EQ(back.status().code(), StatusCode::kParseError) << more;
  }
}

TEST(BalBinary, EveryBitFlippedIsNoticed) {
  TempFiles files;
  const std::string good = SmallFile(files);
  for (std::size_t bit = 0; bit < 8 * good.size(); ++bit) {
    std::string bad = good;
    bad[bit / 8] = static_cast<char>(bad[bit / 8] ^ (1 << (bit % 8)));
    const auto back = ReadBal(files.Write("flipped", bad));
    ASSERT_EQ(back.status().code(), StatusCode::kParseError) << bit;
    ASSERT_EQ(back.status().message().find('\n'), std::string::npos);
  }
}

TEST(BalBinary, WhatIsWrongIsSaid) {
  TempFiles files;
  const std::string good = SmallFile(files);
  const auto message = [&](std::size_t at, const std::string& bytes) {
    std::string bad = good;
    bad.replace(at, bytes.size(), bytes);
    return ReadBal(files.Write("bad", bad)).status().message();
  };
  const auto ends = [](const std::string& text, const char* end) { return text.ends_with(end); };
  EXPECT_TRUE(ends(message(8, {"\2", 1}), "of a version that this program does not know"));
  EXPECT_TRUE(ends(message(12, {"\1\2\3\4", 4}), "written on a machine of another byte order"));
  EXPECT_TRUE(ends(message(16, std::string(8, '\0')), "counts must be 1 to 2147483647"));
  EXPECT_TRUE(ends(message(16, std::string(8, '\xff')), "counts must be 1 to 2147483647"));
  EXPECT_TRUE(ends(message(32, {"\0\0\0\x7f", 4}), "shorter than its counts say"));
  EXPECT_TRUE(ends(message(32, {"\1", 1}), "longer than its counts say"));
  EXPECT_TRUE(ends(message(200, "x"), "damaged (checksum)"));
}

TEST(BalBinary, WhatTheNumbersCannotMeanIsNamedUnderARightChecksumToo) {
  TempFiles files;
  const auto refused = [&](auto&& spoil, const char* says) {
    BalProblem bad = Small();
    spoil(bad);
    EXPECT_FALSE(WriteBal(bad, files.Path("no.bbal")).ok());
    EXPECT_EQ(files.Count(), 0);
    // As a writer that does not look would do it.
    ASSERT_TRUE(internal::WriteBalBinary(bad, files.Path("bad")).ok());
    const auto back = ReadBal(files.Path("bad"));
    EXPECT_EQ(back.status().code(), StatusCode::kParseError);
    EXPECT_NE(back.status().message().find(says), std::string::npos) << back.status().message();
    std::filesystem::remove(files.Path("bad"));
  };
  refused([](BalProblem& p) { p.observations[5].point = 4; }, "observation 5: no such point");
  refused([](BalProblem& p) { p.observations[5].camera = -1; }, "observation 5: no such camera");
  refused([](BalProblem& p) { p.observations[5].u = std::nan(""); }, "observation 5");
  refused([](BalProblem& p) { p.cameras[1].data[8] = INFINITY; }, "camera 1");
  refused([](BalProblem& p) { p.points[2].data[0] = std::nan(""); }, "point 2");
}

TEST(BalBinary, AHugeCountThroughAPipeCostsNoMemory) {
  TempFiles files;
  std::string bytes = SmallFile(files);
  const std::int64_t many = std::numeric_limits<std::int32_t>::max();
  for (const std::size_t at : {16, 24, 32})
    std::memcpy(bytes.data() + at, &many, sizeof(many));
  const std::string pipe = files.Path("pipe");
  ASSERT_EQ(mkfifo(pipe.c_str(), 0600), 0);
  std::thread writer([&] { std::ofstream(pipe, std::ios::binary) << bytes; });
  const auto back = ReadBal(pipe);
  writer.join();
  EXPECT_EQ(back.status().code(), StatusCode::kParseError);
  EXPECT_TRUE(back.status().message().ends_with("ends before all is there"));
}

}  // namespace
}  // namespace glissade
