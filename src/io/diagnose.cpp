// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/diagnose.h"

#include <limits>
#include <vector>

#include "glissade/io/replay.h"

namespace glissade {

DoctorReport Diagnose(const Viotracks& recording, const DoctorOptions& options) {
  const std::vector<WindowCamera> cameras = WindowCameras(recording);
  std::vector<DoctorImageSize> sizes;
  for (const ViotracksCamera& c : recording.cameras)
    sizes.push_back({c.width, c.height});
  std::vector<std::vector<FrameObservation>> observations;
  std::vector<FrameObservations> frames;
  ViotracksReplay replay(recording, {.num_cameras = std::numeric_limits<std::size_t>::max()});
  while (replay.Next()) {
    const auto of_frame = replay.observations();
    observations.emplace_back(of_frame.begin(), of_frame.end());
    frames.push_back({recording.frames[replay.frame()].stamp_ns, observations.back()});
  }
  DoctorInput input;
  input.imu = recording.imu;
  input.imu_noise = recording.imu_noise;
  input.imu_rate_hz = recording.imu_rate_hz;
  input.frames = frames;
  input.cameras = cameras;
  input.image_sizes = sizes;
  input.gravity = recording.gravity;
  return Diagnose(input, options);
}

}  // namespace glissade
