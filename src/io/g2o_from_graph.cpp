// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <Eigen/Core>
#include <algorithm>
#include <string>
#include <utility>

#include "glissade/base/out_of_memory.h"
#include "glissade/graph/pools.h"
#include "glissade/io/g2o.h"

namespace glissade {

namespace {

Status Refused(const std::string& what) {
  return {StatusCode::kInvalidArgument, "G2oFromGraph: " + what};
}

/// Omega = L'L of an edge.
template <int N>
SquareMatrix<N> InformationOf(const EdgePool& pool, int edge) {
  const double* sqrt = pool.whitening(edge);
  if (sqrt == nullptr) return SquareMatrix<N>::Identity();
  const Eigen::Map<const SquareMatrix<N>> L(sqrt);
  return L.transpose() * L;
}

template <int N>
std::array<double, N*(N + 1) / 2> UpperTriangle(const SquareMatrix<N>& omega) {
  std::array<double, N*(N + 1) / 2> triangle;
  auto x = triangle.begin();
  for (int r = 0; r < N; ++r) {
    for (int c = r; c < N; ++c)
      *x++ = omega(r, c);
  }
  return triangle;
}

/// C' I C with C = diag(R, 2): of g2o's error what I is of ours.
std::array<double, 21> ToG2o(const Matrix6& information, const Matrix3& R) {
  Matrix6 C = 2.0 * Matrix6::Identity();
  C.topLeftCorner<3, 3>() = R;
  return UpperTriangle<6>(C.transpose() * information * C);
}

class Collector {
 public:
  explicit Collector(const Graph& graph) : graph_(graph) {}

  Result<G2oProblem> Run() {
    if (Status s = CheckTypes(); !s.ok()) return s;
    if (Status s = Vertices<VertexPose>(&pose_ids_,
                                        [&](std::int64_t id, const VertexPose& x, bool fixed) {
                                          problem_.poses.push_back({id, x.pose, fixed});
                                        });
        !s.ok()) {
      return s;
    }
    if (Status s = Vertices<VertexPointXYZ>(
            &point_ids_,
            [&](std::int64_t id, const VertexPointXYZ& x, bool fixed) {
              problem_.points.push_back({id, {x.data[0], x.data[1], x.data[2]}, fixed, false});
            });
        !s.ok()) {
      return s;
    }
    Edges();
    return std::move(problem_);
  }

 private:
  [[nodiscard]] Status CheckTypes() const {
    if (graph_.NumVertices() !=
        graph_.NumVertices<VertexPose>() + graph_.NumVertices<VertexPointXYZ>())
      return Refused("vertices other than VertexPose and VertexPointXYZ have no place in the file");
    if (graph_.NumEdges() != graph_.NumEdges<EdgeRelativePose>() + graph_.NumEdges<EdgeSE3Prior>() +
                                 graph_.NumEdges<EdgePosePoint>()) {
      return Refused(
          "edges other than EdgeRelativePose, EdgeSE3Prior and EdgePosePoint have no "
          "place in the file");
    }
    return {};
  }

  /// Numbers the vertices of a type, on from those before; ids: by slot.
  template <class V, class Put>
  Status Vertices(std::vector<std::int64_t>* ids, Put put) {
    Status status;
    graph_.ForEachVertex<V>([&](VertexHandle<V> handle, const V& x) {
      const Fix fix = graph_.GetFixed(handle);
      if (fix != Fix::kFree && fix != Fix::kWhole && status.ok())
        status = Status(StatusCode::kInvalidArgument,
                        "G2oFromGraph: a vertex that is held in part has no place in the file",
                        AnyVertex(handle));
      if (handle.slot >= ids->size()) ids->resize(handle.slot + std::size_t{1}, -1);
      (*ids)[handle.slot] = next_id_;
      put(next_id_++, x, fix == Fix::kWhole);
    });
    return status;
  }

  /// f(index in the pool, edge) for all that are there.
  template <class E, class F>
  void ForEach(F f) {
    const EdgePool* pool = graph_.Pool<E>();
    for (int k = 0; pool != nullptr && k < pool->size(); ++k) {
      if (pool->Alive(k)) f(*pool, k, pool->At<E>(k));
    }
  }
  void Edges() {
    ForEach<EdgeSE3Prior>([&](const EdgePool& pool, int k, const EdgeSE3Prior& edge) {
      problem_.priors.push_back({pose_ids_[pool.vertex_slot(k, 0)], OffsetOf(Pose()), edge.T_w_b,
                                 ToG2o(InformationOf<6>(pool, k), edge.T_w_b.R())});
    });
    ForEach<EdgeRelativePose>([&](const EdgePool& pool, int k, const EdgeRelativePose& edge) {
      problem_.relative_poses.push_back({pose_ids_[pool.vertex_slot(k, 0)],
                                         pose_ids_[pool.vertex_slot(k, 1)], edge.T_i_j,
                                         ToG2o(InformationOf<6>(pool, k), edge.T_i_j.R())});
    });
    ForEach<EdgePosePoint>([&](const EdgePool& pool, int k, const EdgePosePoint& edge) {
      problem_.point_measurements.push_back({pose_ids_[pool.vertex_slot(k, 0)],
                                             point_ids_[pool.vertex_slot(k, 1)],
                                             OffsetOf(edge.T_b_s),
                                             {edge.p_s[0], edge.p_s[1], edge.p_s[2]},
                                             UpperTriangle<3>(InformationOf<3>(pool, k))});
    });
  }

  /// Few sensors: their list is looked through.
  std::int64_t OffsetOf(const Pose& T_b_s) {
    for (const G2oOffset& offset : problem_.offsets) {
      if (offset.T_b_s == T_b_s) return offset.id;
    }
    const auto id = static_cast<std::int64_t>(problem_.offsets.size());
    problem_.offsets.push_back({id, T_b_s});
    return id;
  }

  const Graph& graph_;
  G2oProblem problem_;
  std::vector<std::int64_t> pose_ids_, point_ids_;
  std::int64_t next_id_ = 0;
};

}  // namespace

Result<G2oProblem> G2oFromGraph(const Graph& graph) {
  return internal::OrOutOfMemory([&] { return Collector(graph).Run(); });
}

}  // namespace glissade
