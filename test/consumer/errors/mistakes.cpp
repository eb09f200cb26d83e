// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A range edge as a user writes it, and the mistakes one makes. MISTAKE names one; without it all
// is well and this compiles.
#include <glissade/glissade.h>

namespace {

using namespace glissade;

#define RIGHT 0
#define JACOBIAN_SIZE 1        // of vertex 1: 1 x 6 in place of 1 x 3
#define JACOBIAN_SIZE_FIRST 2  // of vertex 0
#define MISSING_CONST 3
#define RESIDUAL_SIZE 4
#define VERTEX_ORDER 5
#define RETURNS_VOID 6
#define NO_VERTICES 7
#define NO_RESIDUAL_DIM 8
#define SWAPPED_HANDLES 9
#define TOO_FEW_HANDLES 10
#define ANY_HANDLE 11
#define SWAPPED_HANDLES_BUILT_IN 12
#define VERTEX_WITHOUT_CONST_DATA 13
#define RELATIVE_POSE_OF_A_POINT 14
#ifndef MISTAKE
#define MISTAKE RIGHT
#endif

struct EdgeRange {
#if MISTAKE != NO_VERTICES
  using Vertices = VertexList<VertexPose, VertexPointXYZ>;
#endif
#if MISTAKE != NO_RESIDUAL_DIM
  static constexpr int kResidualDim = 1;
#endif
  double measured = 0.0;
#if MISTAKE == RELATIVE_POSE_OF_A_POINT
  static constexpr auto kFirstEstimateRule = FirstEstimateRule::kRelativePose;
#endif

#if MISTAKE == RETURNS_VOID
  void
#else
  bool
#endif
  Evaluate(
#if MISTAKE == VERTEX_ORDER
      const VertexPointXYZ& point, const VertexPose& pose,
#else
      const VertexPose& pose, const VertexPointXYZ& point,
#endif
#if MISTAKE == RESIDUAL_SIZE
      Vector<2>& r,
#else
      Vector<1>& r,
#endif
#if MISTAKE == JACOBIAN_SIZE_FIRST
      Jacobian<1, 7>* d_r_d_pose,
#else
      Jacobian<1, 6>* d_r_d_pose,
#endif
#if MISTAKE == JACOBIAN_SIZE
      Jacobian<1, 6>* d_r_d_point)
#else
      Jacobian<1, 3>* d_r_d_point)
#endif
#if MISTAKE != MISSING_CONST
      const
#endif
  {
    r[0] = (point.p() - pose.pose.p()).norm() - measured;
    if (d_r_d_pose != nullptr) d_r_d_pose->setZero();
    if (d_r_d_point != nullptr) d_r_d_point->setZero();
#if MISTAKE != RETURNS_VOID
    return true;
#endif
  }
};

struct VertexScale {
  static constexpr int kAmbientDim = 1;
  static constexpr int kTangentDim = 1;
  double value = 1.0;
  double* Data() { return &value; }
#if MISTAKE != VERTEX_WITHOUT_CONST_DATA
  const double* Data() const {
    return &value;
  }
#endif
  void Plus(const double* delta) {
    value += *delta;
  }
  void Minus(const VertexScale& x0, double* delta) const {
    *delta = value - x0.value;
  }
};

}  // namespace

int main() {
  Problem problem;
  const auto pose = problem.AddVertex(VertexPose{});
  const auto target = problem.AddVertex(VertexPose{});
  const auto point = problem.AddVertex(VertexPointXYZ{});
  const auto depth = problem.AddVertex(VertexInverseDepth{0.5});
  const auto scale = problem.AddVertex(VertexScale{});
  const AnyVertex any = point.value();
#if MISTAKE == SWAPPED_HANDLES
  const auto edge = problem.AddEdge(EdgeRange{}, {point, pose});
#elif MISTAKE == TOO_FEW_HANDLES
  const auto edge = problem.AddEdge(EdgeRange{}, {pose});
#elif MISTAKE == ANY_HANDLE
  const auto edge = problem.AddEdge(EdgeRange{}, {pose, any});
#else
  const auto edge = problem.AddEdge(EdgeRange{}, {pose, point});
#endif
#if MISTAKE == SWAPPED_HANDLES_BUILT_IN
  const auto seen =
      problem.AddEdge(EdgeReprojection{}, {depth, pose, target}, {.loss = Huber{1.0}});
#else
  const auto seen =
      problem.AddEdge(EdgeReprojection{}, {pose, target, depth}, {.loss = Huber{1.0}});
#endif
  return edge.ok() && seen.ok() && scale.ok() && any ? 0 : 1;
}
