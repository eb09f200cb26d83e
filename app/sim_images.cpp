// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// Renders what cameras would have seen on a flight through a textured room.
#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <nlohmann/json.hpp>
#include <string>
#include <utility>
#include <vector>

#include "common/interrupt.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/status_line.h"
#include "common/version.h"
#include "glissade/io/viotracks.h"
#include "glissade/vision/image_recording.h"
#include "images/flight.h"
#include "images/flight_source.h"
#include "images/ideal_tracks.h"
#include "images/lens.h"
#include "images/recording_plan.h"
#include "images/render_recording.h"
#include "images/scene.h"

namespace glissade::app {
namespace {

namespace fs = std::filesystem;

constexpr const char* kName = "sim_images";

constexpr const char* kDescription =
    R"(Renders the images of a flight through a textured room, and writes them in EuRoC's layout with the
IMU, the calibration and the truth: recordings of any length for visual-inertial odometry.)";

constexpr const char* kFooter =
    R"(The flight is that of a recording with ground truth (VIOTRACKS, EuRoC, TUM-VI, KITTI odometry), whose
IMU is copied and whose cameras are taken over, or a simulated one with a simulated IMU. Between
true poses that are far apart the IMU says how the body moved. The room is built around the flight,
level, with boxes and pillars in it; every pixel's ray is followed through the lens to what it meets
first. The stamp of an image is the middle of its exposure. The truth written is the rendered one,
at every frame.

Models of --lens: own (as recorded; a VIOTRACKS or simulated camera has no distortion), none, radtan
(EuRoC's), equidistant (TUM-VI's; with a short --focal, wide). The default is radtan for VIOTRACKS
and simulated flights, own for recordings of images.

The same options and the same data give the same images. --save-tracks writes what a perfect tracker
would have made of them, with noise and losses as told, to hold a real one against.

Examples:
  sim_images room --along data/flight                 stereo, 20 Hz, as large as recorded
  sim_images room --along data/flight --seconds 5 --noise 4 --exposure 10 --auto-exposure
  sim_images room --spline rec --seconds 60 --mono --size 752x480 --save-tracks room_tracks
  sim_images room --spline sine --lens equidistant --focal 190 --size 512x512
  sim_images room --along data/flight --texture wall.jpg --texture floor.jpg --texture-width 3

After Ctrl-C the recording is that of the frames until then.

Exit code: 0; 130 after Ctrl-C; 2 where an option or a recording makes no sense, or FOLDER holds a
recording already; 1 where a file cannot be written.)";

struct Settings {
  std::string folder, along, spline;
  SplineOptions flight;
  PlanOptions plan;
  std::string lens_model;  // empty: what the source suggests
  LensOptions lens;
  SceneOptions scene;
  std::vector<std::string> textures;
  double texture_width_m = 4.0;
  RenderOptions render;
  std::string tracks;
  IdealTrackOptions ideal;
  std::uint32_t seed = 1;
  std::string json;
};

/// "640x480"
void ReadSize(const std::string& text, LensOptions* lens) {
  const std::size_t x = text.find('x');
  const auto width = ParseNumber("--size", text.substr(0, x), 16, 8192);
  const auto height = ParseNumber("--size", x < text.size() ? text.substr(x + 1) : "", 16, 8192);
  const bool whole =
      width.ok() && height.ok() && *width == std::floor(*width) && *height == std::floor(*height);
  if (!whole)
    RefuseOption("--size: must be WxH, each an integer from 16 to 8192, not '" + text + "'");
  lens->width = static_cast<int>(*width);
  lens->height = static_cast<int>(*height);
}

void AddFlightOptions(CLI::App& cli, Settings& s) {
  auto* along = cli.add_option("--along", s.along, "Fly as in the recording DIR")->type_name("DIR");
  AddChoice(cli, "--spline", &s.spline, {"sine", "arc", "rec"},
            "Fly a simulated way: rec goes around a rectangle")
      ->excludes(along);
  AddNumber(cli, "--length", &s.flight.lap_m, 1.0, 1e4,
            "Length of a simulated flight, one lap (m; default 15)");
  AddNumber(cli, "--speed", &s.flight.speed_mps, 0.05, 20.0,
            "Speed of a simulated flight (m/s; default 1.25)");
  AddNumber(cli, "--start", &s.plan.start_s, 0.0, 1e5,
            "Begin so long after the recording does (s; default 0)");
  AddNumber(cli, "--seconds", &s.plan.seconds, 0.01, 1e5,
            "End so long after that (s; default: all)");
  AddNumber(cli, "--rate", &s.plan.rate_hz, 0.1, 1000.0, "Frames a second (Hz; default 20)");
  cli.add_flag("--mono", s.plan.mono, "The first camera only");
}

void AddCameraOptions(CLI::App& cli, Settings& s) {
  cli.add_option_function<std::string>(
         "--size", [&s](const std::string& text) { ReadSize(text, &s.lens); },
         "Of the images, the same width of view (px; default: as recorded)")
      ->type_name("WxH");
  AddNumber(cli, "--focal", &s.lens.focal_px, 1.0, 1e5, "Focal length (px; default: as recorded)");
  AddChoice(cli, "--lens", &s.lens_model, LensModels(), "Model of the lenses (default: see below)");
  AddNumber(cli, "--noise", &s.render.photometry.noise, 0.0, 100.0,
            "Sigma of a pixel (grey values; default 2)");
  AddNumber(cli, "--exposure", &s.render.exposure_ms, 0.0, 1000.0,
            "Time that the shutter is open, which blurs what moves (ms; default 4)");
  AddInteger(cli, "--blur-samples", &s.render.blur_samples, 1, 1000,
             "At most so many views are averaged for it, about one a pixel (default 8)");
  AddNumber(cli, "--gain-drift", &s.render.photometry.gain_drift, 0.0, 2.0,
            "Slow change of the brightness, of its logarithm (default 0.15)");
  cli.add_flag("--auto-exposure", s.render.photometry.auto_exposure,
               "Brightness in steps, towards a mean of 100");
  AddNumber(cli, "--vignette", &s.render.photometry.vignette, 0.0, 1.0,
            "Part of the light that is lost in the corners (default 0.25)");
  AddChoice(cli, "--format", &s.plan.ending, {"png", "jpg"}, "Of the image files (default png)");
  AddInteger(cli, "--jpeg-quality", &s.render.jpeg_quality, 1, 100, "Of --format jpg (default 95)");
}

void AddOptions(Program& program, Settings& s) {
  CLI::App& cli = program.cli();
  cli.add_option("FOLDER", s.folder, "Where the recording goes: FOLDER/mav0")->required();
  AddFlightOptions(cli, s);
  AddCameraOptions(cli, s);
  AddNumber(cli, "--walls", &s.scene.wall_m, 0.3, 1000.0,
            "Distance of the walls from the way (m; default 3)");
  AddNumber(cli, "--floor", &s.scene.floor_m, 0.3, 1000.0,
            "Distance of floor and ceiling from the way (m; default 1.5)");
  AddInteger(cli, "--boxes", &s.scene.boxes, 0, 1000,
             "Boxes and pillars, where they find a place (default: one for 12 m^2, at least 6)");
  cli.add_option("--texture", s.textures,
                 "Picture to paint the room with; may be repeated (default: random shapes)")
      ->type_name("FILE")
      ->allow_extra_args(false);
  AddNumber(cli, "--texture-width", &s.texture_width_m, 0.1, 1000.0,
            "Width of such a picture (m; default 4)");
  AddSeed(cli, &s.seed, "the room, the noise, a simulated flight");
  program.AddOutputPath("--save-tracks", &s.tracks,
                        "Write the tracks (VIOTRACKS) to PATH, a folder: perfect ones");
  AddNumber(cli, "--track-noise", &s.ideal.noise_px, 0.0, 100.0,
            "Sigma of such a track (px; default 0.5)");
  AddNumber(cli, "--track-age", &s.ideal.age_frames, 1.0, 1e6,
            "Frames after which such a track is lost on the average (default 30)");
  program.AddJson(&s.json);
}

Result<FlightSource> SourceOf(Settings& s) {
  if (!s.along.empty()) return ReadFlight(s.along);
  for (const auto& kind :
       {sim::TrajectoryKind::kSine, sim::TrajectoryKind::kArc, sim::TrajectoryKind::kRec}) {
    if (s.spline == sim::ToString(kind)) s.flight.kind = kind;
  }
  s.flight.seed = s.seed;
  s.flight.seconds = s.plan.seconds > 0.0 ? s.plan.start_s + s.plan.seconds : 0.0;
  return SimulateFlight(s.flight);
}

Result<Scene> SceneOf(const Settings& s, const FlightSource& source,
                      const vision::ImageRecording& recording, Flight* flight) {
  std::vector<Texture> textures;
  for (const std::string& file : s.textures) {
    auto texture = Texture::FromFile(file, s.texture_width_m);
    if (!texture.ok()) return texture.status();
    textures.push_back(std::move(texture).value());
  }
  // The cameras' way, close enough that nothing fits in between.
  std::vector<Vector3> way;
  constexpr std::int64_t kStepNs = 50'000'000;
  const std::int64_t last_ns = recording.frames.back().stamp_ns;
  for (std::int64_t t = recording.frames.front().stamp_ns;; t = std::min(t + kStepNs, last_ns)) {
    const Pose T_w_b = flight->At(t).T_w_b;
    for (const vision::Camera& camera : recording.cameras)
      way.emplace_back(T_w_b * Vector3(camera.T_b_c.p()));
    if (t == last_ns) break;
  }
  return MakeScene(way, source.gravity, s.scene, std::move(textures));
}

nlohmann::ordered_json BoxJson(const Box& box) {
  return {{"low_m", {box.low[0], box.low[1], box.low[2]}},
          {"high_m", {box.high[0], box.high[1], box.high[2]}}};
}

nlohmann::ordered_json ToJson(const Settings& s, const Scene& scene,
                              const vision::ImageRecording& recording,
                              const RenderFigures& figures) {
  nlohmann::ordered_json json = JsonHeader(kName, s.along);
  json["interrupted"] = Interrupted();
  json["frames"] = recording.frames.size();
  json["cameras"] = recording.cameras.size();
  json["images"] = figures.images;
  json["views_per_image"] = figures.views / std::max(figures.images, 1);
  json["render_s"] = figures.render_s;
  json["write_s"] = figures.write_s;
  const Matrix3& R = scene.R_s_w;
  for (int i = 0; i < 3; ++i)
    json["R_room_world"].push_back({R(i, 0), R(i, 1), R(i, 2)});
  json["room"] = BoxJson(scene.room);
  json["boxes"] = nlohmann::ordered_json::array();
  for (const Box& box : scene.boxes)
    json["boxes"].push_back(BoxJson(box));
  return json;
}

/// What must be so before anything is written.
Status CheckFolder(const Settings& s) {
  const auto refused = [](std::string why) {
    return Status(StatusCode::kInvalidArgument, std::move(why));
  };
  if (s.along.empty() == s.spline.empty()) return refused("one of --along and --spline is needed");
  std::error_code error;
  fs::path folder(s.folder);
  if (fs::exists(folder / "mav0", error)) {
    return refused(s.folder + ": holds a recording (mav0) already");
  }
  if (!folder.has_filename()) folder = folder.parent_path();
  if (folder.has_parent_path() && !fs::is_directory(folder.parent_path(), error)) {
    return refused(s.folder + ": there is no folder " + folder.parent_path().string());
  }
  return {};
}

Outcome Run(Settings& s) {
  if (Status c = CheckFolder(s); !c.ok()) return BadInput(c);
  auto source = SourceOf(s);
  if (!source.ok()) return BadInput(source.status());
  s.lens.model = !s.lens_model.empty() ? s.lens_model : source->is_rectified ? "radtan" : "own";
  for (std::size_t c = 0; c < source->cameras.size(); ++c) {
    vision::Camera& camera = source->cameras[c];
    camera = WithLens(camera, static_cast<int>(c), s.lens);
    if (Status v = camera.Validate(); !v.ok()) return BadInput(v);
  }
  Flight flight(source->ground_truth, source->imu, source->gravity);
  auto recording = PlanRecording(*source, s.plan, s.folder, &flight);
  if (!recording.ok()) return BadInput(recording.status());
  s.scene.seed = s.render.photometry.seed = s.ideal.seed = s.seed;
  const auto scene = SceneOf(s, *source, *recording, &flight);
  if (!scene.ok()) return BadInput(scene.status());

  for (const std::string& file : recording->frames.front().files) {
    std::error_code error;
    fs::create_directories(fs::path(file).parent_path(), error);
    if (error) {
      return Failed({StatusCode::kIoError, s.folder + ": cannot be made: " + error.message()});
    }
  }
  const auto rendered = [&] {
    StatusLine status;
    return RenderRecording(
        s.render, *scene, &flight, &*recording, [&](const RenderFigures& figures, double part) {
          status.ShowPart(
              fmt::format("{}: {:.0f} images/s", s.folder, figures.images / figures.total_s()),
              part);
        });
  }();
  if (!rendered.ok()) return Failed(rendered.status());
  const RenderFigures& figures = *rendered;
  if (Status w = vision::WriteEurocRecording(*recording, s.folder); !w.ok()) return Failed(w);
  if (!s.tracks.empty()) {
    const Viotracks tracks = PerfectTracks(s.ideal, *recording, *scene, source->gravity);
    if (Status w = WriteViotracks(tracks, s.tracks); !w.ok()) return Failed(w);
  }
  const Box& room = scene->room;
  Print(
      "{}: {} frames, {} images, {} IMU samples; a room of {:.1f} x {:.1f} x {:.1f} m, {} boxes\n",
      s.folder, recording->frames.size(), figures.images, recording->imu.size(),
      room.high[0] - room.low[0], room.high[1] - room.low[1], room.high[2] - room.low[2],
      scene->boxes.size());
  Print("{:.1f} ms an image to render, {:.2f} views each; {:.1f} ms to write\n",
        1e3 * figures.render_s / figures.images, figures.views / figures.images,
        1e3 * figures.write_s / figures.images);
  if (!s.json.empty()) {
    const auto json = ToJson(s, *scene, *recording, figures);
    if (Status w = WriteJson(s.json, json, 2); !w.ok()) return Failed(w);
  }
  return {};
}

}  // namespace
}  // namespace glissade::app

int main(int argc, char** argv) {
  using namespace glissade::app;
  return Program(kName, kDescription, kFooter).Main<Settings>(argc, argv, AddOptions, Run);
}
