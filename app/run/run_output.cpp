// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "run/run_output.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <span>
#include <vector>

#include "common/output_file.h"
#include "common/version.h"
#include "glissade/eval/alignment.h"
#include "glissade/eval/association.h"
#include "glissade/problem/problem.h"
#include "page/report_page.h"
#include "replay/consistency.h"
#include "replay/report.h"

namespace glissade::app {

namespace {

using Json = nlohmann::ordered_json;

struct Stage {
  const char* name;
  std::vector<double> ms;  // of each frame
};

std::vector<Stage> StagesOf(const VioSession& session) {
  using vision::TrackerReport;
  std::vector<Stage> stages;
  for (const auto& [name, member] : {std::pair{"contrast", &TrackerReport::contrast_ms},
                                     {"track", &TrackerReport::track_ms},
                                     {"reject", &TrackerReport::reject_ms},
                                     {"detect", &TrackerReport::detect_ms},
                                     {"stereo", &TrackerReport::stereo_ms}}) {
    Stage& stage = stages.emplace_back(Stage{name, {}});
    for (const VisionFrame& f : session.frames())
      stage.ms.push_back(f.report.*member);
  }
  Stage& window = stages.emplace_back(Stage{"window", {}});
  for (const VisionFrame& f : session.frames())
    window.ms.push_back(f.window_ms);
  if (session.tracker().cameras().size() < 2)
    std::erase_if(stages, [](const Stage& s) { return std::string_view(s.name) == "stereo"; });
  return stages;
}

std::vector<double> Totals(const VioSession& session) {
  std::vector<double> totals;
  for (const VisionFrame& f : session.frames())
    totals.push_back(f.report.total_ms() + f.window_ms);
  return totals;
}

/// Over all frames; 0 where there are none.
template <class Get>
double Mean(const VioSession& session, const Get& get) {
  double sum = 0.0;
  for (const VisionFrame& f : session.frames())
    sum += get(f);
  return session.frames().empty() ? 0.0 : sum / static_cast<double>(session.frames().size());
}
double MeanOf(const VioSession& session, int vision::TrackerReport::*member) {
  return Mean(session, [member](const VisionFrame& f) { return f.report.*member; });
}
double MeanFeatures(const VioSession& session) {
  return Mean(session, [](const VisionFrame& f) { return f.features; });
}

/// Rounded: a page does not need 17 digits.
Json Rounded(std::span<const double> values, double step) {
  Json out = Json::array();
  for (const double x : values)
    out.push_back(std::isfinite(x) ? Json(step * std::round(x / step)) : Json(nullptr));
  return out;
}

Json StatesOf(const ReportInput& in) {
  Json s = {{"t", Json::array()}, {"p", Json::array()}, {"q", Json::array()}};
  if (in.run.estimates.empty()) return s;
  const eval::Trajectory truth = ReferenceOf(in.session.tracks());
  for (const FrameEstimate& e : in.run.estimates) {
    s["t"].push_back(in.session.SecondsOf(e.state.stamp_ns));
    const std::span<const double> pose(e.state.T_w_b.data);
    s["p"].push_back(Rounded(pose.first(3), 1e-4));
    s["q"].push_back(Rounded(pose.subspan(3, 4), 1e-6));
    const std::span<const double> sigmas(e.sigmas);
    s["sigma_p"].push_back(Rounded(sigmas.first(3), 1e-5));
    if (const auto error = ErrorFromOldest(e, truth, in.has_imu)) {
      s["error_p"].push_back(Rounded(*error, 1e-5));
    } else {
      s["error_p"].push_back({nullptr, nullptr, nullptr});
    }
    if (!in.has_imu) continue;
    const std::span<const double> speed(e.state.speed_bias.data);
    s["v"].push_back(Rounded(speed.first(3), 1e-4));
    s["ba"].push_back(Rounded(speed.subspan(3, 3), 1e-5));
    s["bg"].push_back(Rounded(speed.subspan(6, 3), 1e-6));
    s["sigma_v"].push_back(Rounded(sigmas.subspan(6, 3), 1e-5));
    s["sigma_ba"].push_back(Rounded(sigmas.subspan(9, 3), 1e-6));
    s["sigma_bg"].push_back(Rounded(sigmas.subspan(12, 3), 1e-7));
  }
  return s;
}

/// The truth where the estimate is, moved onto it.
Json TruthOf(const ReportInput& in) {
  const auto& truth = in.session.tracks();
  if (truth.ground_truth.empty() || in.run.estimates.size() < 3) return nullptr;
  const auto matched = eval::Associate(TrajectoryOf(in.run), ReferenceOf(truth));
  if (!matched.ok()) return nullptr;
  const auto kind = in.has_imu ? eval::AlignmentKind::kYaw : eval::AlignmentKind::kSe3;
  const auto alignment = eval::Align(*matched, {.kind = kind});
  if (!alignment.ok()) return nullptr;
  const Pose T_e_r = alignment->T_r_e.Inverse();
  Json out = {{"t", Json::array()}, {"p", Json::array()}};
  for (const eval::StampedPose& pose : matched->reference) {
    out["t"].push_back(in.session.SecondsOf(pose.stamp_ns));
    const Vector3 p = T_e_r * Vector3(pose.T_w_b.p());
    out["p"].push_back(Rounded({p.data(), 3}, 1e-4));
  }
  return out;
}

Json ThumbnailsOf(const VioSession& session) {
  Json out = Json::array();
  for (const Thumbnail& t : session.thumbnails()) {
    Json tracks = Json::array();
    for (const Thumbnail::Tail& tail : t.tails) {
      Json px = Json::array();
      for (const auto& p : tail.px) {
        px.push_back(0.1 * std::round(10.0 * static_cast<double>(p[0])));
        px.push_back(0.1 * std::round(10.0 * static_cast<double>(p[1])));
      }
      tracks.push_back({tail.age, std::move(px)});
    }
    out.push_back(
        {{"t", t.t},
         {"width", t.width},
         {"height", t.height},
         {"scale", 1.0 / t.shrink},
         {"jpeg", ToBase64({reinterpret_cast<const char*>(t.jpeg.data()), t.jpeg.size()})},
         {"tracks", std::move(tracks)}});
  }
  return out;
}

}  // namespace

void PrintSession(const VioSession& session) {
  PrintTimesHeader("ms of each frame, images decoded");
  for (const Stage& stage : StagesOf(session))
    PrintTimes(stage.name, stage.ms);
  PrintTimes("all", Totals(session));
  Print("\nfeatures: {:.1f} a frame; {:.1f} lost, {:.1f} off their epipolar lines, {:.1f} new\n",
        MeanFeatures(session), MeanOf(session, &vision::TrackerReport::lost),
        MeanOf(session, &vision::TrackerReport::rejected),
        MeanOf(session, &vision::TrackerReport::detected));
  if (const double sigma = session.window().initial_scale_sigma(); sigma > 0.0) {
    Print("scale of the first state known to {:.1f} % (sigma)\n", 100.0 * sigma);
  }
  constexpr std::size_t kMost = 30;
  for (std::size_t k = 0; k < std::min(kMost, session.events().size()); ++k) {
    const RunEvent& e = session.events()[k];
    Print("{:>9.2f} s  {}{}\n", e.t, e.what,
          e.frames > 1 ? fmt::format(" ({} frames)", e.frames) : "");
  }
  if (session.events().size() > kMost) {
    Print("           and {} more (--json has them all)\n", session.events().size() - kMost);
  }
}

Json SessionJson(const VioSession& session) {
  Json j;
  j["initial_scale_sigma_percent"] = 100.0 * session.window().initial_scale_sigma();
  j["features_mean"] = MeanFeatures(session);
  j["stereo_mean"] = MeanOf(session, &vision::TrackerReport::stereo);
  j["lost_mean"] = MeanOf(session, &vision::TrackerReport::lost);
  j["rejected_mean"] = MeanOf(session, &vision::TrackerReport::rejected);
  j["stages_ms"] = Json::object();
  for (const Stage& stage : StagesOf(session))
    j["stages_ms"][stage.name] = QuantilesJson(stage.ms);
  j["stages_ms"]["all"] = QuantilesJson(Totals(session));
  std::vector<double> decode;
  for (const VisionFrame& f : session.frames())
    decode.push_back(f.decode_ms);
  j["decode_ms"] = QuantilesJson(decode);
  j["events"] = Json::array();
  for (const RunEvent& e : session.events())
    j["events"].push_back({{"t", e.t}, {"what", e.what}, {"frames", e.frames}});
  return j;
}

Json ReportData(const ReportInput& in) {
  Json data;
  data["title"] = in.title;
  data["origin"] = in.origin;
  data["app_version"] = VersionText("vio_run");
  data["figures"] = in.figures;
  data["sigma_meaning"] = "seen from the window's oldest frame";
  const auto& frames = in.session.frames();
  if (frames.size() > 1) {
    data["camera_period_ms"] =
        1e3 * (frames.back().t - frames.front().t) / static_cast<double>(frames.size() - 1);
  }
  data["states"] = StatesOf(in);
  if (Json truth = TruthOf(in); !truth.is_null()) data["truth"] = std::move(truth);
  data["landmarks"] = Json::array();
  for (const auto& [track, p] : in.session.landmarks())
    data["landmarks"].push_back(Rounded({p.data(), 3}, 1e-3));
  Json t = Json::array(), count = Json::array(), age = Json::array();
  for (const VisionFrame& f : frames) {
    t.push_back(f.t);
    count.push_back(f.features);
    age.push_back(f.report.median_age);
  }
  Json names = Json::array(), ms = Json::array();
  for (const Stage& stage : StagesOf(in.session)) {
    names.push_back(stage.name);
    ms.push_back(Rounded(stage.ms, 1e-3));
  }
  data["stages"] = {
      {"t", t}, {"names", names}, {"ms", ms}, {"total", Rounded(Totals(in.session), 1e-3)}};
  data["features"] = {{"t", t}, {"count", count}, {"age", age}};
  data["events"] = Json::array();
  data["event_counts"] = Json::object();
  for (const RunEvent& e : in.session.events()) {
    data["events"].push_back({{"t", e.t}, {"what", e.what}, {"count", e.frames}});
    data["event_counts"][e.what] = data["event_counts"].value(e.what, 0) + e.frames;
  }
  data["thumbnails"] = ThumbnailsOf(in.session);
  return data;
}

std::string RerunLine(const VioSession& session, const std::string& image) {
  Json j;
  j["t"] = session.frames().back().t;
  if (session.frames().back().running) {
    const Pose& T = session.window().newest().T_w_b;
    j["p"] = {T.data[0], T.data[1], T.data[2]};
    j["q"] = {T.data[3], T.data[4], T.data[5], T.data[6]};
    const Problem& problem = session.window().problem();
    for (const WindowLandmark& landmark : session.window().view().landmarks) {
      if (!landmark.InGraph()) continue;
      if (const VertexPointXYZ* point = problem.Find(landmark.point)) {
        j["landmarks"].push_back(Rounded(point->data, 1e-3));
      }
    }
  }
  for (const vision::Feature& f : session.tracker().features())
    if (f.camera == 0) j["features"].push_back({f.px[0], f.px[1], f.age});
  j["image"] = std::filesystem::absolute(image).string();
  return j.dump(-1, ' ', false, Json::error_handler_t::replace) + "\n";
}

}  // namespace glissade::app
