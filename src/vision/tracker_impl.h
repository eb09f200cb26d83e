// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ctime>
#include <optional>
#include <utility>
#include <vector>

#include "glissade/vision/feature_tracker.h"
#include "vision/corner_detector.h"
#include "vision/frame_image.h"
#include "vision/stereo_search.h"

namespace glissade::vision {

namespace internal {

/// Noise of a grey value after contrast has been evened out, sigma.
inline constexpr double kGreySigma = 4.0;

inline double ThreadMs() {
  timespec t{};
  clock_gettime(CLOCK_THREAD_CPUTIME_ID, &t);
  return 1e3 * static_cast<double>(t.tv_sec) + 1e-6 * static_cast<double>(t.tv_nsec);
}

/// Adds the time since it was made to a figure.
class Stopwatch {
 public:
  explicit Stopwatch(double* ms) : ms_(ms), begin_(ThreadMs()) {}
  ~Stopwatch() { *ms_ += ThreadMs() - begin_; }
  Stopwatch(const Stopwatch&) = delete;
  Stopwatch& operator=(const Stopwatch&) = delete;

 private:
  double* ms_;
  double begin_;
};

/// A feature of the reference image: the last one that showed something.
struct Tracked {
  std::int64_t track = 0;
  cv::Point2f px;
  double xy[2] = {0.0, 0.0};
  int age = 0;
  double sigma_px = 0.0;
  std::optional<double> inverse_depth;  ///< by the stereo pair, 1/m
};

}  // namespace internal

struct FeatureTracker::Impl {
  Impl(std::vector<Camera> cameras_in, const TrackerOptions& options_in)
      : cameras(std::move(cameras_in)), options(options_in), valid(Check()) {
    if (!valid.ok()) return;
    for (const Camera& camera : cameras)
      makers.emplace_back(options, camera.width, camera.height);
    if (cameras.size() > 1) stereo.emplace(cameras[0], cameras[1], options.min_depth_m);
  }

  [[nodiscard]] Status Check() const;
  [[nodiscard]] Status CheckFrame(std::int64_t stamp_ns, std::span<const ImageView> images,
                                  const std::optional<BodyTurn>& turn) const;
  void TrackFrame(std::int64_t stamp_ns, std::span<const ImageView> images);
  /// Whether the image shows anything; names what is wrong with it.
  bool Shows(const ImageView& image);
  /// The last image of a camera again; else it becomes the last one.
  static bool IsRepeated(const ImageView& image, cv::Mat* last);
  void FollowFeatures();
  void RejectOutliers(const std::vector<internal::Tracked>& before,
                      std::vector<internal::Tracked>* found);
  void DetectCorners();
  void MatchSecondCamera(const ImageView& image);
  void Publish(const std::vector<internal::Tracked>& tracked);
  bool MakeTracked(const cv::Point2f& px, internal::Tracked* tracked) const;
  void Raise(TrackerEvent event) { report.events[static_cast<std::size_t>(event)] = true; }
  /// R_c_reference_c_now of the first camera; absent: not known.
  [[nodiscard]] std::optional<Matrix3> CameraTurn() const;

  std::vector<Camera> cameras;
  TrackerOptions options;
  Status valid;
  std::vector<internal::FrameImageMaker> makers;
  std::optional<internal::StereoSearch> stereo;
  internal::CornerDetector detector;

  std::optional<std::int64_t> last_stamp_ns;
  // The reference: image, features, and how the body turned since.
  std::int64_t reference_ns = 0;
  internal::FrameImage reference, now, second;
  cv::Mat last_raw[2];  // of each camera
  std::vector<internal::Tracked> tracks;
  std::optional<Matrix3> R_reference_now = Matrix3::Identity();
  std::int64_t now_ns = 0;
  std::int64_t next_track = 0;

  std::vector<Feature> features;
  std::vector<FrameObservation> observations;
  TrackerReport report;
  // Work.
  std::vector<cv::Point2f> points, guesses;
  internal::LkResult lk;
};

}  // namespace glissade::vision
