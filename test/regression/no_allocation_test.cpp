// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Nothing is allocated from the second iteration on, in a re-solve, and in the steady state of a
// sliding window. Counted in malloc and its relatives, on all threads.

#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <vector>

#include "glissade/glissade.h"
#include "regression/malloc_count.h"

namespace glissade {
namespace {

/// A camera that moves along x past points at depth 5, one frame after the other. Some are inverse
/// depths, others points in the world that two cameras see.
class Window {
 public:
  explicit Window(bool robust) : robust_(robust) {}

  Status AddFrame() {
    const Pose truth(Quaternion::Identity(), Vector3(0.2 * frame_, 0.0, 0.0));
    Pose start = truth;
    start.data[1] += 0.01 * std::sin(frame_);
    frames_.push_back(problem.AddVertex(VertexPose{start}).value());
    if (frames_.size() == 1) {
      if (Status status = problem.SetFixed(frames_.front()); !status.ok()) return status;
    }
    EdgeOptions<EdgeRelativePose> motion;
    motion.sqrt_information = SquareMatrix<6>(50.0 * SquareMatrix<6>::Identity());
    if (frames_.size() > 1) {
      const Pose step(Quaternion::Identity(), Vector3(0.2, 0.0, 0.0));
      const auto edge = problem.AddEdge(EdgeRelativePose{step},
                                        {frames_[frames_.size() - 2], frames_.back()}, motion);
      if (!edge.ok()) return edge.status();
    }
    // Points that the frame before hosts are seen from here.
    EdgeOptions<EdgeReprojection> options;
    options.sqrt_information = Matrix2(400.0 * Matrix2::Identity());
    if (robust_) options.loss = Cauchy{2.0};  // a loss without a kernel
    for (int k = 0; frames_.size() > 1 && k < 12; ++k) {
      const auto depth = problem.AddVertex(VertexInverseDepth{0.2 + 0.002 * k});
      EdgeReprojection edge;
      edge.uv_host = Vector2(0.05 * k - 0.3, 0.03 * (k % 5));
      edge.uv_target = edge.uv_host - Vector2(0.04, 0.001 * std::cos(k + frame_));
      const auto added =
          problem.AddEdge(edge, {frames_[frames_.size() - 2], frames_.back(), depth}, options);
      if (!added.ok()) return added.status();
      landmarks_.push_back(depth.value());
    }
    for (int k = 0; frames_.size() > 1 && k < 9; ++k) {
      if (Status status = AddPoint(k); !status.ok()) return status;
    }
    ++frame_;
    return {};
  }

  Status RemoveOldest() {
    for (int k = 0; k < 12; ++k) {
      if (Status status = problem.RemoveVertex(landmarks_[static_cast<std::size_t>(k)]);
          !status.ok()) {
        return status;
      }
    }
    landmarks_.erase(landmarks_.begin(), landmarks_.begin() + 12);
    for (int k = 0; k < 9; ++k) {
      if (Status status = problem.RemoveVertex(points_[static_cast<std::size_t>(k)]); !status.ok())
        return status;
    }
    points_.erase(points_.begin(), points_.begin() + 9);
    if (Status status = problem.RemoveVertex(frames_.front()); !status.ok()) return status;
    frames_.erase(frames_.begin());
    return problem.SetFixed(frames_.front());
  }

  [[nodiscard]] VertexHandle<VertexPose> frame(int k) const {
    return frames_[static_cast<std::size_t>(k)];
  }

  Problem problem;

 private:
  /// Seen by the last two frames.
  Status AddPoint(int k) {
    const Vector3 x(0.2 * frame_ + 0.3 * k - 1.2, 0.2 * (k % 4) - 0.3, 5.0);
    const auto point = problem.AddVertex(VertexPointXYZ(x));
    if (!point.ok()) return point.status();
    EdgeOptions<EdgeReprojectionXYZ> options;
    options.sqrt_information = Matrix2(400.0 * Matrix2::Identity());
    if (robust_) options.loss = Cauchy{2.0};
    for (int seen = 0; seen < 4; ++seen) {
      const int back = seen / 2;
      EdgeReprojectionXYZ edge;
      edge.T_b_c.p() = Vector3(0.1 * (seen % 2), 0.0, 0.0);
      edge.uv = Vector2((x[0] - 0.2 * (frame_ - back) - 0.1 * (seen % 2)) / x[2],
                        x[1] / x[2] + 0.001 * std::sin(k + frame_ + seen));
      const auto& pose = frames_[frames_.size() - 1 - static_cast<std::size_t>(back)];
      const auto added = problem.AddEdge(edge, {pose, *point}, options);
      if (!added.ok()) return added.status();
    }
    points_.push_back(point.value());
    return {};
  }

  bool robust_;
  int frame_ = 0;
  std::vector<VertexHandle<VertexPose>> frames_;
  std::vector<VertexHandle<VertexInverseDepth>> landmarks_;
  std::vector<VertexHandle<VertexPointXYZ>> points_;
};

class NoAllocation : public ::testing::TestWithParam<std::tuple<bool, int>> {
 protected:
  void SetUp() override {
    if (test::MallocCount() < 0) GTEST_SKIP() << "allocations cannot be counted in this build";
    options_.max_iterations = 5;
    options_.cost_tolerance = options_.gradient_tolerance = options_.step_tolerance = 0.0;
    options_.num_threads = std::get<1>(GetParam());
  }
  [[nodiscard]] bool robust() const { return std::get<0>(GetParam()); }

  SolveOptions options_;
};

TEST_P(NoAllocation, CountsAtAll) {
  const std::int64_t before = test::MallocCount();
  std::vector<double>* v = new std::vector<double>(100);
  EXPECT_GE(test::MallocCount() - before, 2);
  delete v;
}

TEST_P(NoAllocation, FromTheSecondIterationOn) {
  Window window(robust());
  for (int k = 0; k < 10; ++k)
    ASSERT_TRUE(window.AddFrame().ok());
  std::int64_t after_first = 0, last = 0;
  options_.callback = [&](const IterationSummary& iteration) {
    last = test::MallocCount();
    if (iteration.iteration == 1) after_first = last;
    return CallbackAction::kContinue;
  };
  const SolveSummary& summary = window.problem.Solve(options_);
  ASSERT_GE(summary.accepted_steps, 3) << summary.BriefReport();
  EXPECT_EQ(last - after_first, 0);
}

/// One that is linearized as a whole at first estimates, with more rows than most.
struct EdgeManyRows {
  using Vertices = VertexList<VertexPose>;
  static constexpr int kResidualDim = 80;
  bool Evaluate(const VertexPose& pose, Vector<80>& r, Jacobian<80, 6>* J) const {
    for (int k = 0; k < 80; ++k)
      r[k] = pose.pose.data[k % 3];
    if (J == nullptr) return true;
    J->setZero();
    for (int k = 0; k < 80; ++k)
      (*J)(k, k % 3) = 1.0;
    return true;
  }
};

// More than 64 rows were kept in a new array for each linearization of the edge.
TEST_P(NoAllocation, OfEdgesWithManyRowsAtFirstEstimates) {
  Window window(robust());
  for (int k = 0; k < 10; ++k)
    ASSERT_TRUE(window.AddFrame().ok());
  Problem& problem = window.problem;
  ASSERT_TRUE(problem.SetFirstEstimates(FirstEstimates::kFull).ok());
  const double x_lin[7] = {1.0, 0.1, 0.0, 0.0, 0.0, 0.0, 1.0};
  ASSERT_TRUE(problem.SetFirstEstimate(window.frame(4), x_lin).ok());
  ASSERT_TRUE(problem.AddEdge(EdgeManyRows(), {window.frame(4)}).ok());
  const Snapshot start = problem.GetSnapshot();
  problem.Solve(options_);
  ASSERT_TRUE(problem.RestoreSnapshot(start).ok());
  const std::int64_t before = test::MallocCount();
  const SolveSummary& summary = problem.Solve(options_);
  EXPECT_EQ(test::MallocCount() - before, 0);
  EXPECT_GE(summary.accepted_steps, 3) << summary.BriefReport();
}

TEST_P(NoAllocation, InAReSolve) {
  Window window(robust());
  for (int k = 0; k < 10; ++k)
    ASSERT_TRUE(window.AddFrame().ok());
  const Snapshot start = window.problem.GetSnapshot();
  window.problem.Solve(options_);
  ASSERT_TRUE(window.problem.RestoreSnapshot(start).ok());
  const std::int64_t before = test::MallocCount();
  const SolveSummary& summary = window.problem.Solve(options_);
  EXPECT_EQ(test::MallocCount() - before, 0);
  EXPECT_GE(summary.accepted_steps, 3);
}

// What a gauge holds was a list on the heap, in each solve.
TEST_P(NoAllocation, InAReSolveUnderAFixedGauge) {
  Window window(robust());
  for (int k = 0; k < 10; ++k)
    ASSERT_TRUE(window.AddFrame().ok());
  options_.gauge = Gauge::Fixed{window.frame(0)};
  window.problem.Solve(options_);
  options_.gauge = Gauge::Fixed{window.frame(5)};
  for (int turn = 0; turn < 3; ++turn) {
    ASSERT_TRUE(window.problem
                    .Set(window.frame(5),
                         VertexPose{Pose(Quaternion::Identity(), Vector3(1.0, 0.02 * turn, 0.0))})
                    .ok());
    const std::int64_t before = test::MallocCount();
    const SolveSummary& summary = window.problem.Solve(options_);
    const std::int64_t after = test::MallocCount();
    if (turn > 0) {
      EXPECT_EQ(after - before, 0);
    }
    EXPECT_GE(summary.accepted_steps, 1);
  }
}

TEST_P(NoAllocation, InASlidingWindow) {
  Window window(robust());
  for (int k = 0; k < 10; ++k)
    ASSERT_TRUE(window.AddFrame().ok());
  std::int64_t settled = 0;
  for (int turn = 0; turn < 1000; ++turn) {
    if (turn == 50) settled = test::MallocCount();
    ASSERT_TRUE(window.AddFrame().ok());
    ASSERT_TRUE(window.problem.Solve(options_).ok());
    ASSERT_TRUE(window.RemoveOldest().ok());
  }
  EXPECT_EQ(test::MallocCount() - settled, 0);
  EXPECT_EQ(window.problem.NumVertices<VertexPose>(), 10);
}

INSTANTIATE_TEST_SUITE_P(PathsAndThreads, NoAllocation,
                         ::testing::Combine(::testing::Bool(), ::testing::Values(1, 2)));

}  // namespace
}  // namespace glissade
