// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A visual-inertial odometry from images: a small front end on OpenCV before a SlidingWindow, to
// start your own from. One camera and an IMU, a recording in EuRoC's layout. Writes the trajectory
// as TUM has it, and prints the error where there is a ground truth.
//
//     vio_images DIRECTORY trajectory.tum
// What it leaves out is in docs/front_end.md.
#include <glissade/eval/absolute_error.h>
#include <glissade/eval/alignment.h>
#include <glissade/io/trajectory.h>
#include <glissade/vision/gyro_rotation.h>
#include <glissade/vision/image.h>
#include <glissade/vision/image_recording.h>
#include <glissade/window/sliding_window.h>

#include <cmath>
#include <cstdio>
#include <opencv2/calib3d.hpp>
#include <opencv2/imgproc.hpp>
#include <opencv2/video/tracking.hpp>

using namespace glissade;

namespace {

/// Corners, followed from image to image.
class FrontEnd {
 public:
  explicit FrontEnd(const vision::Camera& camera) : camera_(camera) {}

  /// What the window is told of this image. `turn`: of the body since the last one.
  std::vector<FrameObservation> Track(const cv::Mat& grey,
                                      const std::optional<vision::BodyTurn>& turn) {
    cv::Mat image;
    cv::createCLAHE(3.0, cv::Size(12, 8))->apply(grey, image);
    if (!points_.empty()) Follow(image, turn);
    Detect(image);
    last_ = image;
    std::vector<FrameObservation> observations;
    const CameraPinhole& f = camera_.pinhole();
    for (std::size_t k = 0; k < points_.size(); ++k) {
      const Vector2 xy = Ray(points_[k]);
      observations.push_back({ids_[k], 0, f.fx * xy[0] + f.cx, f.fy * xy[1] + f.cy});
    }
    return observations;
  }

 private:
  /// (x/z, y/z), without the lens's distortion.
  [[nodiscard]] Vector2 Ray(const cv::Point2f& p) const {
    const double uv[2] = {p.x, p.y};
    double xy[2] = {0.0, 0.0};
    if (!camera_.Undistort(uv, xy)) xy[0] = NAN;  // the window leaves it out
    return Vector2(xy[0], xy[1]);
  }

  /// Where a point will be if only the body turned: the gyroscope knows that, and the tracker has
  /// less far to look.
  [[nodiscard]] cv::Point2f Predict(const cv::Point2f& p, const vision::BodyTurn& turn) const {
    const Matrix3 R_b_c = camera_.T_b_c.q().toRotationMatrix();
    const Vector2 ray = Ray(p);
    const Vector3 f =
        R_b_c.transpose() * turn.R_from_to.transpose() * R_b_c * Vector3(ray[0], ray[1], 1.0);
    const double xy[2] = {f[0] / f[2], f[1] / f[2]};
    double uv[2] = {p.x, p.y};
    if (f[2] > 0.1) camera_.Distort(xy, uv);
    return {static_cast<float>(uv[0]), static_cast<float>(uv[1])};
  }

  void Follow(const cv::Mat& image, const std::optional<vision::BodyTurn>& turn) {
    std::vector<cv::Point2f> found;
    for (const cv::Point2f& p : points_)
      found.push_back(turn ? Predict(p, *turn) : p);
    std::vector<uchar> forth, back;
    std::vector<float> unused;
    const cv::Size window(21, 21);
    const cv::TermCriteria stop(cv::TermCriteria::COUNT | cv::TermCriteria::EPS, 20, 0.03);
    cv::calcOpticalFlowPyrLK(last_, image, points_, found, forth, unused, window, 3, stop,
                             cv::OPTFLOW_USE_INITIAL_FLOW);
    // And back: a point that does not return to where it was has slipped.
    std::vector<cv::Point2f> returned = points_;
    cv::calcOpticalFlowPyrLK(image, last_, found, returned, back, unused, window, 1, stop,
                             cv::OPTFLOW_USE_INITIAL_FLOW);
    std::vector<cv::Point2f> points, before, after;
    std::vector<std::int64_t> ids;
    for (std::size_t k = 0; k < found.size(); ++k) {
      if (!forth[k] || !back[k] || cv::norm(returned[k] - points_[k]) > 0.5) continue;
      if (!cv::Rect({}, image.size()).contains(cv::Point(found[k]))) continue;
      points.push_back(found[k]);
      ids.push_back(ids_[k]);
      const Vector2 a = Ray(points_[k]), b = Ray(found[k]);
      before.emplace_back(static_cast<float>(a[0]), static_cast<float>(a[1]));
      after.emplace_back(static_cast<float>(b[0]), static_cast<float>(b[1]));
    }
    // What is off its epipolar line moves by itself, or was mistaken for something else.
    std::vector<uchar> fits(points.size(), 1);
    if (points.size() >= 8) {
      cv::findFundamentalMat(before, after, cv::FM_RANSAC, 2.0 / camera_.pinhole().fx, 0.99, fits);
    }
    points_.clear();
    ids_.clear();
    for (std::size_t k = 0; k < fits.size(); ++k) {
      if (!fits[k]) continue;
      points_.push_back(points[k]);
      ids_.push_back(ids[k]);
    }
  }

  void Detect(const cv::Mat& image) {
    constexpr int kFeatures = 150, kDistance = 25;
    const int missing = kFeatures - static_cast<int>(points_.size());
    if (missing <= 0) return;
    cv::Mat free(image.size(), CV_8UC1, cv::Scalar(255));
    for (const cv::Point2f& p : points_)
      cv::circle(free, p, kDistance, cv::Scalar(0), cv::FILLED);
    std::vector<cv::Point2f> corners;
    cv::goodFeaturesToTrack(image, corners, missing, 0.01, kDistance, free);
    for (const cv::Point2f& p : corners) {
      points_.push_back(p);
      ids_.push_back(next_id_++);
    }
  }

  vision::Camera camera_;
  cv::Mat last_;
  std::vector<cv::Point2f> points_;
  std::vector<std::int64_t> ids_;
  std::int64_t next_id_ = 0;
};

int Refused(const Status& status) {
  std::fprintf(stderr, "vio_images: %s\n", status.message().c_str());
  return 1;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return Refused({StatusCode::kInvalidArgument, "DIRECTORY trajectory.tum"});
  const auto recording = vision::ReadImageRecording(argv[1]);
  if (!recording.ok()) return Refused(recording.status());

  SlidingWindowOptions options;
  options.cameras = {vision::WithoutDistortion(recording->cameras[0], 0.7)};  // sigma in px
  options.imu_noise = recording->imu_noise;
  if (!options.imu_noise) return Refused({StatusCode::kInvalidArgument, "no IMU"});
  options.imu_noise->gyro_noise_density *= 3.0;  // a sensor shakes more than on its data sheet
  options.imu_noise->accel_noise_density *= 3.0;
  if (const Status s = options.Validate(); !s.ok()) return Refused(s);
  SlidingWindow window(options);
  FrontEnd front_end(recording->cameras[0]);

  const std::span<const ImuSample> imu(recording->imu);
  std::size_t next_imu = 0;
  std::int64_t last_stamp = 0;
  eval::Trajectory trajectory;
  for (const vision::ImageFrame& frame : recording->frames) {
    if (frame.files[0].empty()) continue;  // the second camera alone has one
    const auto image = vision::ReadImage(frame.files[0]);
    if (!image.ok()) return Refused(image.status());
    if (image->width != recording->cameras[0].width)
      return Refused({StatusCode::kParseError, "size"});
    const cv::Mat grey(image->height, image->width, CV_8UC1,
                       const_cast<std::uint8_t*>(image->pixels.data()));

    // Samples up to the first one at or after the image; what makes no sense is left out, counted.
    std::size_t end = next_imu;
    while (end < imu.size() && (end == 0 || imu[end - 1].stamp_ns < frame.stamp_ns))
      ++end;
    static_cast<void>(window.AddImu(imu.subspan(next_imu, end - next_imu)));
    next_imu = end;
    ImuBias bias;  // the window's, once it has one
    if (window.phase() == WindowPhase::kRunning) bias.bg = window.newest().speed_bias.bg();
    const auto turn = vision::IntegrateGyro(imu, last_stamp, frame.stamp_ns, bias);
    last_stamp = frame.stamp_ns;

    Status status = window.AddFrame(frame.stamp_ns, front_end.Track(grey, turn));
    if (status.ok()) status = window.Optimize();
    if (!status.ok()) std::fprintf(stderr, "vio_images: %s\n", status.message().c_str());
    if (!status.ok() || window.phase() != WindowPhase::kRunning) continue;
    trajectory.push_back({frame.stamp_ns, window.newest().T_w_b});
  }
  if (trajectory.empty()) return Refused(window.init_verdict().ToStatus());
  if (const Status s = WriteTumTrajectory(trajectory, argv[2]); !s.ok()) return Refused(s);
  eval::Trajectory truth;
  for (const GroundTruthState& state : recording->ground_truth)
    truth.push_back({state.stamp_ns, state.T_w_b});
  auto matched = eval::Associate(trajectory, truth);
  if (!matched.ok()) return 0;  // no truth to judge by
  const auto alignment = eval::Align(*matched, {.kind = eval::AlignmentKind::kYaw});
  if (!alignment.ok()) return Refused(alignment.status());
  eval::ApplyAlignment(*alignment, matched->estimate);
  const auto errors = eval::ComputeAbsoluteErrors(*matched);
  if (!errors.ok()) return Refused(errors.status());
  std::printf("# %zu of %zu frames; RMS position error %.3f m\n", trajectory.size(),
              recording->frames.size(), errors->translation_m.rmse);
  return 0;
}
