// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/feature_tracker.h"

#include <algorithm>
#include <cstring>
#include <new>
#include <optional>
#include <string>
#include <utility>

#include "vision/as_mat.h"
#include "vision/tracker_impl.h"

namespace glissade::vision {

namespace {

Status Refused(std::string why) {
  return {StatusCode::kInvalidArgument, std::move(why)};
}

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

Status FeatureTracker::Impl::Check() const {
  if (cameras.empty() || cameras.size() > 2) return Refused("one or two cameras are tracked in");
  for (const Camera& camera : cameras)
    if (Status s = camera.Validate(); !s.ok()) return s;
  if (cameras.size() > 1) {
    const Camera &a = cameras[0], &b = cameras[1];
    if (a.width != b.width || a.height != b.height) {
      return Refused("images of a stereo pair must be of one size: " + std::to_string(a.width) +
                     " x " + std::to_string(a.height) + " and " + std::to_string(b.width) + " x " +
                     std::to_string(b.height) + " px");
    }
    if (!((a.T_b_c.p() - b.T_b_c.p()).norm() > 1e-6)) {
      return Refused("the cameras of a stereo pair must not be in one place");
    }
  }
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
    if (!((R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-6) ||
        R.determinant() < 0.0) {
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

bool FeatureTracker::Impl::MakeTracked(const cv::Point2f& px, internal::Tracked* tracked) const {
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
  if (IsRepeated(image, &last_raw[0])) {
    Raise(TrackerEvent::kImageRepeated);
    return false;
  }
  return true;
}

bool FeatureTracker::Impl::IsRepeated(const ImageView& image, cv::Mat* last) {
  // Noise makes every image another one: a driver has handed this one over twice, or the camera
  // hangs. Features that stay where they are would be believed.
  if (!last->empty() && SameImage(*last, image)) return true;
  internal::AsMat(image).copyTo(*last);
  return false;
}

void FeatureTracker::Impl::Publish(const std::vector<internal::Tracked>& tracked) {
  for (const internal::Tracked& t : tracked) {
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
    if (!tracks.empty() && SecondsBetween(reference_ns, now_ns) > options.max_blind_s) {
      tracks.clear();
      Raise(TrackerEvent::kTracksLost);
    }
    return;
  }
  {
    const internal::Stopwatch watch(&report.contrast_ms);
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

Status FeatureTracker::Validate() const {
  return impl_->valid;
}

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
  for (cv::Mat& last : impl_->last_raw)
    last.release();
  impl_->features.clear();
  impl_->observations.clear();
  impl_->R_reference_now = Matrix3::Identity();
}

}  // namespace glissade::vision
