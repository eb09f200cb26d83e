// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/feature_tracker.h"

#include <algorithm>
#include <cmath>
#include <cstring>
#include <ctime>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "vision/corner_detector.h"
#include "vision/epipolar.h"
#include "vision/frame_image.h"
#include "vision/stereo_search.h"

namespace glissade::vision {

namespace {

using internal::FrameImage;

// A gyroscope whose bias nobody has estimated: so wrong is a rate, sigma (rad/s).
constexpr double kBiasSigma = 0.1;
// Noise of a grey value after contrast has been evened out, sigma.
constexpr double kGreySigma = 4.0;

double ThreadMs() {
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

Status Refused(std::string why) {
  return {StatusCode::kInvalidArgument, std::move(why)};
}

/// A feature of the reference image: the last one that showed something.
struct Tracked {
  std::int64_t track = 0;
  cv::Point2f px;
  double xy[2] = {0.0, 0.0};
  int age = 0;
  double sigma_px = 0.0;
  std::optional<double> inverse_depth;  ///< by the stereo pair
};

bool SameImage(const cv::Mat& a, const ImageView& b) {
  if (a.cols != b.width || a.rows != b.height) return false;
  for (int y = 0; y < b.height; ++y) {
    if (std::memcmp(a.ptr(y), b.data + static_cast<std::size_t>(y) * b.stride,
                    static_cast<std::size_t>(b.width)) != 0) {
      return false;
    }
  }
  return true;
}

}  // namespace

std::string_view ToString(TrackerEvent event) {
  switch (event) {
    case TrackerEvent::kImageDark:
      return "image dark";
    case TrackerEvent::kImageBright:
      return "image bright";
    case TrackerEvent::kImageFlat:
      return "image flat";
    case TrackerEvent::kImageRepeated:
      return "image repeated";
    case TrackerEvent::kImageBlurred:
      return "image blurred";
    case TrackerEvent::kTracksLost:
      return "tracks lost";
    case TrackerEvent::kSecondCameraLost:
      return "second camera lost";
  }
  return "unknown";
}

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
  void FollowFeatures();
  void RejectOutliers(const std::vector<Tracked>& before, std::vector<Tracked>* found);
  void DetectCorners();
  void MatchSecondCamera(const ImageView& image);
  void Publish(const std::vector<Tracked>& tracked);
  bool MakeTracked(const cv::Point2f& px, Tracked* tracked) const;
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
  FrameImage reference, now, second;
  cv::Mat last_raw;
  std::vector<Tracked> tracks;
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

Status FeatureTracker::Impl::Check() const {
  if (cameras.empty() || cameras.size() > 2) return Refused("one or two cameras are tracked in");
  for (const Camera& camera : cameras)
    if (Status s = camera.Validate(); !s.ok()) return s;
  return options.Validate();
}

Status FeatureTracker::Impl::CheckFrame(std::int64_t stamp_ns, std::span<const ImageView> images,
                                        const std::optional<BodyTurn>& turn) const {
  if (!valid.ok()) return valid;
  if (last_stamp_ns && stamp_ns <= *last_stamp_ns) {
    return Refused("stamp " + std::to_string(stamp_ns) + " is not later than " +
                   std::to_string(*last_stamp_ns));
  }
  if (images.empty() || images.size() > cameras.size()) {
    return Refused("there must be an image for each camera");
  }
  if (images[0].empty()) return Refused("no image of the first camera");
  for (std::size_t k = 0; k < images.size(); ++k) {
    if (images[k].empty()) continue;
    if (images[k].width == cameras[k].width && images[k].height == cameras[k].height &&
        images[k].stride >= static_cast<std::size_t>(images[k].width)) {
      continue;
    }
    return Refused("image of camera " + std::to_string(k) + " is " +
                   std::to_string(images[k].width) + " x " + std::to_string(images[k].height) +
                   " px, the camera's is " + std::to_string(cameras[k].width) + " x " +
                   std::to_string(cameras[k].height));
  }
  if (turn) {
    const Matrix3& R = turn->R_from_to;
    if (!((R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-6)) {
      return Refused("the turn of the body is no rotation");
    }
  }
  return {};
}

std::optional<Matrix3> FeatureTracker::Impl::CameraTurn() const {
  if (!R_reference_now) return {};
  const Matrix3 R_b_c = cameras[0].T_b_c.q().toRotationMatrix();
  return Matrix3(R_b_c.transpose() * *R_reference_now * R_b_c);
}

bool FeatureTracker::Impl::MakeTracked(const cv::Point2f& px, Tracked* tracked) const {
  const double uv[2] = {static_cast<double>(px.x), static_cast<double>(px.y)};
  tracked->px = px;
  return cameras[0].Undistort(uv, tracked->xy);
}

bool FeatureTracker::Impl::Shows(const ImageView& image) {
  const internal::GreyValues grey = internal::GreyValuesOf(image);
  if (grey.deviation < options.min_contrast) {
    Raise(grey.mean < 32.0    ? TrackerEvent::kImageDark
          : grey.mean > 223.0 ? TrackerEvent::kImageBright
                              : TrackerEvent::kImageFlat);
    return false;
  }
  if (!last_raw.empty() && SameImage(last_raw, image)) {
    // Noise makes every image another one: a driver has handed this one over twice, or the camera
    // hangs. Features that stay where they are would be believed.
    Raise(TrackerEvent::kImageRepeated);
    return false;
  }
  last_raw.create(image.height, image.width, CV_8UC1);
  for (int y = 0; y < image.height; ++y) {
    std::memcpy(last_raw.ptr(y), image.data + static_cast<std::size_t>(y) * image.stride,
                static_cast<std::size_t>(image.width));
  }
  return true;
}

void FeatureTracker::Impl::FollowFeatures() {
  const std::optional<Matrix3> turn = CameraTurn();
  std::vector<Tracked> found;
  {
    const Stopwatch watch(&report.track_ms);
    points.clear();
    guesses.clear();
    for (const Tracked& t : tracks) {
      points.push_back(t.px);
      guesses.push_back(t.px);
      if (!turn) continue;
      const Vector3 f = turn->transpose() * Vector3(t.xy[0], t.xy[1], 1.0);
      const double xy[2] = {f[0] / f[2], f[1] / f[2]};
      double uv[2];
      if (f[2] > 0.0 && cameras[0].Distort(xy, uv)) {
        guesses.back() = cv::Point2f(static_cast<float>(uv[0]), static_cast<float>(uv[1]));
      }
    }
    internal::TrackThereAndBack(reference, now, points, guesses, options,
                                turn ? options.levels_predicted : options.levels_blind, &lk);
    for (std::size_t k = 0; k < tracks.size(); ++k) {
      Tracked t = tracks[k];
      if (lk.found[k] == 0 || !MakeTracked(lk.points[k], &t)) continue;
      const double gradient = static_cast<double>(lk.gradient[k]);
      const double window = options.window_px;
      const double of_noise = kGreySigma / (window * std::sqrt(std::max(1e-3, gradient)));
      t.sigma_px = std::hypot(of_noise, 0.5 * static_cast<double>(lk.back_px[k]));
      ++t.age;
      found.push_back(t);
    }
  }
  report.lost = static_cast<int>(tracks.size() - found.size());
  const std::vector<Tracked> before = std::move(tracks);
  RejectOutliers(before, &found);
  report.tracked = static_cast<int>(found.size());
  tracks = std::move(found);
  if (before.size() < 20 || 3 * tracks.size() >= before.size()) return;
  Raise(TrackerEvent::kImageBlurred);
  if (now_ns - reference_ns > options.max_blind_ns) {
    Raise(TrackerEvent::kTracksLost);
    return;
  }
  // What was found is told, but looked for from the last good image again.
  Publish(tracks);
  tracks = before;
}

void FeatureTracker::Impl::RejectOutliers(const std::vector<Tracked>& before,
                                          std::vector<Tracked>* found) {
  const Stopwatch watch(&report.reject_ms);
  const std::optional<Matrix3> turn = CameraTurn();
  std::vector<internal::Match> matches;
  auto old = before.begin();
  for (const Tracked& t : *found) {
    while (old->track != t.track)
      ++old;
    matches.push_back({{old->xy[0], old->xy[1]}, {t.xy[0], t.xy[1]}});
  }
  const CameraPinhole& pinhole = cameras[0].pinhole();
  const double tolerance = options.max_epipolar_px / (0.5 * (pinhole.fx + pinhole.fy));
  std::vector<unsigned char> fits;
  if (turn) {
    internal::TwoViews views;
    views.R_a_b = *turn;
    const double seconds = 1e-9 * static_cast<double>(now_ns - reference_ns);
    internal::FitMatches(matches, std::max(1e-4, kBiasSigma * seconds), tolerance, &views, &fits);
  } else {
    internal::FitMatchesBlind(matches, tolerance, &fits);
  }
  std::size_t kept = 0;
  for (std::size_t k = 0; k < found->size(); ++k)
    if (fits[k] != 0) (*found)[kept++] = (*found)[k];
  report.rejected = static_cast<int>(found->size() - kept);
  found->resize(kept);
}

void FeatureTracker::Impl::DetectCorners() {
  const Stopwatch watch(&report.detect_ms);
  const int missing = options.max_features - static_cast<int>(tracks.size());
  if (missing <= 0) return;
  points.clear();
  for (const Tracked& t : tracks)
    points.push_back(t.px);
  std::vector<cv::Point2f> corners;
  detector.Detect(now, points, options, missing, &corners);
  for (const cv::Point2f& px : corners) {
    Tracked t;
    if (!MakeTracked(px, &t)) continue;
    t.track = next_track++;
    // A corner is where it is found, to a pixel of the half image at worst: what it is followed to
    // is the patch around it, not the corner.
    t.sigma_px = kGreySigma / (options.window_px * std::sqrt(options.min_corner));
    tracks.push_back(t);
    ++report.detected;
  }
}

void FeatureTracker::Impl::MatchSecondCamera(const ImageView& image) {
  const Stopwatch watch(&report.stereo_ms);
  if (image.empty() || internal::GreyValuesOf(image).deviation < options.min_contrast) {
    Raise(TrackerEvent::kSecondCameraLost);
    return;
  }
  makers[1].Make(image, &second);
  points.clear();
  guesses.clear();
  std::vector<std::size_t> of;
  for (std::size_t k = 0; k < tracks.size(); ++k) {
    Tracked& t = tracks[k];
    cv::Point2f guess;
    double inverse_depth = 0.0;
    if (t.inverse_depth && stereo->Project(t.xy, *t.inverse_depth, &guess)) {
    } else if (!stereo->Search(now, second, t.px, t.xy, &guess, &inverse_depth)) {
      continue;
    }
    points.push_back(t.px);
    guesses.push_back(guess);
    of.push_back(k);
  }
  internal::TrackThereAndBack(now, second, points, guesses, options, 1, &lk);
  for (Tracked& t : tracks)
    t.inverse_depth.reset();
  const CameraPinhole& pinhole = cameras[1].pinhole();
  const double tolerance = options.max_stereo_epipolar_px / (0.5 * (pinhole.fx + pinhole.fy));
  for (std::size_t i = 0; i < of.size(); ++i) {
    Tracked& t = tracks[of[i]];
    const double uv[2] = {static_cast<double>(lk.points[i].x), static_cast<double>(lk.points[i].y)};
    double xy[2];
    if (lk.found[i] == 0 || !cameras[1].Undistort(uv, xy)) continue;
    const double rho = stereo->InverseDepth(t.xy, xy);
    // A little beyond infinity is what noise makes of far points.
    const double beyond = -2.0 * tolerance / cameras[1].T_b_c.p().cwiseAbs().maxCoeff();
    if (stereo->Distance(t.xy, xy) > tolerance || !(rho < 1.0 / options.min_depth_m) ||
        rho < std::min(beyond, -1e-3)) {
      ++report.rejected;
      continue;
    }
    t.inverse_depth = std::max(0.0, rho);
    Feature& f = features.emplace_back();
    f.track = t.track;
    f.camera = 1;
    f.px = {uv[0], uv[1]};
    f.xy = {xy[0], xy[1]};
    f.age = t.age;
    f.sigma_px = std::hypot(t.sigma_px, 0.5 * static_cast<double>(lk.back_px[i]));
    ++report.stereo;
  }
  if (report.stereo == 0 && tracks.size() >= 20) Raise(TrackerEvent::kSecondCameraLost);
}

void FeatureTracker::Impl::Publish(const std::vector<Tracked>& tracked) {
  for (const Tracked& t : tracked) {
    features.push_back({t.track,
                        0,
                        {static_cast<double>(t.px.x), static_cast<double>(t.px.y)},
                        {t.xy[0], t.xy[1]},
                        t.age,
                        t.sigma_px});
  }
}

void FeatureTracker::Impl::TrackFrame(std::int64_t stamp_ns, std::span<const ImageView> images) {
  features.clear();
  now_ns = stamp_ns;
  if (!Shows(images[0])) {
    if (!tracks.empty() && now_ns - reference_ns > options.max_blind_ns) {
      tracks.clear();
      Raise(TrackerEvent::kTracksLost);
    }
    return;
  }
  {
    const Stopwatch watch(&report.contrast_ms);
    makers[0].Make(images[0], &now);
  }
  if (!tracks.empty()) FollowFeatures();
  if (report[TrackerEvent::kImageBlurred] && !report[TrackerEvent::kTracksLost]) return;
  DetectCorners();
  Publish(tracks);
  if (cameras.size() > 1) MatchSecondCamera(images.size() > 1 ? images[1] : ImageView());
  std::swap(reference, now);
  reference_ns = now_ns;
  R_reference_now = Matrix3::Identity();
}

FeatureTracker::FeatureTracker(std::vector<Camera> cameras, const TrackerOptions& options)
    : impl_(std::make_unique<Impl>(std::move(cameras), options)) {}
FeatureTracker::~FeatureTracker() = default;
FeatureTracker::FeatureTracker(FeatureTracker&&) noexcept = default;
FeatureTracker& FeatureTracker::operator=(FeatureTracker&&) noexcept = default;

Status FeatureTracker::Track(std::int64_t stamp_ns, std::span<const ImageView> images,
                             const std::optional<BodyTurn>& turn, TrackerReport* report) {
  Impl& it = *impl_;
  if (Status s = it.CheckFrame(stamp_ns, images, turn); !s.ok()) return s;
  it.report = {};
  if (it.R_reference_now && turn) {
    it.R_reference_now = Matrix3(*it.R_reference_now * turn->R_from_to);
  } else {
    it.R_reference_now.reset();
  }
  Status status;
  try {
    it.TrackFrame(stamp_ns, images);
  } catch (const std::bad_alloc&) {
    status = {StatusCode::kOutOfMemory, "out of memory"};
  } catch (const cv::Exception& e) {
    status = {
        e.code == cv::Error::StsNoMem ? StatusCode::kOutOfMemory : StatusCode::kEvaluationFailed,
        "OpenCV: " + e.err};
  }
  it.last_stamp_ns = stamp_ns;
  if (!status.ok()) {  // the work was cut off: what was known of tracks may be half of it
    Reset();
    return status;
  }
  double ages = 0.0;
  std::vector<int> sorted;
  it.observations.clear();
  for (const Feature& f : it.features) {
    const CameraPinhole& pinhole = it.cameras[static_cast<std::size_t>(f.camera)].pinhole();
    it.observations.push_back(
        {f.track, f.camera, pinhole.fx * f.xy[0] + pinhole.cx, pinhole.fy * f.xy[1] + pinhole.cy});
    if (f.camera == 0) sorted.push_back(f.age);
  }
  if (!sorted.empty()) {
    const auto middle = sorted.begin() + static_cast<std::ptrdiff_t>(sorted.size() / 2);
    std::nth_element(sorted.begin(), middle, sorted.end());
    ages = *middle;
  }
  it.report.median_age = ages;
  if (report != nullptr) *report = it.report;
  return {};
}

std::optional<std::int64_t> FeatureTracker::last_stamp_ns() const {
  return impl_->last_stamp_ns;
}
std::span<const Feature> FeatureTracker::features() const {
  return impl_->features;
}
std::span<const FrameObservation> FeatureTracker::observations() const {
  return impl_->observations;
}
std::span<const Camera> FeatureTracker::cameras() const {
  return impl_->cameras;
}
const TrackerOptions& FeatureTracker::options() const {
  return impl_->options;
}

void FeatureTracker::Reset() {
  impl_->tracks.clear();
  impl_->features.clear();
  impl_->observations.clear();
  impl_->R_reference_now = Matrix3::Identity();
}

}  // namespace glissade::vision
