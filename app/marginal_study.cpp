// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What marginalization does to the information of a sliding window, as numbers to be drawn
// (scripts/plot_marginalization.py): the information matrix of a simulated visual-inertial window
// before, with what goes moved first, and after; and what a window that slides over the flight
// claims to know of yaw and position, which nothing observes, from frame to frame, for each
// treatment of first estimates, with and without a gauge.

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
#include "glissade/marginal/schur_complement.h"
#include "glissade/problem/problem.h"
#include "glissade/sim/vi_window.h"
#include "glissade/sim/vi_world.h"
#include "studies/marginal_summary.h"
#include "studies/marginal_walk.h"

namespace glissade::app {
namespace {

struct Settings {
  int frames = 60;
  int window = 7;
  int points = 240;
  int runs = 1;
  double pixel_noise = 1.0;
  std::uint32_t seed = 1;
  SolverOptions solver;
  std::string json;

  Settings() { solver.solve.max_iterations = 15; }
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

/// Variables of a matrix in groups, as a picture labels them: a name and how many.
nlohmann::ordered_json Groups(const std::vector<AnyVertex>& vertices,
                              const std::vector<int>& sizes) {
  nlohmann::ordered_json groups = nlohmann::ordered_json::array();
  int pose = 0, speed_bias = 0;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const bool is_pose = vertices[k].type == &kTypeInfo<VertexPose>;
    if (vertices[k].type == &kTypeInfo<VertexPointXYZ>) {
      if (groups.empty() || groups.back()["name"] != "points") {
        groups.push_back({{"name", "points"}, {"size", 0}});
      }
      groups.back()["size"] = groups.back()["size"].get<int>() + sizes[k];
    } else {
      const std::string name =
          is_pose ? fmt::format("pose {}", pose++) : fmt::format("speed, biases {}", speed_bias++);
      groups.push_back({{"name", name}, {"size", sizes[k]}});
    }
  }
  return groups;
}

/// The information matrix of a full window, with what goes moved first, and what it leaves.
Status Matrices(const sim::ViProblem& data, const Settings& settings, nlohmann::ordered_json* out) {
  Problem problem;
  sim::ViWindow window(&data, {.initial_keyframes = settings.window, .seed = settings.seed},
                       &problem);
  for (int k = 0; k < settings.window; ++k) {
    if (Status s = window.AddKeyframe(); !s.ok()) return s;
  }
  for (const auto& point : window.PointsSeenOnce()) {
    if (Status s = problem.RemoveVertex(point); !s.ok()) return s;
  }
  problem.Solve();
  if (Status s = problem.MakeHessian(); !s.ok()) return s;
  const Eigen::MatrixXd H = problem.Hessian();
  const auto vertices = problem.FreeVertices();
  const auto offsets = problem.FreeOffsets();
  const auto oldest = window.TakeOldest();
  struct Part {
    std::vector<AnyVertex> vertices;
    std::vector<int> sizes, scalars;
    void Add(AnyVertex vertex, int begin, int end) {
      vertices.push_back(vertex);
      sizes.push_back(end - begin);
      for (int i = begin; i < end; ++i)
        scalars.push_back(i);
    }
    [[nodiscard]] Part Then(const Part& next) const {
      Part both = *this;
      both.vertices.insert(both.vertices.end(), next.vertices.begin(), next.vertices.end());
      both.sizes.insert(both.sizes.end(), next.sizes.begin(), next.sizes.end());
      both.scalars.insert(both.scalars.end(), next.scalars.begin(), next.scalars.end());
      return both;
    }
  } all, going, staying;
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    const bool goes = std::find(oldest.begin(), oldest.end(), vertices[k]) != oldest.end();
    all.Add(vertices[k], offsets[k], offsets[k + 1]);
    (goes ? going : staying).Add(vertices[k], offsets[k], offsets[k + 1]);
  }
  // All edges, not only those that go: the information of the whole window, as it is solved.
  const auto schur = SchurComplement(H, problem.Rhs(), staying.scalars, going.scalars);
  if (!schur.ok()) return schur.status();
  const Part moved = going.Then(staying);
  (*out)["before"] = ToJson(H);
  (*out)["moved"] = ToJson(H(moved.scalars, moved.scalars));
  (*out)["after"] = ToJson(schur->H);
  (*out)["going"] = going.scalars.size();
  (*out)["states"] = settings.window * 15;
  (*out)["groups"] = {{"before", Groups(all.vertices, all.sizes)},
                      {"going", Groups(going.vertices, going.sizes)},
                      {"staying", Groups(staying.vertices, staying.sizes)}};
  return {};
}

void PrintMatrices(const nlohmann::ordered_json& json) {
  Print(
      "information of a window of {} states: {} variables; {} go with the oldest frame, {} "
      "stay\n\n",
      json["states"].get<int>(), json["before"].size(), json["going"].get<std::size_t>(),
      json["after"].size());
}

constexpr const char* kName = "marginal_study";

constexpr const char* kDescription =
    R"(What marginalization does to the information of a sliding window. A window slides over simulated
visual-inertial flights; the oldest keyframe goes, with the points whose tracks began there, and
leaves a prior. Nothing observes yaw and position: what does the window claim to know of them, for
each treatment of first estimates, in the free gauge and with the oldest keyframe's position and yaw
held?)";

constexpr const char* kFooter =
    R"(The table, over all keyframes and runs: mean and largest cost after a solve; iterations and rejected
steps of a solve; its median time; how far a keyframe turned at most from where it was linearized
first; largest kappa of yaw and of position; squared error of the newest keyframe as seen from the
oldest over its claimed covariance, yaw and position (honest: 1; means over runs); error of the way
put together from window to window (RMS of the runs' ends).

kappa is the information about a direction (1 m along x, y, z; 1 rad of yaw) as a part of what the
variables would have alone: rounding where the window claims nothing. docs/marginalization.md says
what off, prior_only and full are. The JSON file has the information matrices of one window, before
and after, and the first run keyframe by keyframe.

Examples:
  marginal_study
  marginal_study --trials 20 --pixel-noise 0.5
  marginal_study --flight 200 --keyframes 10 --json study.json
  scripts/plot_marginalization.py study.json docs/images   draws it

After Ctrl-C the keyframes until then are shown and written.

Exit code: 0; 130 after Ctrl-C; 2 where an option makes no sense; 1 where a solve fails.)";

void AddOptions(Program& program, Settings& s) {
  CLI::App& cli = program.cli();
  AddInteger(cli, "--flight", &s.frames, 4, 2000, "Keyframes of the flight (default 60)");
  AddInteger(cli, "--keyframes", &s.window, 3, 50, "Keyframes of a window (default 7)");
  AddInteger(cli, "--points", &s.points, 10, 20000, "Points to be seen (default 240)");
  AddNumber(cli, "--pixel-noise", &s.pixel_noise, 0.01, 20.0,
            "Sigma of an observation (px; default 1)");
  AddSeed(cli, &s.seed, "world and noise");
  AddInteger(
      cli, "--trials", &s.runs, 1, 1000,
      "Repetitions of everything random: flights, with this seed and those after it (default 1)");
  AddMethod(cli, &s.solver);
  AddLinearSolver(cli, &s.solver);
  AddIterations(cli, &s.solver);
  AddThreads(cli, &s.solver);
  program.AddJson(&s.json);
}

Result<sim::ViProblem> Measure(const Settings& settings, std::uint32_t seed) {
  sim::ViWorldOptions options;
  options.points = sim::PointLayout::kRandom;
  options.num_keyframes = settings.frames;
  options.num_points = settings.points;
  options.length_m = 0.5 * settings.frames;  // a keyframe every half metre
  options.nearest_visible_m = 1.5;
  options.seed = seed;
  options.pixel_noise = options.camera.sigma_px = settings.pixel_noise;
  options.start_rotation_deg = 1.0;
  const auto world = sim::MakeViWorld(options);
  if (!world.ok()) return world.status();
  return sim::Measure(*world, seed);
}

Outcome Run(const Settings& settings) {
  if (settings.frames <= settings.window) {
    return BadInput(fmt::format("--flight: must be more than --keyframes, {}, not {}",
                                settings.window, settings.frames));
  }
  const auto first = Measure(settings, settings.seed);
  if (!first.ok()) return Failed(first.status());
  nlohmann::ordered_json matrices;
  nlohmann::ordered_json walks = {{"free", nlohmann::ordered_json::object()},
                                  {"fixed", nlohmann::ordered_json::object()}};
  if (const Status s = Matrices(*first, settings, &matrices); !s.ok()) return Failed(s);
  PrintMatrices(matrices);
  const std::pair<const char*, FirstEstimates> modes[] = {
      {"off", FirstEstimates::kOff},
      {"prior_only", FirstEstimates::kPriorOnly},
      {"full", FirstEstimates::kFull}};
  nlohmann::ordered_json table = nlohmann::ordered_json::array();
  PrintWalkHeader();
  for (const char* gauge : {"free", "fixed"}) {
    for (const auto& [name, mode] : modes) {
      WalkSummary summary;
      for (int run = 0; run < settings.runs && !Interrupted(); ++run) {
        const std::uint32_t seed = settings.seed + static_cast<std::uint32_t>(run);
        const auto data = Measure(settings, seed);
        if (!data.ok()) return Failed(data.status());
        WalkOptions options;
        options.window = settings.window;
        options.mode = mode;
        options.fixed_gauge = gauge == std::string_view("fixed");
        options.solve = settings.solver.Chosen();
        options.front_end = {.initial_keyframes = settings.window, .seed = seed};
        const auto walk = WalkWindow(*data, options);
        if (!walk.ok()) return Failed(walk.status());
        summary.Add(*walk);
        if (run > 0) continue;
        nlohmann::ordered_json& rows = walks[gauge][name] = nlohmann::ordered_json::array();
        for (const WalkFrame& frame : *walk)
          rows.push_back(ToJson(frame));
      }
      if (summary.empty()) continue;
      summary.Print(gauge, name);
      table.push_back(summary.ToJson(gauge, name));
    }
  }
  if (settings.json.empty()) return {};
  nlohmann::ordered_json json = JsonHeader(kName, "");
  json["seed"] = settings.seed;
  json["runs"] = settings.runs;
  json["table"] = std::move(table);
  json["matrices"] = std::move(matrices);
  json["walk"] = std::move(walks);
  const Status written = WriteJson(settings.json, json, -1);
  return written.ok() ? Outcome{} : Failed(written);
}

}  // namespace
}  // namespace glissade::app

int main(int argc, char** argv) {
  using namespace glissade::app;
  return Program(kName, kDescription, kFooter).Main<Settings>(argc, argv, AddOptions, Run);
}
