// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/render_recording.h"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <vector>

#include "common/interrupt.h"
#include "images/renderer.h"

namespace glissade::app {

namespace {

using Clock = std::chrono::steady_clock;

double Since(Clock::time_point t) {
  return std::chrono::duration<double>(Clock::now() - t).count();
}

/// Where the camera is while the shutter is open: once for each pixel that the image moves by.
std::vector<Pose> PosesOf(const RenderOptions& options, const Scene& scene,
                          const Renderer& renderer, const Pose& T_b_c, std::int64_t stamp_ns,
                          Flight* flight) {
  const double open_ns = 1e6 * options.exposure_ms;
  const auto pose_at = [&](double part) {
    return scene.ToScene(flight->At(stamp_ns + std::llround((part - 0.5) * open_ns)).T_w_b * T_b_c);
  };
  int samples = 1;
  if (options.exposure_ms > 0.0 && options.blur_samples > 1) {
    const double motion_px = renderer.MotionBetween(scene, pose_at(0.0), pose_at(1.0));
    samples = std::clamp(static_cast<int>(std::ceil(motion_px)), 1, options.blur_samples);
  }
  std::vector<Pose> poses;
  for (int k = 0; k < samples; ++k)
    poses.push_back(pose_at((k + 0.5) / samples));
  return poses;
}

}  // namespace

Result<RenderFigures> RenderRecording(
    const RenderOptions& options, const Scene& scene, Flight* flight,
    vision::ImageRecording* recording,
    const std::function<void(const RenderFigures& figures, double part)>& progress) {
  std::vector<Renderer> renderers;
  std::vector<Photometry> sensors;
  for (std::size_t c = 0; c < recording->cameras.size(); ++c) {
    const vision::Camera& camera = recording->cameras[c];
    renderers.emplace_back(camera);
    sensors.emplace_back(options.photometry, static_cast<int>(c), camera.width, camera.height);
  }
  RenderFigures figures;
  std::vector<float> light;
  std::size_t done = 0;
  for (const vision::ImageFrame& frame : recording->frames) {
    for (std::size_t c = 0; c < renderers.size(); ++c) {
      const auto begin = Clock::now();
      const auto poses = PosesOf(options, scene, renderers[c], recording->cameras[c].T_b_c,
                                 frame.stamp_ns, flight);
      renderers[c].RenderMoving(scene, poses, &light);
      const vision::Image image = sensors[c].Capture(light, frame.stamp_ns);
      figures.render_s += Since(begin);
      const auto rendered = Clock::now();
      if (Status s = vision::WriteImage(image.view(), frame.files[c], options.jpeg_quality);
          !s.ok()) {
        return s;
      }
      figures.write_s += Since(rendered);
      figures.views += static_cast<double>(poses.size());
      ++figures.images;
    }
    ++done;
    progress(figures, static_cast<double>(done) / static_cast<double>(recording->frames.size()));
    if (Interrupted()) break;
  }
  recording->frames.resize(done);
  recording->ground_truth.resize(done);
  return figures;
}

}  // namespace glissade::app
