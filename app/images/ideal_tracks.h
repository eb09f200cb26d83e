// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <optional>
#include <vector>

#include "glissade/io/viotracks.h"
#include "glissade/sim/noise_source.h"
#include "glissade/vision/camera.h"
#include "glissade/vision/image_recording.h"
#include "images/scene.h"

namespace glissade::app {

struct IdealTrackOptions {
  double noise_px = 0.5;     ///< sigma of each coordinate, in the distorted image
  double age_frames = 30.0;  ///< a track is lost with probability 1 / age in each frame
  int cell_px = 48;          ///< a new track begins in each cell of a grid that has none
  std::uint64_t seed = 1;
};

/// What a perfect tracker with so much noise would make of the images: points on the surfaces,
/// followed for as long as the first camera sees them and luck lasts, found in the second one
/// wherever that sees them.
class IdealTracks {
 public:
  IdealTracks(const IdealTrackOptions& options, std::vector<vision::Camera> cameras);

  /// Appends the observations of the next frame (its index, and T_s_b of the body) to the tracks.
  void Observe(const Scene& scene, const Pose& T_s_b, std::int32_t frame,
               std::vector<ViotracksObservation>* tracks);

 private:
  struct Track {
    std::int32_t id = 0;
    Vector3 p_s;
  };
  /// The pixel of a point, absent where the camera does not see it.
  [[nodiscard]] std::optional<Vector2> See(const Scene& scene, const vision::Camera& camera,
                                           const Pose& T_s_c, const Vector3& p_s) const;
  void Record(const vision::Camera& camera, const Vector2& uv, ViotracksObservation observation,
              std::vector<ViotracksObservation>* tracks);

  IdealTrackOptions options_;
  std::vector<vision::Camera> cameras_;
  sim::NoiseSource random_;
  std::vector<Track> tracks_;
  std::int32_t next_id_ = 0;
};

/// Of all frames of a recording in a scene, at its true poses, with its IMU and its truth. gravity
/// in W, m/s^2.
Viotracks PerfectTracks(const IdealTrackOptions& options, const vision::ImageRecording& recording,
                        const Scene& scene, const Vector3& gravity);

}  // namespace glissade::app
