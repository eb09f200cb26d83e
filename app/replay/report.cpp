// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "replay/report.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <iterator>
#include <nlohmann/json.hpp>
#include <utility>
#include <vector>

#include "common/output_file.h"
#include "glissade/eval/statistics.h"

namespace glissade::app {

using eval::Quantile;

namespace {

struct Stage {
  const char* name;
  const std::vector<double>* ms;
};

std::vector<Stage> StagesOf(const StageTimes& ms) {
  std::vector<Stage> stages = {{"frame", &ms.total},
                               {"add", &ms.add},
                               {"solve", &ms.solve},
                               {"reject", &ms.reject},
                               {"slide", &ms.slide}};
  if (!ms.covariance.empty()) stages.push_back({"covariance", &ms.covariance});
  return stages;
}

double MeanOf(const CausalRun& run, int FrameEstimate::*count) {
  double sum = 0.0;
  for (const FrameEstimate& estimate : run.estimates)
    sum += estimate.*count;
  return run.estimates.empty() ? 0.0 : sum / static_cast<double>(run.estimates.size());
}

/// "observation_rejected": a key for the event.
std::string KeyOf(WindowEvent event) {
  std::string key(ToString(event));
  std::replace(key.begin(), key.end(), ' ', '_');
  return key;
}

}  // namespace

void PrintTimesHeader(const char* what) {
  Print("\n{:<10}{:>10}{:>10}{:>10}  {}\n", "", "median", "p99", "max", what);
}

void PrintTimes(const char* name, const std::vector<double>& ms) {
  Print("{:<10}{:>10.3f}{:>10.3f}{:>10.3f}\n", name, Quantile(ms, 0.5), Quantile(ms, 0.99),
        Quantile(ms, 1.0));
}

nlohmann::ordered_json QuantilesJson(const std::vector<double>& ms) {
  return {{"median", Quantile(ms, 0.5)}, {"p99", Quantile(ms, 0.99)}, {"max", Quantile(ms, 1.0)}};
}

void PrintRun(const CausalRun& run, const std::optional<TrajectoryErrors>& errors) {
  Print("{} frames, {} refused, {} estimates", run.frames_delivered, run.frames_refused,
        run.estimates.size());
  if (run.initialized_at_s) Print("; initialized after {:.3f} s", *run.initialized_at_s);
  Print("\n");
  if (!run.first_refusal.empty()) {
    Print("{} solves failed; the first refusal: {}\n", run.solves_failed, run.first_refusal);
  }
  if (errors) Print("{}", Describe(*errors));
  PrintTimesHeader("ms of each frame");
  for (const Stage& stage : StagesOf(run.ms))
    PrintTimes(stage.name, *stage.ms);
  Print("\nwindow: {:.1f} frames, {:.1f} landmarks, {:.1f} observations, on average\n",
        MeanOf(run, &FrameEstimate::num_frames), MeanOf(run, &FrameEstimate::num_landmarks),
        MeanOf(run, &FrameEstimate::num_observations));
  for (std::size_t k = 0; k < kNumWindowEvents; ++k) {
    const auto event = static_cast<WindowEvent>(k);
    if (run.events[event] > 0) Print("{:>9}  {}\n", run.events[event], ToString(event));
  }
}

void PrintBatch(const BatchSolution& batch, const std::optional<TrajectoryErrors>& errors) {
  Print(
      "\nbatch: {} frames, {} points, {} observations, {} left out, {} IMU terms; {} iterations, "
      "{:.1f} s\n",
      batch.trajectory.size(), batch.points, batch.observations, batch.left_out, batch.imu_terms,
      batch.iterations, batch.time_s);
  if (errors) Print("{}", Describe(*errors));
}

void AddRun(const CausalRun& run, const std::optional<TrajectoryErrors>& errors,
            nlohmann::ordered_json* json) {
  nlohmann::ordered_json& j = *json;
  j["frames"] = run.frames_delivered;
  AddErrors(errors.value_or(TrajectoryErrors{}), json);
  j["median_ms"] = Quantile(run.ms.total, 0.5);
  j["p99_ms"] = Quantile(run.ms.total, 0.99);
  j["marginalize_median_ms"] = Quantile(run.ms.slide, 0.5);
  j["keyframes"] = run.events[WindowEvent::kKeyframe];
  j["rejected"] = run.events[WindowEvent::kObservationRejected];
  j["events"] = nlohmann::ordered_json::object();
  for (std::size_t k = 0; k < kNumWindowEvents; ++k) {
    const auto event = static_cast<WindowEvent>(k);
    j["events"][KeyOf(event)] = run.events[event];
  }
  j["initialized_at_s"] = run.initialized_at_s ? nlohmann::ordered_json(*run.initialized_at_s)
                                               : nlohmann::ordered_json(nullptr);
  j["estimates"] = run.estimates.size();
  j["frames_refused"] = run.frames_refused;
  j["solves_failed"] = run.solves_failed;
  j["first_refusal"] = run.first_refusal;
  j["landmarks"] = run.events[WindowEvent::kLandmarkTriangulated];
  j["window_frames_mean"] = MeanOf(run, &FrameEstimate::num_frames);
  j["window_landmarks_mean"] = MeanOf(run, &FrameEstimate::num_landmarks);
  j["window_mb"] = run.window_mb;
  j["window_observations_mean"] = MeanOf(run, &FrameEstimate::num_observations);
  j["stages_ms"] = nlohmann::ordered_json::object();
  for (const Stage& stage : StagesOf(run.ms))
    j["stages_ms"][stage.name] = QuantilesJson(*stage.ms);
}

void PrintConsistency(const std::optional<Consistency>& c) {
  if (c) {
    Print(
        "\nNEES of the newest pose, seen from the window's oldest frame, 3 expected: position "
        "{:.2f}, rotation {:.2f} ({} frames)\n",
        c->nees_position, c->nees_rotation, c->frames);
  } else {
    Print("\nNEES: the recording has no true poses to hold the covariance against\n");
  }
}

nlohmann::ordered_json ToJson(const std::optional<Consistency>& c) {
  if (!c) return nullptr;
  return {{"nees_position", c->nees_position},
          {"nees_rotation", c->nees_rotation},
          {"frames", c->frames}};
}

nlohmann::ordered_json ToJson(const BatchSolution& batch,
                              const std::optional<TrajectoryErrors>& errors) {
  nlohmann::ordered_json j;
  AddErrors(errors.value_or(TrajectoryErrors{}), &j);
  j["frames"] = batch.trajectory.size();
  j["points"] = batch.points;
  j["observations"] = batch.observations;
  j["left_out"] = batch.left_out;
  j["imu_terms"] = batch.imu_terms;
  j["iterations"] = batch.iterations;
  j["final_cost"] = batch.final_cost;
  j["time_ms"] = 1e3 * batch.time_s;
  return j;
}

std::string StatesCsv(const CausalRun& run) {
  std::string csv =
      "# T_W_B of the newest frame, speed, biases; sigmas where position and yaw of the window's "
      "oldest frame (its pose then: o...) are exact\n"
      "timestamp_ns,px,py,pz,qx,qy,qz,qw,vx,vy,vz,bax,bay,baz,bgx,bgy,bgz,"
      "s_px,s_py,s_pz,s_rx,s_ry,s_rz,s_vx,s_vy,s_vz,s_bax,s_bay,s_baz,s_bgx,s_bgy,s_bgz,"
      "oldest_ns,opx,opy,opz,oqx,oqy,oqz,oqw,frames,landmarks,observations,ms\n";
  auto out = std::back_inserter(csv);
  for (std::size_t k = 0; k < run.estimates.size(); ++k) {
    const FrameEstimate& e = run.estimates[k];
    fmt::format_to(out, "{}", e.state.stamp_ns);
    for (const double x : e.state.T_w_b.data)
      fmt::format_to(out, ",{:.9g}", x);
    for (const double x : e.state.speed_bias.data)
      fmt::format_to(out, ",{:.9g}", x);
    for (const double x : e.sigmas)  // empty: not known
      std::isfinite(x) ? fmt::format_to(out, ",{:.6g}", x) : fmt::format_to(out, ",");
    fmt::format_to(out, ",{}", e.oldest.stamp_ns);
    for (const double x : e.oldest.T_w_b.data)
      fmt::format_to(out, ",{:.9g}", x);
    fmt::format_to(out, ",{},{},{},{:.4f}\n", e.num_frames, e.num_landmarks, e.num_observations,
                   e.ms);
  }
  return csv;
}

}  // namespace glissade::app
