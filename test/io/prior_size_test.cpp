// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A marginal prior of one row over many landmarks is a small file, and was a Hessian of gigabytes.

#include <gtest/gtest.h>

#include <string>

#include "glissade/io/viowin.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

/// One keyframe, `count` landmarks, and a prior of one row over all of these.
ViowinWindow MakeWindow(std::size_t count) {
  ViowinWindow window;
  window.keyframes.emplace_back();
  window.ground_truth.emplace_back();
  ViowinMarginalPrior prior;
  for (std::size_t k = 0; k < count; ++k) {
    ViowinLandmark landmark;
    landmark.rho = landmark.rho_true = 0.2;
    window.landmarks.push_back(landmark);
    prior.blocks.push_back({ViowinMarginalPrior::Kind::kInverseDepth, static_cast<int>(k)});
  }
  prior.x0.assign(count, 0.2);
  prior.r0 = {1.0};
  prior.jacobian.assign(count, 1.0);
  window.marginal_priors.push_back(prior);
  return window;
}

std::string PriorText(std::size_t count) {
  std::string text = "MARG_PRIOR " + std::to_string(count) + " 1";
  for (std::size_t k = 0; k < count; ++k)
    text += " l " + std::to_string(k);
  for (std::size_t k = 0; k < 2 * count + 1; ++k)
    text += " 1";
  return text + "\n";
}

TEST(PriorSize, APriorWhoseHessianWouldTakeGigabytesIsRefused) {
  const TempFiles files;
  ViowinWindow window = MakeWindow(30000);
  EXPECT_EQ(window.Validate().code(), StatusCode::kInvalidArgument);
  Graph graph;
  EXPECT_FALSE(AddToGraph(window, WindowKind::kVisualInertial, {}, &graph).ok());
  EXPECT_EQ(graph.NumVertices(), 0);
  window.marginal_priors.clear();
  ASSERT_TRUE(WriteViowin({window}, files.Path("window.txt")).ok());
  std::string text = files.Read("window.txt");
  const std::size_t end = text.rfind("END");
  ASSERT_NE(end, std::string::npos);
  text.insert(end, PriorText(30000));
  const auto read = ReadViowin(files.Write("prior.txt", text));
  ASSERT_FALSE(read.ok());
  EXPECT_EQ(read.status().code(), StatusCode::kParseError);
  EXPECT_NE(read.status().message().find("tangent dimensions"), std::string::npos)
      << read.status().message();
}

TEST(PriorSize, TheLargestThatCanBeMeantIsTaken) {
  const TempFiles files;
  const ViowinWindow window = MakeWindow(ViowinMarginalPrior::kMaxTangentDim);
  const std::string path = files.Path("window.txt.gz");
  ASSERT_TRUE(WriteViowin({window}, path).ok());
  const auto read = ReadViowin(path);
  ASSERT_TRUE(read.ok()) << read.status().message();
  Graph graph;
  EXPECT_TRUE(AddToGraph(read->front(), WindowKind::kVisualInertial, {}, &graph).ok());
}

}  // namespace
}  // namespace glissade
