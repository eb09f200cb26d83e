// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/lie/pose.h"
#include "glissade/window/initialize_in_motion.h"

/// \file
/// What vision makes of a window: poses of a rig of cameras and points, in the axes of vision, V.
namespace glissade::internal {

/// One observation of a track, on normalized coordinates.
struct Sight {
  std::size_t frame = 0;
  std::size_t camera = 0;  ///< of the rig
  Vector2 xy = Vector2::Zero();
  bool bad = false;  ///< does not fit
};

struct SightedTrack {
  std::int64_t id = 0;
  std::vector<Sight> sights;  ///< frames in order
  bool has_point = false;
  Vector3 point = Vector3::Zero();  ///< in V
};

struct RigCamera {
  Pose T_r_c;                               ///< camera in rig
  Vector2 sigma = Vector2::Ones();          ///< of a sight
  Matrix2 whitening = Matrix2::Identity();  ///< diag(1 / sigma)
};

struct Scene {
  bool stereo = false;
  /// Stereo: the rig is the body. Mono: the rig is the camera, at the identity, and V has no scale.
  std::vector<RigCamera> cameras;
  Pose T_b_r;                        ///< rig in body
  std::vector<Pose> poses;           ///< T_V_R by frame
  std::vector<char> located;         ///< by frame
  std::vector<SightedTrack> tracks;  ///< by id
};

/// Sorts the observations by tracks seen more than once; stereo where enough of them are seen by
/// two cameras at once, else the camera that sees most.
Scene CollectScene(const InitializationInput& input);

/// The ray of a sight: centre and direction in V.
struct Ray {
  Vector3 centre, direction;
};
Ray RayOf(const Scene& scene, const Sight& sight);

/// The point of a track from its sights in located frames: linear, then Gauss-Newton on image
/// coordinates. False where it would lie behind a camera, is not determined (its depth has a sigma
/// of more than half of itself), or does not fit (mean chi2 of a sight over 9); the track is then
/// without a point.
bool Triangulate(const Scene& scene, SightedTrack* track);

/// Sum of chi2 over the good sights of tracks with a point.
double VisionChi2(const Scene& scene);

/// Whether the depth of a point has a sigma of less than half of itself, its poses being exact.
bool IsDetermined(const Scene& scene, const SightedTrack& track);

/// How many tracks fit a frame, and how many it takes.
struct FrameFit {
  int tracks = 0;
  int needed = 0;
};
/// Locates a frame in the points there are, from scene.poses[frame] as a start. The frame is
/// located where at least kMinTracks tracks fit, and a third of those that it sees.
FrameFit LocateFrame(std::size_t frame, Scene* scene);

/// Refines all located frames and points with a robust loss, then marks what does not fit as bad,
/// and takes points away from tracks with fewer than two good sights. V stays where it is at
/// `fixed`; a mono scene keeps the distance of `second` to it in one coordinate.
Status AdjustScene(std::size_t fixed, std::size_t second, int iterations, Scene* scene);

/// With which a window can be worked with at all.
inline constexpr int kMinTracks = 10;

}  // namespace glissade::internal
