// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What marginalization does to the information of a sliding window, as numbers to be drawn
// (scripts/plot_marginalization.py): the information matrix of a simulated visual-inertial window
// before, with what goes moved first, and after; and the information that the window claims to have
// about yaw and position, which nothing observes, from frame to frame, for each treatment of first
// estimates.

#include <Eigen/Core>
#include <algorithm>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "common/cli.h"
#include "common/output_file.h"
#include "glissade/gauge/nullspace.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/vi_world.h"

namespace glissade::app {
namespace {

struct Settings {
  int frames = 60;
  int window = 7;
  int points = 240;
  std::uint64_t seed = 1;
};

/// A window that slides over a simulated flight: frames come with what they see, the oldest goes
/// with all points it has seen.
class SlidingWindow {
 public:
  SlidingWindow(const sim::ViProblem& data, FirstEstimates mode) : data_(data) {
    problem_.SetFirstEstimates(mode);
    points_.resize(data.start.points.size());
    gone_.resize(points_.size(), false);
    observations_of_.resize(data.stamps_ns.size());
    for (const sim::ViObservation& o : data.observations)
      observations_of_[static_cast<std::size_t>(o.keyframe)].push_back(&o);
  }

  Problem& problem() { return problem_; }
  [[nodiscard]] int size() const { return static_cast<int>(frames_.size()); }

  Status AddFrame(std::size_t k) {
    Frame frame;
    auto pose = problem_.AddVertex(data_.start.poses[k]);
    auto speed_bias = problem_.AddVertex(data_.start.speed_biases[k]);
    if (!pose.ok()) return pose.status();
    if (!speed_bias.ok()) return speed_bias.status();
    frame.pose = pose.value();
    frame.speed_bias = speed_bias.value();
    if (!frames_.empty()) {
      const ImuFactor& imu = data_.imu[k - 1];
      const auto edge = problem_.AddEdge(
          imu.edge, {frames_.back().pose, frames_.back().speed_bias, frame.pose, frame.speed_bias},
          imu.options);
      if (!edge.ok()) return edge.status();
    }
    const sim::ViCamera& camera = data_.cameras[0];
    const Matrix2 root = (Matrix2() << camera.fx, 0, 0, camera.fy).finished() / camera.sigma_px;
    for (const sim::ViObservation* o : observations_of_[k]) {
      const auto p = static_cast<std::size_t>(o->point);
      if (gone_[p]) continue;  // what it told is in the prior
      if (!problem_.Contains(AnyVertex(points_[p]))) {
        auto point = problem_.AddVertex(data_.start.points[p]);
        if (!point.ok()) return point.status();
        points_[p] = point.value();
      }
      EdgeReprojectionXYZ edge;
      edge.T_b_c = camera.T_b_c;
      edge.uv = Vector2((o->u - camera.cx) / camera.fx, (o->v - camera.cy) / camera.fy);
      const auto added =
          problem_.AddEdge(edge, {frame.pose, points_[p]}, {.sqrt_information = root});
      if (!added.ok()) return added.status();
      frame.points.push_back(p);
    }
    frames_.push_back(frame);
    return {};
  }

  /// The oldest frame and the points it has seen, as far as they are still there.
  std::vector<AnyVertex> Oldest() const {
    std::vector<AnyVertex> vertices{frames_.front().pose, frames_.front().speed_bias};
    for (const std::size_t p : frames_.front().points) {
      if (!gone_[p] && problem_.Contains(AnyVertex(points_[p]))) vertices.emplace_back(points_[p]);
    }
    return vertices;
  }

  Status MarginalizeOldest() {
    const auto done = problem_.Marginalize(Oldest());
    if (!done.ok()) return done.status();
    for (const std::size_t p : frames_.front().points)
      gone_[p] = true;
    frames_.erase(frames_.begin());
    return {};
  }

 private:
  struct Frame {
    VertexHandle<VertexPose> pose;
    VertexHandle<VertexSpeedBias> speed_bias;
    std::vector<std::size_t> points;
  };

  const sim::ViProblem& data_;
  Problem problem_;
  std::vector<Frame> frames_;
  std::vector<VertexHandle<VertexPointXYZ>> points_;
  std::vector<bool> gone_;
  std::vector<std::vector<const sim::ViObservation*>> observations_of_;
};

nlohmann::json ToJson(const Eigen::MatrixXd& A) {
  nlohmann::json rows = nlohmann::json::array();
  for (Eigen::Index r = 0; r < A.rows(); ++r) {
    nlohmann::json row = nlohmann::json::array();
    for (Eigen::Index c = 0; c < A.cols(); ++c)
      row.push_back(A(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// The information matrix of a full window, with what goes moved first, and what it leaves.
Status Matrices(const sim::ViProblem& data, const Settings& settings, nlohmann::json* out) {
  SlidingWindow window(data, FirstEstimates::kFull);
  for (int k = 0; k < settings.window; ++k) {
    if (Status s = window.AddFrame(static_cast<std::size_t>(k)); !s.ok()) return s;
  }
  Problem& problem = window.problem();
  // A point that is seen once has a direction of its own that nothing observes.
  for (const AnyVertex& vertex : problem.Vertices()) {
    if (vertex.type != &kTypeInfo<VertexPointXYZ> || problem.EdgesOf(vertex).size() > 1) continue;
    if (Status s = problem.RemoveVertex(vertex); !s.ok()) return s;
  }
  problem.Solve();
  if (Status s = problem.MakeHessian(); !s.ok()) return s;
  const Eigen::MatrixXd H = problem.Hessian();
  const auto vertices = problem.FreeVertices();
  const auto offsets = problem.FreeOffsets();
  const auto oldest = window.Oldest();
  std::vector<int> going, staying;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const bool goes = std::find(oldest.begin(), oldest.end(), vertices[k]) != oldest.end();
    for (int i = offsets[k]; i < offsets[k + 1]; ++i)
      (goes ? going : staying).push_back(i);
  }
  std::vector<int> order = going;
  order.insert(order.end(), staying.begin(), staying.end());
  // All edges, not only those that go: the information of the whole window, as it is solved.
  const auto schur = SchurComplement(H, problem.Rhs(), staying, going);
  if (!schur.ok()) return schur.status();
  (*out)["before"] = ToJson(H);
  (*out)["moved"] = ToJson(H(order, order));
  (*out)["after"] = ToJson(schur->H);
  (*out)["going"] = going.size();
  (*out)["states"] = settings.window * 15;
  return {};
}

/// The window from frame to frame.
Status Walk(const sim::ViProblem& data, const Settings& settings, FirstEstimates mode,
            nlohmann::json* out) {
  SlidingWindow window(data, mode);
  *out = nlohmann::json::array();
  for (int k = 0; k < settings.frames; ++k) {
    if (Status s = window.AddFrame(static_cast<std::size_t>(k)); !s.ok()) return s;
    if (window.size() < 3) continue;
    const SolveSummary& summary = window.problem().Solve({.max_iterations = 10});
    if (!summary.ok()) return summary.status;
    if (window.size() > settings.window) {
      if (Status s = window.MarginalizeOldest(); !s.ok()) return s;
    }
    const auto report = CheckNullspace(&window.problem());
    if (!report.ok()) return report.status();
    nlohmann::json row;
    row["frame"] = k;
    row["cost"] = summary.final_cost;
    for (const NullspaceDirection& direction : report->directions) {
      row[std::string(direction.name)] = {{"information", direction.information},
                                          {"kappa", direction.kappa}};
    }
    out->push_back(std::move(row));
  }
  return {};
}

int Run(int argc, char** argv) {
  constexpr const char* kName = "marginal_study";
  Settings settings;
  std::string path = "marginal_study.json";
  CLI::App app("Information of a sliding window before and after marginalization", kName);
  app.add_option("--frames", settings.frames, "keyframes of the flight")->capture_default_str();
  app.add_option("--window", settings.window, "keyframes of the window")->capture_default_str();
  app.add_option("--points", settings.points, "points of the world")->capture_default_str();
  app.add_option("--seed", settings.seed, "of world and noise")->capture_default_str();
  app.add_option("--json", path, "file to write")->capture_default_str();
  if (const auto code = Parse(app, argc, argv)) return *code;
  if (const Status s = FirstError({CheckRange("frames", settings.frames, settings.window + 1, 2000),
                                   CheckRange("window", settings.window, 3, 50),
                                   CheckRange("points", settings.points, 10, 20000),
                                   CheckWritable("json", path)});
      !s.ok()) {
    return Refuse(kName, s.message());
  }
  sim::ViWorldOptions options;
  options.num_keyframes = settings.frames;
  options.num_points = settings.points;
  options.length_m = 0.5 * settings.frames;  // a keyframe every half metre
  options.seed = settings.seed;
  options.pixel_noise = 1.0;
  options.start_rotation_deg = 1.0;
  const auto world = sim::MakeViWorld(options);
  if (!world.ok()) return Refuse(kName, world.status().message(), kExitFailed);
  const auto data = sim::Measure(*world, settings.seed);
  if (!data.ok()) return Refuse(kName, data.status().message(), kExitFailed);

  nlohmann::json json;
  if (const Status s = Matrices(*data, settings, &json["matrices"]); !s.ok()) {
    return Refuse(kName, s.message(), kExitFailed);
  }
  const std::pair<const char*, FirstEstimates> modes[] = {
      {"off", FirstEstimates::kOff},
      {"prior_only", FirstEstimates::kPriorOnly},
      {"full", FirstEstimates::kFull}};
  for (const auto& [name, mode] : modes) {
    if (const Status s = Walk(*data, settings, mode, &json["walk"][name]); !s.ok()) {
      return Refuse(kName, s.message(), kExitFailed);
    }
  }
  if (const Status s = WriteFile(path, json.dump() + "\n"); !s.ok()) {
    return Refuse(kName, s.message(), kExitFailed);
  }
  return kExitOk;
}

}  // namespace
}  // namespace glissade::app

int main(int argc, char** argv) {
  return glissade::app::Run(argc, argv);
}
