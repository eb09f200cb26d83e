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

#include "common/interrupt.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/solver_options.h"
#include "common/version.h"
#include "glissade/gauge/nullspace.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/vi_world.h"

namespace glissade::app {
namespace {

struct Settings {
  int frames = 60;
  int window = 7;
  int points = 240;
  std::uint32_t seed = 1;
  SolverOptions solver;
  std::string json;

  Settings() { solver.solve.max_iterations = 10; }
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

nlohmann::ordered_json ToJson(const Eigen::MatrixXd& A) {
  nlohmann::ordered_json rows = nlohmann::ordered_json::array();
  for (Eigen::Index r = 0; r < A.rows(); ++r) {
    nlohmann::ordered_json row = nlohmann::ordered_json::array();
    for (Eigen::Index c = 0; c < A.cols(); ++c)
      row.push_back(A(r, c));
    rows.push_back(std::move(row));
  }
  return rows;
}

/// The information matrix of a full window, with what goes moved first, and what it leaves.
Status Matrices(const sim::ViProblem& data, const Settings& settings, nlohmann::ordered_json* out) {
  SlidingWindow window(data, FirstEstimates::kFull);
  for (int k = 0; k < settings.window; ++k) {
    if (Status s = window.AddFrame(static_cast<std::size_t>(k)); !s.ok()) return s;
  }
  Problem& problem = window.problem();
  // A point that is seen once has a direction of its own that nothing observes.
  for (const AnyVertex& vertex : problem.Vertices()) {
    if (vertex.type != &kTypeInfo<VertexPointXYZ> || problem.EdgesOf(vertex)->size() > 1) continue;
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
            nlohmann::ordered_json* out) {
  SlidingWindow window(data, mode);
  *out = nlohmann::ordered_json::array();
  for (int k = 0; k < settings.frames && !Interrupted(); ++k) {
    if (Status s = window.AddFrame(static_cast<std::size_t>(k)); !s.ok()) return s;
    if (window.size() < 3) continue;
    const SolveSummary& summary = window.problem().Solve(settings.solver.Chosen());
    if (!summary.ok()) return summary.status;
    if (Interrupted()) break;
    if (window.size() > settings.window) {
      if (Status s = window.MarginalizeOldest(); !s.ok()) return s;
    }
    const auto report = CheckNullspace(&window.problem());
    if (!report.ok()) return report.status();
    nlohmann::ordered_json row;
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

void PrintMatrices(const nlohmann::ordered_json& json) {
  Print(
      "information of a window of {} states: {} variables; {} go with the oldest frame, {} "
      "stay\n\n",
      json["states"].get<int>(), json["before"].size(), json["going"].get<std::size_t>(),
      json["after"].size());
}

/// One line for each mode: the walk's end, and the most that a frame claimed of each direction that
/// nothing observes, as a part of what the variables alone claim.
void PrintWalks(const nlohmann::ordered_json& walks) {
  Print("{:<12} {:>6} {:>14} {:>14}  {}\n", "mode", "frames", "median cost", "last cost",
        "largest kappa of a direction");
  for (const auto& [mode, rows] : walks.items()) {
    if (rows.empty()) continue;
    std::vector<double> costs;
    std::string kappas;
    for (const auto& row : rows)
      costs.push_back(row["cost"].get<double>());
    for (const auto& [name, value] : rows.back().items()) {
      if (!value.is_object()) continue;
      double largest = 0.0;
      for (const auto& row : rows)
        largest = std::max(largest, row[name]["kappa"].get<double>());
      kappas += fmt::format("{}{} {:.1e}", kappas.empty() ? "" : ", ", name, largest);
    }
    const double last = costs.back();
    std::nth_element(costs.begin(), costs.begin() + costs.size() / 2, costs.end());
    Print("{:<12} {:>6} {:>14.6g} {:>14.6g}  {}\n", mode, rows.size(), costs[costs.size() / 2],
          last, kappas);
  }
}

constexpr const char* kName = "marginal_study";

constexpr const char* kDescription =
    R"(What marginalization does to the information of a sliding window. A window slides over a
simulated visual-inertial flight; the oldest frame goes, with all points it has seen, and leaves a
prior. Nothing observes yaw and position: what does the window claim to know of them, from frame to
frame, for each treatment of first estimates?)";

constexpr const char* kFooter =
    R"(kappa is the information about a direction (1 m along x, y, z; 1 rad of yaw) as a part of what the
variables would have alone: rounding where the window claims nothing. docs/marginalization.md says
what off, prior_only and full are. The information matrices of one window, before and after, are in
the JSON file.

Examples:
  marginal_study
  marginal_study --frames 200 --window 10 --json study.json
  scripts/plot_marginalization.py study.json docs/images   draws it

After Ctrl-C the frames until then are shown and written.

Exit code: 0; 130 after Ctrl-C; 2 where an option makes no sense; 1 where a solve fails.)";

void AddOptions(Program& program, Settings& s) {
  CLI::App& cli = program.cli();
  AddInteger(cli, "--frames", &s.frames, 4, 2000, "Keyframes of the flight (default 60)");
  AddInteger(cli, "--window", &s.window, 3, 50, "Keyframes of the window (default 7)");
  AddInteger(cli, "--points", &s.points, 10, 20000, "Points of the world (default 240)");
  AddSeed(cli, &s.seed, "Seed of world and noise (default 1)");
  AddMethod(cli, &s.solver);
  AddLinearSolver(cli, &s.solver);
  AddIterations(cli, &s.solver);
  AddThreads(cli, &s.solver);
  program.AddOutput("--json", &s.json, "Write everything, with the matrices, to FILE");
}

Outcome Run(const Settings& settings) {
  if (settings.frames <= settings.window) {
    return BadInput(fmt::format("--frames: must be more than --window, {}, not {}", settings.window,
                                settings.frames));
  }
  sim::ViWorldOptions options;
  options.num_keyframes = settings.frames;
  options.num_points = settings.points;
  options.length_m = 0.5 * settings.frames;  // a keyframe every half metre
  options.seed = settings.seed;
  options.pixel_noise = 1.0;
  options.start_rotation_deg = 1.0;
  const auto world = sim::MakeViWorld(options);
  if (!world.ok()) return Failed(world.status());
  const auto data = sim::Measure(*world, settings.seed);
  if (!data.ok()) return Failed(data.status());

  nlohmann::ordered_json matrices, walks = nlohmann::ordered_json::object();
  if (const Status s = Matrices(*data, settings, &matrices); !s.ok()) return Failed(s);
  PrintMatrices(matrices);
  const std::pair<const char*, FirstEstimates> modes[] = {
      {"off", FirstEstimates::kOff},
      {"prior_only", FirstEstimates::kPriorOnly},
      {"full", FirstEstimates::kFull}};
  for (const auto& [name, mode] : modes) {
    if (Interrupted()) break;
    if (const Status s = Walk(*data, settings, mode, &walks[name]); !s.ok()) return Failed(s);
  }
  PrintWalks(walks);
  if (settings.json.empty()) return {};
  nlohmann::ordered_json json = JsonHeader(kName, "");
  json["seed"] = settings.seed;
  json["matrices"] = std::move(matrices);
  json["walk"] = std::move(walks);
  const Status written = WriteJson(settings.json, json, -1);
  return written.ok() ? Outcome{} : Failed(written);
}

}  // namespace
}  // namespace glissade::app

int main(int argc, char** argv) {
  using namespace glissade::app;
  Program program(kName, kDescription, kFooter);
  Settings settings;
  AddOptions(program, settings);
  return program.Run(argc, argv, [&] { return Run(settings); });
}
