// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <string_view>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/vision/camera.h"
#include "glissade/vision/gyro_rotation.h"
#include "glissade/vision/image.h"
#include "glissade/vision/tracker_options.h"
#include "glissade/window/observation.h"

namespace glissade::vision {

/// A feature in one image.
struct Feature {
  std::int64_t track = 0;      ///< the same number wherever the same point is seen
  int camera = 0;              ///< index in the cameras
  std::array<double, 2> px{};  ///< as in the image, distorted
  std::array<double, 2> xy{};  ///< (x/z, y/z) of the ray
  int age = 0;                 ///< frames before this one that have seen the track
  /// Estimated sigma of px, each coordinate: of image noise in the direction in which the patch
  /// says least, and of what tracking back leaves.
  double sigma_px = 0.0;
};

/// What a tracker tells of besides its features.
enum class TrackerEvent : std::uint8_t {
  kImageDark,         ///< shows nothing: black
  kImageBright,       ///< shows nothing: overexposed
  kImageFlat,         ///< shows nothing: one grey
  kImageRepeated,     ///< the last image again, to the last bit: only a simulation has no noise
  kImageBlurred,      ///< most features were not found again
  kTracksLost,        ///< for too long nothing was found again: began anew
  kSecondCameraLost,  ///< the first camera shows features, the second one nothing, or hangs
};
inline constexpr std::size_t kNumTrackerEvents = 7;

/// "image dark"
std::string_view ToString(TrackerEvent event);

/// Of one frame: how many, and where the time went (ms by the thread's clock).
struct TrackerReport {
  int tracked = 0;          ///< found again
  int lost = 0;             ///< not found, or not back where they came from
  int rejected = 0;         ///< found, but off their epipolar lines
  int detected = 0;         ///< new
  int stereo = 0;           ///< in the second camera
  double median_age = 0.0;  ///< of features of the first camera
  std::array<bool, kNumTrackerEvents> events{};
  double contrast_ms = 0.0;  ///< contrast and pyramids
  double track_ms = 0.0;
  double reject_ms = 0.0;
  double detect_ms = 0.0;
  double stereo_ms = 0.0;

  [[nodiscard]] bool operator[](TrackerEvent event) const {
    return events[static_cast<std::size_t>(event)];
  }
  [[nodiscard]] double total_ms() const {
    return contrast_ms + track_ms + reject_ms + detect_ms + stereo_ms;
  }
};

/// Follows corners through the images of a camera or a stereo pair:
///
///     FeatureTracker tracker(cameras, options);
///     tracker.Track(stamp_ns, images, IntegrateGyro(samples, last_stamp_ns, stamp_ns));
///     window.AddFrame(stamp_ns, tracker.observations());
///
/// - Lucas and Kanade's tracker (Bouguet's pyramid, OpenCV), there and back, from where the turn of
///   the body says the feature is;
/// - outliers of the epipolar geometry by RANSAC, with two points a hypothesis where the turn is
///   known: only the direction of the way remains to be found;
/// - new corners in the free cells of a grid;
/// - in the second image, search along the epipolar curve from infinity to the nearest depth, then
///   Lucas and Kanade's tracker, there and back.
///
/// The same images give the same features, to the last bit. Not for use by two threads at once.
class FeatureTracker {
 public:
  /// One or two cameras. Cameras or options that make no sense: Track() says so.
  FeatureTracker(std::vector<Camera> cameras, const TrackerOptions& options = {});
  ~FeatureTracker();
  /// Of what was moved from nothing but its destruction and assignment is allowed.
  FeatureTracker(FeatureTracker&&) noexcept;
  FeatureTracker& operator=(FeatureTracker&&) noexcept;

  /// What makes Track() refuse everything: cameras and options that make no sense.
  [[nodiscard]] Status Validate() const;
  /// Images of all cameras, that of the second may be empty: it saw nothing. `turn` is that of the
  /// body since last_stamp_ns(); absent: not known. Refused, and nothing changed, with
  /// kInvalidArgument: a stamp that is not later than the last, an image whose size is not its
  /// camera's, no image of the first camera, a rotation that is none; and whatever cameras and
  /// options that make no sense were given. kOutOfMemory, kEvaluationFailed (OpenCV's words):
  /// begins anew with the next image.
  Status Track(std::int64_t stamp_ns, std::span<const ImageView> images,
               const std::optional<BodyTurn>& turn, TrackerReport* report = nullptr);
  /// Of the last frame that was taken; absent before the first one.
  [[nodiscard]] std::optional<std::int64_t> last_stamp_ns() const;

  /// Of the last frame; those of the first camera come first, in the order of track numbers.
  [[nodiscard]] std::span<const Feature> features() const;
  /// The same, undistorted, as a window takes them (cameras: WithoutDistortion).
  [[nodiscard]] std::span<const FrameObservation> observations() const;
  [[nodiscard]] std::span<const Camera> cameras() const;
  [[nodiscard]] const TrackerOptions& options() const;
  /// Forgets all tracks; numbers go on.
  void Reset();

 private:
  struct Impl;
  std::unique_ptr<Impl> impl_;
};

}  // namespace glissade::vision
