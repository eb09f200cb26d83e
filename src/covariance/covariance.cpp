// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/covariance/covariance.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <string>

#include "covariance/linearized_graph.h"
#include "covariance/reduced_factor.h"
#include "glissade/base/index.h"
#include "glissade/base/out_of_memory.h"
#include "glissade/linear/instruction_set.h"

namespace glissade {

namespace {

using internal::Index;

using RowMajor = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;
using Small = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, 0, 4, 4>;

Status Singular(const std::vector<AnyVertex>& vertices, int directions) {
  std::string names;
  const std::size_t shown = std::min<std::size_t>(vertices.size(), 20);
  for (std::size_t k = 0; k < shown; ++k)
    names += (k == 0 ? "" : ", ") + ToString(vertices[k]);
  if (shown < vertices.size()) names += ", ...";
  return {StatusCode::kSingular,
          "Covariance: " + std::to_string(directions) + " directions without information, at " +
              names + " (is the gauge free?)",
          vertices.front()};
}

}  // namespace

struct Covariance::Impl {
  LinearizedGraph linear;
  Gauge gauge;
  Orbit orbit;
  std::vector<AnyVertex> uninformed;
  bool ready = false;
  internal::ReducedFactor reduced;

  Status CheckLandmarks(double min_pivot);
  Status Factor(double min_pivot);
  /// H_ll^-1.
  [[nodiscard]] Small LandmarkInverse(int landmark) const;
  /// A of one vertex into columns of Y (n x dim).
  void FillColumns(const LinearizedGraph::Place& place, double* Y) const;
  [[nodiscard]] Result<JointCovariance> Joint(std::span<const AnyVertex> vertices) const;
};

Covariance::Covariance() : impl_(std::make_unique<Impl>()) {}
Covariance::~Covariance() = default;
Covariance::Covariance(Covariance&&) noexcept = default;
Covariance& Covariance::operator=(Covariance&&) noexcept = default;

const std::vector<AnyVertex>& Covariance::Uninformed() const {
  static const std::vector<AnyVertex> kNone;
  return impl_ == nullptr ? kNone : impl_->uninformed;  // null: moved from
}

int JointCovariance::IndexOf(AnyVertex vertex) const {
  const auto at = std::find(vertices.begin(), vertices.end(), vertex);
  return at == vertices.end() ? -1 : static_cast<int>(at - vertices.begin());
}

Small Covariance::Impl::LandmarkInverse(int landmark) const {
  const DenseBlock block = linear.hessian->Landmark(Index(landmark)).H();
  const int dim = block.rows;
  const Eigen::Map<const RowMajor> H(block.data, dim, dim);
  // Scaled like S: units of a point and of its weights do not matter then.
  const Eigen::VectorXd scale = H.diagonal().cwiseSqrt().cwiseInverse();
  const Small scaled = scale.asDiagonal() * H * scale.asDiagonal();
  return scale.asDiagonal() * scaled.llt().solve(Small::Identity(dim, dim)) * scale.asDiagonal();
}

Status Covariance::Impl::CheckLandmarks(double min_pivot) {
  int directions = 0;
  for (std::size_t l = 0; l < linear.hessian->num_landmarks(); ++l) {
    const DenseBlock H = linear.hessian->Landmark(l).H();
    const int dim = H.rows;
    // Cholesky of the scaled block, pivots counted.
    double L[16] = {};
    int missing = 0;
    for (int c = 0; c < dim; ++c) {
      for (int r = c; r < dim; ++r) {
        const double scale = std::sqrt(H(r, r) * H(c, c));
        double value = scale > 0.0 ? H(r, c) / scale : 0.0;
        for (int k = 0; k < c; ++k)
          value -= L[r * 4 + k] * L[c * 4 + k];
        if (r == c) {
          const bool good = value > min_pivot;
          missing += good ? 0 : 1;
          L[c * 4 + c] = good ? std::sqrt(value) : 0.0;
        } else {
          L[r * 4 + c] = L[c * 4 + c] > 0.0 ? value / L[c * 4 + c] : 0.0;
        }
      }
    }
    if (missing == 0) continue;
    directions += missing;
    uninformed.push_back(linear.Handle(linear.structure.landmarks()[l]));
  }
  return uninformed.empty() ? Status() : Singular(uninformed, directions);
}

Status Covariance::Impl::Factor(double min_pivot) {
  if (reduced.Factor(&linear.equations, min_pivot)) return {};
  for (const PoseBlock& pose : linear.structure.poses()) {
    const auto begin = reduced.missing().begin() + pose.offset;
    if (std::find(begin, begin + pose.dim, 1) == begin + pose.dim) continue;
    uninformed.push_back(linear.Handle(pose));
  }
  if (uninformed.empty()) {
    return {StatusCode::kSingular, "Covariance: the reduced system is not positive definite"};
  }
  return Singular(uninformed, reduced.num_missing());
}

Status Covariance::Compute(Graph* graph, const CovarianceOptions& options) {
  if (impl_ != nullptr) {
    impl_->ready = false;
    impl_->uninformed.clear();
  }
  if (Status status = CheckInstructionSet(); !status.ok()) return status;
  if (!(options.min_pivot >= 0.0 && options.min_pivot < 1.0)) {
    return {StatusCode::kInvalidArgument, "Covariance: min_pivot must be in [0, 1)"};
  }
  if (options.num_threads < 1 || options.num_threads > 1024) {
    return {StatusCode::kInvalidArgument, "Covariance: num_threads must be 1 to 1024"};
  }
  if (options.gauge.group != GaugeGroup::kAuto && Dimension(options.gauge.group) == 0) {
    return {StatusCode::kInvalidArgument, "Covariance: gauge.group is no GaugeGroup"};
  }
  // Does not come back where something throws: what is half done is not used again.
  std::unique_ptr<Impl> impl = std::move(impl_);
  return internal::OrOutOfMemory([&]() -> Status {
    if (impl == nullptr) impl = std::make_unique<Impl>();
    impl->gauge = options.gauge;
    Result<Orbit> orbit = Orbit::Of(*graph, options.gauge.group);
    // A graph without poses has no gauge, but may well have a covariance.
    impl->orbit = orbit.ok() ? std::move(orbit).value() : Orbit();
    Status status = impl->linear.Linearize(graph, options.gauge, options.num_threads);
    if (status.ok()) status = impl->CheckLandmarks(options.min_pivot);
    if (status.ok()) status = impl->linear.Eliminate(*graph);
    if (status.ok()) status = impl->Factor(options.min_pivot);
    impl->ready = status.ok();
    impl_ = std::move(impl);
    return status;
  });
}

void Covariance::Impl::FillColumns(const LinearizedGraph::Place& place, double* Y) const {
  if (place.pose >= 0) {
    return reduced.SelectPose(linear.structure.poses()[Index(place.pose)], linear.tangents, Y);
  }
  if (place.landmark < 0) return;
  const Hessian::LandmarkPart landmark = linear.hessian->Landmark(Index(place.landmark));
  const Small inverse = LandmarkInverse(place.landmark);
  const int n = reduced.size();
  for (int s = 0; s < landmark.num_slots(); ++s) {
    const DenseBlock W = landmark.W(s);
    const Eigen::Map<const RowMajor> block(W.data, W.rows, W.cols);
    for (int r = 0; r < W.rows; ++r) {
      for (int c = 0; c < W.cols; ++c)
        Y[Index(landmark.row(s) + r) + Index(c) * Index(n)] = -block.row(r).dot(inverse.col(c));
    }
  }
}

Result<JointCovariance> Covariance::Joint(std::span<const AnyVertex> vertices) const {
  if (impl_ == nullptr || !impl_->ready) {
    return Status(StatusCode::kInvalidArgument, "Covariance: call Compute() first");
  }
  return internal::OrOutOfMemory([&] { return impl_->Joint(vertices); });
}

Result<JointCovariance> Covariance::Impl::Joint(std::span<const AnyVertex> vertices) const {
  const Impl& impl = *this;
  JointCovariance out;
  out.gauge = impl.gauge;
  out.orbit = impl.orbit;
  out.references = impl.linear.references;
  out.offsets.push_back(0);
  std::vector<LinearizedGraph::Place> places;
  for (const AnyVertex& vertex : vertices) {
    const LinearizedGraph::Place* place = impl.linear.Find(vertex);
    if (place == nullptr) {
      return Status(StatusCode::kUnknownHandle,
                    "Covariance: vertex " + ToString(vertex) + " was not in the graph", vertex);
    }
    if (place->unconnected) {
      return Status(StatusCode::kSingular, "Covariance: no edge on vertex " + ToString(vertex),
                    vertex);
    }
    if (out.IndexOf(vertex) >= 0) {
      return Status(StatusCode::kRepeatedVertex,
                    "Covariance: vertex " + ToString(vertex) + " is given twice", vertex);
    }
    places.push_back(*place);
    out.vertices.push_back(vertex);
    out.offsets.push_back(out.offsets.back() + place->dim);
    out.state_offsets.push_back(out.states.size());
    out.states.insert(out.states.end(), place->state.begin(), place->state.end());
  }
  const int m = out.size();
  const int n = impl.reduced.size();
  Eigen::MatrixXd Y = Eigen::MatrixXd::Zero(n, m);
  for (std::size_t i = 0; i < places.size(); ++i) {
    impl.FillColumns(places[i], Y.data() + Index(out.offsets[i]) * Index(n));
  }
  reduced.ForwardSolve(m, Y.data());
  Eigen::MatrixXd cov = Y.transpose() * Y;
  for (std::size_t i = 0; i < places.size(); ++i) {
    if (places[i].landmark < 0) continue;
    const Small inverse = impl.LandmarkInverse(places[i].landmark);
    cov.block(out.offsets[i], out.offsets[i], inverse.rows(), inverse.cols()) += inverse;
  }
  out.values.assign(cov.data(), cov.data() + cov.size());
  if (!cov.allFinite()) return Status(StatusCode::kNotFinite, "Covariance: not finite");
  return out;
}

Result<JointCovariance> ComputeCovariance(Graph* graph, std::span<const AnyVertex> vertices,
                                          const CovarianceOptions& options) {
  for (const AnyVertex& vertex : vertices) {
    if (graph->Contains(vertex)) continue;
    return internal::About(graph->UnknownHandle(vertex), "Covariance");
  }
  return internal::OrOutOfMemory([&]() -> Result<JointCovariance> {
    Covariance covariance;
    if (Status status = covariance.Compute(graph, options); !status.ok()) return status;
    return covariance.Joint(vertices);
  });
}

Result<JointCovariance> Covariance::Joint(std::initializer_list<AnyVertex> vertices) const {
  return Joint(std::span(vertices.begin(), vertices.size()));
}

}  // namespace glissade
