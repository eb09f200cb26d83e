// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "support/random_graph.h"

#include <algorithm>
#include <cstdio>
#include <cstdlib>
#include <memory>
#include <vector>

#include "glissade/edges/bal.h"
#include "glissade/edges/pose_prior_vec.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_extrinsic.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/graph/pools.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/tukey.h"
#include "support/dynamic_edges.h"
#include "support/graph_random.h"
#include "support/user_types.h"

namespace glissade::test {

namespace {

constexpr double kFocal = 460.0;  // px per unit of normalized coordinates; sigma is 1 px

/// A generator that builds an invalid graph is a bug of the generator.
void Require(const Status& status) {
  if (status.ok()) return;
  std::fprintf(stderr, "random graph: %s\n", status.message().c_str());
  std::abort();
}
template <class T>
T Require(const Result<T>& result) {
  Require(result.status());
  return result.value();
}

class Builder {
 public:
  Builder(std::uint64_t seed, const RandomGraphOptions& options)
      : random_(seed), options_(options) {
    // Anywhere in the world: nothing is aligned with the axes, quaternions of either sign.
    world_ = random_.RandomPose(5.0);
  }

  Graph Build(GraphKind kind) {
    if (kind == GraphKind::kBal) {
      AddBal(options_.num_poses, options_.num_landmarks);
    } else {
      AddPoses();
    }
    const int n = options_.num_landmarks;
    if (kind == GraphKind::kMonoWindow) AddInverseDepthLandmarks(n, false);
    if (kind == GraphKind::kPointBundle) AddPoints(n);
    if (kind == GraphKind::kPoseGraph) AddRelativePoses();
    if (kind == GraphKind::kMixed) {
      AddRelativePoses();
      AddInverseDepthLandmarks((n + 2) / 3, false);
      AddInverseDepthLandmarks((n + 3) / 4, true);
      AddPoints((n + 2) / 3);
      AddUserLandmarks((n + 3) / 4);
      AddBal(3 + options_.num_poses / 8, 12 + n / 8);
    }
    if (options_.anchored || kind == GraphKind::kPoseGraph)
      AddPriors(kind == GraphKind::kPoseGraph);
    if (options_.fixes) FixSome();
    // After it is known what is eliminated: an edge may hold one eliminated vertex.
    if (kind == GraphKind::kMixed) AddDynamicEdges();
    if (options_.removals) RemoveSome();
    return std::move(graph_);
  }

 private:
  // ---- Weights and losses ----
  template <class E>
  EdgeOptions<E> Weight(double inverse_sigma) {
    constexpr int kRows = E::kResidualDim;
    EdgeOptions<E> options;
    if (!options_.information) {
      options.sqrt_information = inverse_sigma * SquareMatrix<kRows>::Identity();
    } else if (random_.Chance(0.3)) {
      options.sqrt_information =
          inverse_sigma * (SquareMatrix<kRows>::Identity() + 0.3 * random_.NormalMatrix<kRows>());
    } else {
      SquareMatrix<kRows> information = random_.Spd<kRows>();
      if (kRows == 2 && random_.Chance(0.1)) {  // one direction only, as at an edge in the image
        const Vector<kRows> v = random_.NormalVector<kRows>(1.0);
        information = v * v.transpose();
      }
      options.information = inverse_sigma * inverse_sigma * information;
    }
    return options;
  }

  Loss RandomLoss() {
    if (!options_.losses) return {};
    switch (random_.Int(8)) {
      case 0:
      case 1:
        return Huber{1.5};
      case 2:
        return Cauchy{2.0};
      case 3:
        return Tukey{8.0};
      case 4:
        return GemanMcClure{6.0};
      case 5:
        return Amplify{1e-3};
      default:
        return {};
    }
  }

  /// Measurement noise of one pixel, or a gross outlier where the loss can deal with it.
  template <class E>
  EdgeOptions<E> Observe(const Vector2& exact, double pixel, Vector2* measured) {
    EdgeOptions<E> options = Weight<E>(1.0 / pixel);
    options.loss = RandomLoss();
    const Loss& loss = options.loss;
    const bool robust = loss.type() == &kTypeInfo<Huber> || loss.type() == &kTypeInfo<Cauchy> ||
                        loss.type() == &kTypeInfo<Tukey>;
    const double sigma = robust && random_.Chance(0.1) ? 40.0 * pixel : pixel;
    *measured = exact + random_.NormalVector<2>(sigma);
    return options;
  }

  // ---- Poses ----
  void AddPoses() {
    T_b_c_ = {random_.Rotation(0.1), random_.Vec3(0.1)};
    T_b_c_right_ = {random_.Rotation(0.1), Vector3(0.2, 0.0, 0.0) + random_.Vec3(0.02)};
    for (int k = 0; k < options_.num_poses; ++k) {
      const Pose local(random_.Rotation(random_.Uniform(0.0, 0.2)),
                       Vector3(0.3 * k, 0.0, 0.0) + random_.Vec3(0.3));
      truth_.push_back(world_ * local);
      poses_.push_back(Require(graph_.AddVertex(VertexPose{Start(truth_.back())})));
    }
  }

  Pose Start(const Pose& truth) {
    return random_.Perturb(truth, 3.0 * options_.start_noise, options_.start_noise);
  }

  void AddPriors(bool all_kinds) {
    for (int k = 0; k < options_.num_poses && !poses_.empty(); ++k) {
      if (k > 0 && !random_.Chance(all_kinds ? 0.4 : 0.3)) continue;
      const Pose measured = random_.Perturb(truth_[Index(k)], 0.05, 0.02);
      if (random_.Chance(0.5)) {
        auto options = Weight<EdgeSE3Prior>(20.0);
        options.loss = RandomLoss();
        Require(graph_.AddEdge(EdgeSE3Prior{measured}, {poses_[Index(k)]}, options));
      } else {
        auto options = Weight<EdgePosePriorVec>(20.0);
        options.loss = RandomLoss();
        Require(graph_.AddEdge(EdgePosePriorVec{measured}, {poses_[Index(k)]}, options));
      }
    }
  }

  void AddRelativePose(int i, int j) {
    const Pose exact = truth_[Index(i)].Inverse() * truth_[Index(j)];
    auto options = Weight<EdgeRelativePose>(50.0);
    options.loss = RandomLoss();
    Require(graph_.AddEdge(EdgeRelativePose{random_.Perturb(exact, 0.02, 0.01)},
                           {poses_[Index(i)], poses_[Index(j)]}, options));
  }

  void AddRelativePoses() {
    for (int k = 1; k < options_.num_poses; ++k) {
      random_.Chance(0.5) ? AddRelativePose(k - 1, k) : AddRelativePose(k, k - 1);
      if (k >= 3 && random_.Chance(0.3)) AddRelativePose(k, random_.Int(k - 2));
    }
  }

  // ---- Landmarks seen by the poses ----
  /// A point some metres before camera `frame`.
  Vector3 PointBefore(int frame) {
    const Vector3 x_c(random_.Uniform(-2.0, 2.0), random_.Uniform(-2.0, 2.0),
                      random_.Uniform(4.0, 10.0));
    return truth_[Index(frame)] * (T_b_c_ * x_c);
  }
  /// Normalized coordinates; false where the point is not well before the camera.
  bool Project(int frame, const Pose& T_b_c, const Vector3& x_w, Vector2* xy) const {
    const Vector3 x_c = T_b_c.Inverse() * (truth_[Index(frame)].Inverse() * x_w);
    if (x_c[2] < 1.0) return false;
    *xy = x_c.head<2>() / x_c[2];
    return xy->norm() < 2.0;
  }
  /// `count` different frames other than `host`, near it where there are many.
  std::vector<int> FramesNear(int host, int count) {
    std::vector<int> frames;
    for (int k = std::max(0, host - 8); k < std::min(options_.num_poses, host + 9); ++k) {
      if (k != host) frames.push_back(k);
    }
    for (std::size_t k = frames.size(); k > 1; --k)
      std::swap(frames[k - 1], frames[Index(random_.Int(static_cast<int>(k)))]);
    frames.resize(std::min(frames.size(), Index(count)));
    return frames;
  }

  void AddInverseDepthLandmarks(int count, bool free_extrinsic) {
    if (free_extrinsic) {
      extrinsic_ = Require(graph_.AddVertex(VertexPose{random_.Perturb(T_b_c_, 0.01, 0.01)}));
      EdgeOptions<EdgeSE3Prior> options = Weight<EdgeSE3Prior>(50.0);
      Require(
          graph_.AddEdge(EdgeSE3Prior{random_.Perturb(T_b_c_, 0.01, 0.01)}, {extrinsic_}, options));
    }
    for (int l = 0; l < count; ++l) {
      const int host = random_.Int(options_.num_poses);
      const Vector3 x_w = PointBefore(host);
      const double z = (T_b_c_.Inverse() * (truth_[Index(host)].Inverse() * x_w))[2];
      Vector2 uv_host;
      if (!Project(host, T_b_c_, x_w, &uv_host)) continue;
      const VertexInverseDepth start{(1.0 + 5.0 * options_.start_noise * random_.Normal()) / z};
      const auto depth = Require(graph_.AddVertex(start));
      landmarks_.push_back(depth);
      for (const int target : FramesNear(host, options_.min_views - 1 + random_.Int(4))) {
        const auto i = poses_[Index(host)], j = poses_[Index(target)];
        Vector2 uv;
        if (!Project(target, T_b_c_, x_w, &uv)) continue;
        if (free_extrinsic) {
          EdgeReprojectionExtrinsic edge{.uv_host = uv_host};
          const auto options =
              Observe<EdgeReprojectionExtrinsic>(uv, 1.0 / kFocal, &edge.uv_target);
          Require(graph_.AddEdge(edge, {i, j, depth, extrinsic_}, options));
          continue;
        }
        EdgeReprojection edge{.uv_host = uv_host, .T_b_c = T_b_c_};
        auto options = Observe<EdgeReprojection>(uv, 1.0 / kFocal, &edge.uv_target);
        Require(graph_.AddEdge(edge, {i, j, depth}, options));
      }
    }
  }

  void AddPoints(int count) {
    for (int l = 0; l < count; ++l) {
      const int first = random_.Int(options_.num_poses);
      const Vector3 x_w = PointBefore(first);
      const Vector3 start = x_w + random_.NormalVector<3>(5.0 * options_.start_noise);
      const auto point = Require(graph_.AddVertex(VertexPointXYZ(start)));
      landmarks_.push_back(point);
      points_.push_back(point);
      point_truth_.push_back(x_w);
      std::vector<int> frames = FramesNear(first, options_.min_views - 1 + random_.Int(4));
      frames.push_back(first);
      for (const int frame : frames) {
        const bool stereo = random_.Chance(0.3);
        for (const Pose* T_b_c : {&T_b_c_, stereo ? &T_b_c_right_ : nullptr}) {
          Vector2 uv;
          if (T_b_c == nullptr || !Project(frame, *T_b_c, x_w, &uv)) continue;
          EdgeReprojectionXYZ edge{.T_b_c = *T_b_c};
          const auto options = Observe<EdgeReprojectionXYZ>(uv, 1.0 / kFocal, &edge.uv);
          Require(graph_.AddEdge(edge, {poses_[Index(frame)], point}, options));
        }
      }
    }
  }

  // ---- BAL ----
  void AddBal(int num_cameras, int num_points) {
    std::vector<VertexHandle<VertexCameraBal>> cameras;
    std::vector<VertexCameraBal> truth;
    for (int k = 0; k < num_cameras; ++k) {
      VertexCameraBal camera;
      const Vector3 omega = (k == 0 ? 0.0 : random_.Uniform(0.0, 2.5)) * random_.Direction();
      const Vector3 t = Vector3(0.0, 0.0, -6.0) + random_.Vec3(0.5);
      const double intrinsics[3] = {500.0 + 50.0 * random_.Normal(), -0.02 * random_.Normal(),
                                    0.005 * random_.Normal()};
      std::copy_n(omega.data(), 3, camera.data);
      std::copy_n(t.data(), 3, camera.data + 3);
      std::copy_n(intrinsics, 3, camera.data + 6);
      truth.push_back(camera);
      double delta[9];
      for (int i = 0; i < 9; ++i)
        delta[i] = options_.start_noise * random_.Normal();
      delta[6] *= 100.0;
      camera.Plus(delta);
      cameras.push_back(Require(graph_.AddVertex(camera)));
      bal_cameras_.push_back(cameras.back());
      if (options_.anchored) {  // few views leave the intrinsics and the seven of the gauge open
        const VertexRef ref{&kVertexOps<VertexCameraBal>, truth.back().data};
        const AnyVertex vertex = cameras.back();
        Require(graph_.AddEdge(std::make_unique<LinearEdge>(std::span(&ref, 1), 9, &random_),
                               std::span(&vertex, 1)));
      }
    }
    for (int l = 0; l < num_points; ++l) {
      const Vector3 x = random_.Vec3(1.5);
      const auto point = Require(
          graph_.AddVertex(VertexPointXYZ(x + random_.NormalVector<3>(5 * options_.start_noise))));
      landmarks_.push_back(point);
      for (int k = 0; k < num_cameras; ++k) {
        if (num_cameras > 8 && !random_.Chance(8.0 / num_cameras)) continue;
        Vector2 uv;
        EdgeBal edge;
        if (!edge.Evaluate(truth[Index(k)], VertexPointXYZ(x), uv, nullptr, nullptr)) continue;
        const auto options = Observe<EdgeBal>(uv, 1.0, &edge.uv);
        Require(graph_.AddEdge(edge, {cameras[Index(k)], point}, options));
      }
    }
  }

  // ---- A user's own types ----
  void AddUserLandmarks(int count) {
    scale_ = Require(graph_.AddVertex(VertexScale{1.3}));
    small_.push_back(scale_);
    for (int l = 0; l < count; ++l) {
      const int first = random_.Int(options_.num_poses);
      std::vector<int> frames = FramesNear(first, options_.min_views - 1 + random_.Int(3));
      frames.push_back(first);

      const Vector3 d_b = Vector3(random_.Uniform(-0.5, 0.5), random_.Uniform(-0.5, 0.5), 1.0);
      const Vector3 d_w = (truth_[Index(first)].R() * d_b).normalized();
      VertexBearing bearing{{d_w[0], d_w[1], d_w[2]}};
      const Vector2 step = random_.NormalVector<2>(options_.start_noise);
      const VertexBearing bearing_truth = bearing;
      bearing.Plus(step.data());
      const auto bearing_handle = Require(graph_.AddVertex(bearing));
      landmarks_.push_back(bearing_handle);

      const Vector2 slope = random_.NormalVector<2>(0.3);
      const auto& p0 = truth_[Index(first)];
      const VertexLine line{{p0.data[0] - slope[0] * p0.data[2], p0.data[1] - slope[1] * p0.data[2],
                             slope[0], slope[1]}};
      const auto line_handle = Require(graph_.AddVertex(line));
      landmarks_.push_back(line_handle);

      const auto offset = Require(graph_.AddVertex(
          VertexVector<2>{{random_.Uniform(-1.0, 1.0), random_.Uniform(-1.0, 1.0)}}));
      small_.push_back(offset);

      for (const int frame : frames) {
        const auto pose = poses_[Index(frame)];
        const VertexPose at{truth_[Index(frame)]};
        EdgeBearing observation;
        Vector2 xy;
        if (observation.Evaluate(at, bearing_truth, xy, nullptr, nullptr) && xy.norm() < 2.0) {
          const auto options = Observe<EdgeBearing>(xy, 1.0 / kFocal, &observation.xy);
          Require(graph_.AddEdge(observation, {pose, bearing_handle}, options));
        }
        EdgeOnLine on_line;
        Vector2 gap;
        on_line.Evaluate(at, line, gap, nullptr, nullptr);
        on_line.offset = gap + random_.NormalVector<2>(0.05);
        Require(graph_.AddEdge(on_line, {pose, line_handle}, Weight<EdgeOnLine>(20.0)));
        const EdgeOffset edge{Vector3(at.pose.p()) + random_.Vec3(1.0)};
        Require(graph_.AddEdge(edge, {pose, offset}, Weight<EdgeOffset>(5.0)));
      }
    }
    for (std::size_t l = 0; l < points_.size(); ++l) {
      const int frame = random_.Int(options_.num_poses);
      const double distance = (truth_[Index(frame)].p() - point_truth_[l]).norm();
      const EdgeScaledRange range{1.2 * distance + 0.05 * random_.Normal()};
      auto options = Weight<EdgeScaledRange>(20.0);
      options.loss = RandomLoss();
      Require(graph_.AddEdge(range, {poses_[Index(frame)], points_[l], scale_}, options));
    }
  }

  // ---- Dynamic edges ----
  bool IsEliminated(AnyVertex vertex) const {
    const VertexPoolBase* pool = graph_.PoolOf(vertex.type);
    return pool->eliminated(pool->slots().IndexOf(vertex.slot));
  }
  VertexRef RefTo(AnyVertex vertex) const {
    const VertexPoolBase* pool = graph_.PoolOf(vertex.type);
    return {&pool->ops(), pool->Data(pool->slots().IndexOf(vertex.slot))};
  }

  void AddDynamicEdges() {
    const int sizes[] = {2, 2, 3, 5, 9, 17, 40};
    for (const int size : sizes) {
      for (const bool constant : {false, true}) {
        std::vector<AnyVertex> vertices = graph_.Vertices();
        for (std::size_t k = vertices.size(); k > 1; --k)
          std::swap(vertices[k - 1], vertices[Index(random_.Int(static_cast<int>(k)))]);
        std::vector<AnyVertex> chosen;
        std::vector<VertexRef> refs;
        bool has_eliminated = false;
        for (const AnyVertex& vertex : vertices) {
          const VertexRef ref = RefTo(vertex);
          if (static_cast<int>(chosen.size()) == size) break;
          if (constant && !LinearEdge::Takes(*ref.ops)) continue;
          if (IsEliminated(vertex) && has_eliminated) continue;
          has_eliminated = has_eliminated || IsEliminated(vertex);
          chosen.push_back(vertex);
          refs.push_back(ref);
        }
        if (chosen.size() < 2) continue;
        const int rows = 1 + random_.Int(8);
        if (constant) {
          Require(graph_.AddEdge(std::make_unique<LinearEdge>(refs, rows, &random_), chosen));
        } else {
          Require(graph_.AddEdge(std::make_unique<SineEdge>(refs, rows, &random_), chosen,
                                 RandomLoss()));
        }
      }
    }
  }

  // ---- What is held, eliminated, removed ----
  void FixSome() {
    for (const auto& pose : poses_) {
      if (!random_.Chance(0.35)) continue;
      const Fix kinds[] = {Fix::kWhole, Fix::kPosition, Fix::kPositionAndYaw};
      Require(graph_.SetFixed(pose, kinds[random_.Int(3)]));
    }
    for (const auto& camera : bal_cameras_) {
      if (random_.Chance(0.2)) Require(graph_.SetFixed(camera));
    }
    for (const AnyVertex& landmark : landmarks_) {
      if (random_.Chance(0.1)) Require(graph_.SetFixed(landmark));
      if (random_.Chance(0.15)) Require(graph_.SetEliminated(landmark, false));
    }
    for (const AnyVertex& vertex : small_) {
      // May be refused: the edge to it may hold a landmark already.
      if (random_.Chance(0.5) && !graph_.SetEliminated(vertex, true).ok()) {
        static_cast<void>(graph_.AcknowledgeRefusal());
      }
    }
    if (extrinsic_ != VertexHandle<VertexPose>() && random_.Chance(0.3)) {
      Require(graph_.SetFixed(extrinsic_, Fix::kPosition));
    }
    // Something must be left to solve for.
    if (!poses_.empty()) Require(graph_.SetFixed(poses_.back(), Fix::kFree));
    if (!bal_cameras_.empty()) Require(graph_.SetFixed(bal_cameras_.back(), Fix::kFree));
  }

  void RemoveSome() {
    for (const AnyEdge& edge : graph_.Edges()) {
      if (random_.Chance(0.05)) Require(graph_.RemoveEdge(edge));
    }
    for (const AnyVertex& landmark : landmarks_) {
      if (random_.Chance(0.1)) Require(graph_.RemoveVertex(landmark));
    }
    if (poses_.size() > 4) Require(graph_.RemoveVertex(poses_[Index(random_.Int(3))]));
    // A slot that became free is used again by what comes next.
    if (!poses_.empty()) {
      const auto added = Require(graph_.AddVertex(VertexPose{Start(truth_[0])}));
      Require(graph_.AddEdge(EdgeSE3Prior{truth_[0]}, {added}, Weight<EdgeSE3Prior>(20.0)));
      Require(graph_.AddEdge(EdgeRelativePose{truth_.back().Inverse() * truth_[0]},
                             {poses_.back(), added}, Weight<EdgeRelativePose>(20.0)));
    }
  }

  static std::size_t Index(int i) { return static_cast<std::size_t>(i); }

  GraphRandom random_;
  RandomGraphOptions options_;
  Graph graph_;
  Pose world_, T_b_c_, T_b_c_right_;
  std::vector<Pose> truth_;
  std::vector<VertexHandle<VertexPose>> poses_;
  std::vector<AnyVertex> landmarks_, bal_cameras_;
  std::vector<AnyVertex> small_;  ///< usually kept, of few dimensions
  std::vector<VertexHandle<VertexPointXYZ>> points_;
  std::vector<Vector3> point_truth_;
  VertexHandle<VertexScale> scale_;
  VertexHandle<VertexPose> extrinsic_;
};

}  // namespace

std::string ToString(GraphKind kind) {
  switch (kind) {
    case GraphKind::kMonoWindow:
      return "MonoWindow";
    case GraphKind::kPointBundle:
      return "PointBundle";
    case GraphKind::kPoseGraph:
      return "PoseGraph";
    case GraphKind::kBal:
      return "Bal";
    case GraphKind::kMixed:
      break;
  }
  return "Mixed";
}

Graph MakeRandomGraph(GraphKind kind, std::uint64_t seed, const RandomGraphOptions& options) {
  return Builder(seed, options).Build(kind);
}

}  // namespace glissade::test
