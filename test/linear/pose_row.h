// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <gtest/gtest.h>

#include <vector>

#include "common/random_states.h"
#include "glissade/glissade.h"

namespace glissade::test {

/// Two cameras on one body, T_b_c.
inline const Pose kLeftCamera(so3::ExpQuaternion(Vector3(0.1, -0.2, 0.3)),
                              Vector3(0.1, 0.05, -0.02));
inline const Pose kRightCamera(so3::ExpQuaternion(Vector3(0.1, -0.2, 0.31)),
                               Vector3(0.2, 0.05, -0.02));

/// Poses in a row along x from the origin on, each with a prior near it.
inline std::vector<VertexHandle<VertexPose>> AddPoseRow(int count, const Vector3& origin,
                                                        Random* random, Graph* graph) {
  std::vector<VertexHandle<VertexPose>> poses;
  for (int k = 0; k < count; ++k) {
    const Vector3 p = origin + Vector3(0.3 * k, 0.0, 0.0) + random->Vec3(0.1);
    poses.push_back(graph->AddVertex(VertexPose{Pose(so3::ExpQuaternion(random->Vec3(0.1)), p)}));
    EdgeOptions<EdgeSE3Prior> prior;
    prior.sqrt_information = SquareMatrix<6>(30.0 * SquareMatrix<6>::Identity());
    Pose mean = graph->Get(poses.back()).pose;
    mean.p() += random->Vec3(0.02);
    EXPECT_TRUE(graph->AddEdge(EdgeSE3Prior{mean}, {poses.back()}, prior).ok());
  }
  return poses;
}

/// Every other pose was linearized elsewhere.
inline void MoveFirstEstimates(const std::vector<VertexHandle<VertexPose>>& poses, Random* random,
                               Graph* graph) {
  for (std::size_t k = 0; k < poses.size(); k += 2) {
    Pose x = graph->Get(poses[k]).pose;
    x.p() += random->Vec3(0.05);
    x.q() = Quaternion(x.q() * so3::ExpQuaternion(random->Vec3(0.03)));
    x.Normalize();
    EXPECT_TRUE(graph->SetFirstEstimate(poses[k], {x.data, 7}).ok());
  }
}

/// Of a graph with several chunks of edges.
inline void ExpectThreadsChangeNoBit(const Graph& graph) {
  ASSERT_GT(graph.NumEdges(), 2 * Structure::kEdgesPerChunk);
  std::vector<Snapshot> results;
  for (const int threads : {1, 2, 4}) {
    Problem problem(graph.Clone());
    SolveOptions options;
    options.num_threads = threads;
    options.max_iterations = 4;
    EXPECT_TRUE(problem.Solve(options).ok());
    results.push_back(problem.GetSnapshot());
  }
  EXPECT_EQ(results[0].states, results[1].states);
  EXPECT_EQ(results[0].states, results[2].states);
}

}  // namespace glissade::test
