// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// Marginalizing the oldest keyframe of a visual-inertial window with its 60 landmarks: 75 variables
// go, 150 stay, under a prior of 165 rows on all 11 keyframes. All forms side by side, and the way
// of VINS-Mono: two dense eigendecompositions, the depths in with the rest.
//
//   bench_marginalize WINDOWS.txt[.gz] [--window N] [--save FILE.txt.gz]
//
// GLISSADE_ISA chooses the kernels. The prior is made by marginalizing a keyframe before the
// window's first, which is tied to every keyframe by an IMU term and by 60 landmarks.

#include <Eigen/Dense>
#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "../app/common/count_allocations.h"
#include "glissade/edges/marginal_prior.h"
#include "glissade/glissade.h"
#include "glissade/io/viowin.h"
#include "glissade/linear/instruction_set.h"
#include "glissade/marginal/marginalize.h"

namespace glissade {
namespace {

double Now() {
  return std::chrono::duration<double>(std::chrono::steady_clock::now().time_since_epoch()).count();
}

/// Median seconds of `times` calls.
template <class F>
double Median(int times, F&& f) {
  std::vector<double> seconds;
  for (int k = 0; k < times; ++k) {
    const double start = Now();
    f();
    seconds.push_back(Now() - start);
  }
  std::nth_element(seconds.begin(), seconds.begin() + times / 2, seconds.end());
  return seconds[static_cast<std::size_t>(times / 2)];
}

/// What the preintegration between two states would have measured.
PreintegratedImu Between(const ViowinKeyframe& i, const ViowinKeyframe& j, double dt,
                         const Vector3& g, const PreintegratedImu& like) {
  PreintegratedImu imu = like;
  const Matrix3 R = i.T_w_b.R().transpose();
  const Vector3 v_i = i.speed_bias.v(), v_j = j.speed_bias.v();
  imu.dt = dt;
  imu.dp = R * (j.T_w_b.p() - i.T_w_b.p() - dt * v_i - 0.5 * dt * dt * g);
  imu.dv = R * (v_j - v_i - dt * g);
  imu.dq = i.T_w_b.q().conjugate() * j.T_w_b.q();
  return imu;
}

/// The window under the prior that is left of a keyframe before it.
Result<ViowinWindow> WithPrior(const ViowinWindow& window) {
  Problem problem;
  const auto handles = AddToGraph(window, WindowKind::kVisualInertial, {}, &problem);
  if (!handles.ok()) return handles.status();
  // Everything but the new keyframe's own terms is kept out of the prior: it does not touch it.
  ViowinKeyframe before = window.ground_truth[0];
  const double dt = window.ground_truth[1].stamp - window.ground_truth[0].stamp;
  const Vector3 v = before.speed_bias.v();
  before.T_w_b.p() -= dt * v;
  const auto pose = problem.AddVertex(VertexPose{before.T_w_b});
  const auto speed_bias = problem.AddVertex(before.speed_bias);
  const std::size_t frames = window.keyframes.size();
  for (std::size_t k = 0; k < frames; ++k) {
    EdgeImu edge;
    edge.gravity = window.gravity;
    edge.imu = Between(before, window.ground_truth[k], dt * double(k + 1), window.gravity,
                       window.imu[0].imu);
    const auto added = problem.AddEdge(
        edge, {pose, speed_bias, handles->poses[k], handles->speed_biases[k]},
        {.sqrt_information = SquareMatrix<15>(window.imu[0].sqrt_information / double(k + 1))});
    if (!added.ok()) return added.status();
  }
  std::vector<AnyVertex> out{pose.value(), speed_bias.value()};
  const Matrix2 focal =
      Vector2(window.camera.fx, window.camera.fy).asDiagonal() * (1.0 / window.camera.sigma_px);
  for (int l = 0; l < 60; ++l) {
    const double depth = 4.0 + 0.1 * l;
    const Vector2 uv(0.5 * std::sin(1.3 * l), 0.4 * std::cos(2.1 * l));
    const auto rho = problem.AddVertex(VertexInverseDepth{1.0 / depth});
    out.emplace_back(rho.value());
    const Vector3 x_w =
        before.T_w_b * (window.T_b_c * Vector3(uv[0] * depth, uv[1] * depth, depth));
    for (std::size_t k = 0; k < frames; ++k) {
      const Vector3 x = window.T_b_c.Inverse() * (window.ground_truth[k].T_w_b.Inverse() * x_w);
      if (x[2] < 0.5) continue;
      EdgeReprojection edge;
      edge.T_b_c = window.T_b_c;
      edge.uv_host = uv;
      edge.uv_target = Vector2(x[0] / x[2], x[1] / x[2]);
      const auto added =
          problem.AddEdge(edge, {pose, handles->poses[k], rho}, {.sqrt_information = focal});
      if (!added.ok()) return added.status();
    }
  }
  // The window's own absolute priors belong to this keyframe: without them the prior had no rank.
  EdgeSE3Prior absolute;
  absolute.T_w_b = before.T_w_b;
  if (auto e = problem.AddEdge(
          absolute, {pose},
          {.sqrt_information = SquareMatrix<6>(100.0 * SquareMatrix<6>::Identity())});
      !e.ok()) {
    return e.status();
  }
  if (auto e = problem.AddEdge(
          EdgeSpeedBiasPrior{before.speed_bias}, {speed_bias},
          {.sqrt_information = SquareMatrix<9>(10.0 * SquareMatrix<9>::Identity())});
      !e.ok()) {
    return e.status();
  }
  const auto prior = problem.ComputeMarginalPrior(out);
  if (!prior.ok()) return prior.status();

  ViowinWindow with = window;
  with.pose_priors.clear();
  with.speed_bias_priors.clear();
  ViowinMarginalPrior saved;
  for (const AnyVertex& vertex : prior->vertices) {
    for (std::size_t k = 0; k < frames; ++k) {
      using Kind = ViowinMarginalPrior::Kind;
      const auto index = static_cast<std::int32_t>(k);
      if (vertex == AnyVertex(handles->poses[k])) saved.blocks.push_back({Kind::kPose, index});
      if (vertex == AnyVertex(handles->speed_biases[k])) {
        saved.blocks.push_back({Kind::kSpeedBias, index});
      }
    }
  }
  saved.x0 = prior->x0;
  saved.r0 = prior->r0;
  saved.jacobian = prior->jacobian;
  with.marginal_priors.push_back(std::move(saved));
  return with;
}

/// The eigendecompositions of VINS-Mono's marginalization on a dense H, 1e-8 absolute as there.
void VinsWay(const Eigen::MatrixXd& H, const Eigen::VectorXd& b, int m, Eigen::MatrixXd* J,
             Eigen::VectorXd* r) {
  const Eigen::Index n = H.rows() - m;
  const auto inverse = [](const Eigen::VectorXd& lambda) {
    return Eigen::VectorXd((lambda.array() > 1e-8).select(lambda.array().inverse(), 0.0));
  };
  const Eigen::MatrixXd H_mm = 0.5 * (H.topLeftCorner(m, m) + H.topLeftCorner(m, m).transpose());
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> eigen(H_mm);
  const Eigen::MatrixXd H_mm_inverse = eigen.eigenvectors() *
                                       inverse(eigen.eigenvalues()).asDiagonal() *
                                       eigen.eigenvectors().transpose();
  const Eigen::MatrixXd A = H.bottomLeftCorner(n, m) * H_mm_inverse;
  const Eigen::MatrixXd S = H.bottomRightCorner(n, n) - A * H.topRightCorner(m, n);
  const Eigen::VectorXd b_s = b.tail(n) - A * b.head(m);
  const Eigen::SelfAdjointEigenSolver<Eigen::MatrixXd> left(S);
  const Eigen::VectorXd lambda =
      (left.eigenvalues().array() > 1e-8).select(left.eigenvalues().array(), 0.0);
  *J = lambda.cwiseSqrt().asDiagonal() * left.eigenvectors().transpose();
  *r = inverse(lambda).cwiseSqrt().asDiagonal() * (left.eigenvectors().transpose() * -b_s);
}

struct DenseSystem {
  Eigen::MatrixXd H;
  Eigen::VectorXd b;
  int going = 0;
};

/// H and b of what is folded in, what goes first: through the step API.
DenseSystem FoldedSystem(const Graph& graph, const std::vector<AnyVertex>& out) {
  Problem folded(graph.Clone());
  for (const AnyEdge& edge : folded.Edges()) {
    const auto vertices = folded.VerticesOf(edge).value();
    const bool touched = std::any_of(vertices.begin(), vertices.end(), [&](AnyVertex v) {
      return std::find(out.begin(), out.end(), v) != out.end();
    });
    if (!touched && !folded.RemoveEdge(edge).ok()) std::exit(1);
  }
  if (!folded.MakeHessian().ok()) std::exit(1);
  const auto vertices = folded.FreeVertices();
  const auto offsets = folded.FreeOffsets();
  std::vector<int> order;
  DenseSystem system;
  for (const bool going : {true, false}) {
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      if ((std::find(out.begin(), out.end(), vertices[k]) != out.end()) != going) continue;
      for (int i = offsets[k]; i < offsets[k + 1]; ++i)
        order.push_back(i);
    }
    if (going) system.going = static_cast<int>(order.size());
  }
  system.H = folded.Hessian()(order, order);
  system.b = folded.Rhs()(order);
  return system;
}

int Main(int argc, char** argv) {
  std::string path, save;
  std::size_t number = 0;
  for (int k = 1; k < argc; ++k) {
    if (std::strcmp(argv[k], "--window") == 0 && k + 1 < argc) {
      number = static_cast<std::size_t>(std::atoi(argv[++k]));
    } else if (std::strcmp(argv[k], "--save") == 0 && k + 1 < argc) {
      save = argv[++k];
    } else {
      path = argv[k];
    }
  }
  const auto windows = ReadViowin(path);
  if (!windows.ok() || number >= windows->size()) {
    std::fprintf(stderr, "bench_marginalize: %s\n",
                 windows.ok() ? "no such window" : windows.status().message().c_str());
    return 1;
  }
  const auto made = WithPrior((*windows)[number]);
  if (!made.ok()) {
    std::fprintf(stderr, "bench_marginalize: %s\n", made.status().message().c_str());
    return 1;
  }
  const ViowinWindow& window = *made;
  if (!save.empty()) {
    if (const Status s = WriteViowin({window}, save); !s.ok()) {
      std::fprintf(stderr, "bench_marginalize: %s\n", s.message().c_str());
      return 1;
    }
  }

  Problem problem;
  const auto handles = AddToGraph(window, WindowKind::kVisualInertial, {}, &problem);
  if (!handles.ok()) return 1;
  std::vector<AnyVertex> out{handles->poses[0], handles->speed_biases[0]};
  for (std::size_t l = 0; l < window.landmarks.size(); ++l) {
    if (window.landmarks[l].host == 0) out.emplace_back(handles->depths[l]);
  }
  const DenseSystem dense = FoldedSystem(problem, out);
  std::printf(
      "window %lld, %s kernels: prior of %zu rows, %d variables go (%zu landmarks), "
      "%d stay\n",
      static_cast<long long>(window.id), InstructionSetName(), window.marginal_priors[0].r0.size(),
      dense.going, out.size() - 2, static_cast<int>(dense.H.rows()) - dense.going);

  // The exact H* for comparison, in long double.
  using MatrixXl = Eigen::Matrix<long double, Eigen::Dynamic, Eigen::Dynamic>;
  const MatrixXl H = dense.H.cast<long double>();
  const Eigen::Index m = dense.going, n = H.rows() - m;
  const MatrixXl exact =
      H.bottomRightCorner(n, n) -
      H.bottomLeftCorner(n, m) * H.topLeftCorner(m, m).ldlt().solve(H.topRightCorner(m, n));

  struct Form {
    const char* name;
    MarginalizeOptions options;
  };
  const Form forms[] = {
      {"square root, QR", {}},
      {"Schur + Cholesky", {.form = MarginalForm::kSchur}},
      {"Schur + eigenvalues", {.form = MarginalForm::kSchur, .root = InformationRoot::kEigen}},
  };
  std::printf("%-22s %12s %12s %12s %14s\n", "", "compute [ms]", "apply [ms]", "allocations",
              "|J'J - H*|/|H*|");
  for (const Form& form : forms) {
    MarginalWorkspace workspace;
    MarginalPrior prior;
    const auto compute = [&] {
      const Status s = ComputeMarginalPrior(problem, out, form.options, &workspace, &prior);
      if (!s.ok()) {
        std::fprintf(stderr, "bench_marginalize: %s\n", s.message().c_str());
        std::exit(1);
      }
    };
    compute();
    const long long before = app::num_allocations;
    compute();
    const long long allocations = app::num_allocations - before;
    const double seconds = Median(201, compute);
    // With the change of the graph: each time on another copy.
    std::vector<double> applied;
    for (int k = 0; k < 51; ++k) {
      Graph copy = problem.Graph::Clone();
      const double start = Now();
      const auto done = Marginalize(&copy, out, form.options, &workspace);
      applied.push_back(Now() - start);
      if (!done.ok()) return 1;
    }
    std::nth_element(applied.begin(), applied.begin() + 25, applied.end());
    // Columns of the prior in the order of the dense system: vertices of each type ascend in both.
    const Eigen::Map<const Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>>
        J(prior.jacobian.data(), prior.rows(), prior.tangent_dim);
    std::vector<int> pose_columns, other_columns;
    int column = 0;
    for (const AnyVertex& vertex : prior.vertices) {
      const bool is_pose = vertex.type == &kTypeInfo<VertexPose>;
      for (int i = 0; i < (is_pose ? 6 : 9); ++i)
        (is_pose ? pose_columns : other_columns).push_back(column++);
    }
    pose_columns.insert(pose_columns.end(), other_columns.begin(), other_columns.end());
    const Eigen::MatrixXd ordered = J(Eigen::all, pose_columns);
    const MatrixXl product = ordered.cast<long double>().transpose() * ordered.cast<long double>();
    std::printf("%-22s %12.3f %12.3f %12lld %14.1e\n", form.name, 1e3 * seconds, 1e3 * applied[25],
                allocations, static_cast<double>((product - exact).norm() / exact.norm()));
  }
  Eigen::MatrixXd J;
  Eigen::VectorXd r;
  const double vins = Median(51, [&] { VinsWay(dense.H, dense.b, dense.going, &J, &r); });
  const MatrixXl product = J.cast<long double>().transpose() * J.cast<long double>();
  std::printf("%-22s %12.3f %12s %12s %14.1e  (without linearization)\n", "VINS, two eigen",
              1e3 * vins, "", "", static_cast<double>((product - exact).norm() / exact.norm()));

  // What the prior costs a solve.
  Problem without(problem.Graph::Clone());
  for (const AnyEdge& edge : without.Edges()) {
    if (edge.type == &kTypeInfo<DynamicEdge> && !without.RemoveEdge(edge).ok()) return 1;
  }
  if (!without.SetFixed(handles->poses[0]).ok()) return 1;
  const auto time_solve = [&](Problem* p) {
    const Snapshot start = p->GetSnapshot();
    SolveOptions options;
    options.max_iterations = 8;
    options.cost_tolerance = options.step_tolerance = options.gradient_tolerance = 0.0;
    int iterations = 0;
    TimeSplit split;
    const double seconds = Median(101, [&] {
      if (!p->RestoreSnapshot(start).ok()) std::exit(1);
      const SolveSummary& summary = p->Solve(options);
      split = summary.time;
      iterations = summary.accepted_steps + summary.rejected_steps;
    });
    std::printf("  analyze %.3f linearize %.3f eliminate %.3f solve %.3f cost %.3f ms\n",
                1e3 * split.analyze_s, 1e3 * split.linearize_s, 1e3 * split.eliminate_s,
                1e3 * split.solve_s, 1e3 * split.cost_s);
    return std::pair(seconds, iterations);
  };
  const auto [with_s, with_n] = time_solve(&problem);
  const auto [without_s, without_n] = time_solve(&without);
  std::printf("solve: %.3f ms with the prior (%d iterations), %.3f ms without (%d): %+.1f %%\n",
              1e3 * with_s, with_n, 1e3 * without_s, without_n,
              100.0 * (with_s / with_n / (without_s / without_n) - 1.0));
  return 0;
}

}  // namespace
}  // namespace glissade

int main(int argc, char** argv) {
  return glissade::Main(argc, argv);
}
