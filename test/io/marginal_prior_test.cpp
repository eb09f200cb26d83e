// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// A prior that Marginalize made, through a file and back.

#include <gtest/gtest.h>

#include <string>
#include <vector>

#include "glissade/io/viowin.h"
#include "glissade/lie/so3.h"
#include "glissade/marginal/drift.h"
#include "glissade/marginal/marginalize.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

ViowinWindow MakeWindow() {
  ViowinWindow window;
  for (int k = 0; k < 3; ++k) {
    ViowinKeyframe keyframe;
    keyframe.stamp = 0.25 * k;
    keyframe.T_w_b =
        Pose(so3::ExpQuaternion(Vector3(0.01 * k, 0.02, 0.1 * k)), Vector3(0.3 * k, 0.1 * k, 0.0));
    window.keyframes.push_back(keyframe);
    window.ground_truth.push_back(keyframe);
  }
  for (int l = 0; l < 4; ++l) {
    ViowinLandmark landmark;
    landmark.u_host = 0.2 * l - 0.3;
    landmark.v_host = 0.1 * l;
    landmark.rho = landmark.rho_true = 0.2;
    landmark.observations = {{1, 0.1 * l, 0.1}, {2, 0.1 * l - 0.1, 0.12}};
    window.landmarks.push_back(landmark);
  }
  return window;
}

TEST(MarginalPriorFile, ItsLinearizationPointsComeBackAsSuch) {
  ViowinWindow window = MakeWindow();
  Graph graph;
  const auto handles = AddToGraph(window, WindowKind::kVisualInertial, {}, &graph);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  std::vector<AnyVertex> out{handles->poses[0]};
  out.insert(out.end(), handles->depths.begin(), handles->depths.end());
  const auto prior = ComputeMarginalPrior(graph, out);
  ASSERT_TRUE(prior.ok());
  ASSERT_EQ(prior->vertices.size(), 2u);

  // The window moves on: its states are no longer those of the prior.
  ViowinMarginalPrior saved;
  saved.blocks = {{ViowinMarginalPrior::Kind::kPose, 1}, {ViowinMarginalPrior::Kind::kPose, 2}};
  saved.x0 = prior->x0;
  saved.r0 = prior->r0;
  saved.jacobian = prior->jacobian;
  window.marginal_priors.push_back(saved);
  window.landmarks.clear();
  window.keyframes[1].T_w_b.p() += Vector3(0.01, 0.02, 0.03);
  const TempFiles files;
  const std::string path = files.Path("prior.txt.gz");
  ASSERT_TRUE(WriteViowin({window}, path).ok());
  const auto read = ReadViowin(path);
  ASSERT_TRUE(read.ok()) << read.status().message();
  Graph again;
  const auto back = AddToGraph(read->front(), WindowKind::kVisualInertial, {}, &again);
  ASSERT_TRUE(back.ok());
  const auto edges = again.EdgesOf(back->poses[1]);
  ASSERT_TRUE(edges.ok());
  ASSERT_EQ(edges->size(), 1u);
  const auto handle = edges->front().As<DynamicEdge>();
  ASSERT_TRUE(handle);
  const EdgeMarginalPrior* edge = FindMarginalPrior(again, *handle);
  ASSERT_NE(edge, nullptr);
  EXPECT_TRUE(std::equal(edge->jacobian().begin(), edge->jacobian().end(), prior->jacobian.begin(),
                         prior->jacobian.end()));
  EXPECT_TRUE(again.HasFirstEstimate(back->poses[1]));
  EXPECT_FALSE(again.HasFirstEstimate(back->poses[0]));
  for (std::size_t k = 0; k < 7; ++k)
    EXPECT_EQ(again.LinearizationPoint(back->poses[1])[k], prior->x0[k]);
  const auto drift = Drift(again, *handle);
  ASSERT_TRUE(drift.ok());
  EXPECT_NEAR(drift->front().delta[2], 0.03, 1e-15);
  EXPECT_EQ(drift->back().delta[2], 0.0);
}

}  // namespace
}  // namespace glissade
