// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/feature_tracker.h"

#include <gtest/gtest.h>

#include <cmath>
#include <map>

#include "glissade/lie/so3.h"
#include "vision/painted_wall.h"

namespace glissade::vision {
namespace {

using test::SeeWall;
using test::SmallCamera;

constexpr std::int64_t kPeriod = 50'000'000;

TrackerOptions SmallOptions() {
  TrackerOptions options;
  options.max_features = 60;
  options.cell_px = 20;
  options.window_px = 15;
  options.levels_predicted = 1;
  options.levels_blind = 3;
  return options;
}

/// A body that walks and turns before the wall.
Pose PoseAt(int k) {
  return Pose(so3::Exp(Vector3(0.01 * k, -0.015 * k, 0.03 * k)),
              Vector3(0.04 * k, 0.01 * k, 0.03 * k));
}

BodyTurn TurnBetween(int from, int to) {
  return {Matrix3((PoseAt(from).Inverse() * PoseAt(to)).q().toRotationMatrix())};
}

/// Where a ray of frame `from` that meets the wall is seen in frame `to`.
bool Moved(const Camera& camera, const std::array<double, 2>& xy, int from, int to, double uv[2]) {
  const Pose a = PoseAt(from), b = PoseAt(to);
  const Vector3 ray = a.q() * Vector3(xy[0], xy[1], 1.0);
  const Vector3 p_w = Vector3(a.p()) + (4.0 - a.p()[2]) / ray[2] * ray;
  const Vector3 p_c = b.Inverse() * p_w;
  const double seen[2] = {p_c[0] / p_c[2], p_c[1] / p_c[2]};
  return camera.Distort(seen, uv);
}

Status TrackOne(FeatureTracker* tracker, std::int64_t stamp, const Image& image,
                const std::optional<BodyTurn>& turn, TrackerReport* report = nullptr) {
  const ImageView view = image.view();
  return tracker->Track(stamp, {&view, 1}, turn, report);
}

Image Uniform(std::uint8_t grey) {
  Image image = SeeWall(SmallCamera(), Pose());
  std::fill(image.pixels.begin(), image.pixels.end(), grey);
  return image;
}

TEST(FeatureTracker, FeaturesStayOnTheWall) {
  const Camera camera = SmallCamera();
  for (const bool predicted : {true, false}) {
    FeatureTracker tracker({camera}, SmallOptions());
    std::map<std::int64_t, std::pair<int, std::array<double, 2>>> first;
    double squares = 0.0, worst = 0.0;
    int count = 0;
    for (int k = 0; k < 8; ++k) {
      TrackerReport report;
      std::optional<BodyTurn> turn;
      if (predicted && k > 0) turn = TurnBetween(k - 1, k);
      ASSERT_TRUE(TrackOne(&tracker, k * kPeriod,
                           SeeWall(camera, PoseAt(k), 2.0, static_cast<std::uint32_t>(k)), turn,
                           &report)
                      .ok());
      EXPECT_GT(tracker.features().size(), 35u) << k;
      EXPECT_GT(report.tracked, k > 0 ? 25 : -1) << k;
      for (const Feature& f : tracker.features()) {
        const auto known = first.try_emplace(f.track, k, f.xy);
        if (known.second) {
          EXPECT_EQ(f.age, 0);
          continue;
        }
        const auto& [since, xy] = known.first->second;
        EXPECT_EQ(f.age, k - since);
        EXPECT_GT(f.sigma_px, 0.0);
        double uv[2];
        ASSERT_TRUE(Moved(camera, xy, since, k, uv));
        const double error = std::hypot(f.px[0] - uv[0], f.px[1] - uv[1]);
        squares += error * error;
        worst = std::max(worst, error);
        ++count;
      }
    }
    EXPECT_GT(count, 150);
    // The wall comes nearer and turns: patches change, and each step adds to the error.
    EXPECT_LT(std::sqrt(squares / count), 0.4) << "px, over up to 7 frames";
    EXPECT_LT(worst, 2.0);
  }
}

TEST(FeatureTracker, ObservationsAreWithoutDistortion) {
  const Camera camera = SmallCamera();
  FeatureTracker tracker({camera}, SmallOptions());
  ASSERT_TRUE(TrackOne(&tracker, 0, SeeWall(camera, Pose()), {}).ok());
  ASSERT_GT(tracker.features().size(), 35u);
  ASSERT_EQ(tracker.features().size(), tracker.observations().size());
  const WindowCamera window = WithoutDistortion(camera, 1.0);
  for (std::size_t k = 0; k < tracker.features().size(); ++k) {
    const Feature& f = tracker.features()[k];
    const FrameObservation& o = tracker.observations()[k];
    EXPECT_EQ(o.track, f.track);
    const Vector2 xy = window.Normalized(o.u, o.v);
    const double ray[2] = {xy[0], xy[1]};
    double uv[2];
    ASSERT_TRUE(camera.Distort(ray, uv));
    EXPECT_NEAR(uv[0], f.px[0], 1e-9);
    EXPECT_NEAR(uv[1], f.px[1], 1e-9);
  }
}

TEST(FeatureTracker, FeaturesAreSpread) {
  FeatureTracker tracker({SmallCamera()}, SmallOptions());
  ASSERT_TRUE(TrackOne(&tracker, 0, SeeWall(SmallCamera(), Pose()), {}).ok());
  const auto features = tracker.features();
  EXPECT_GT(features.size(), 35u);
  EXPECT_LE(features.size(), 60u);
  for (std::size_t a = 0; a < features.size(); ++a) {
    for (std::size_t b = 0; b < a; ++b) {
      EXPECT_GE(
          std::hypot(features[a].px[0] - features[b].px[0], features[a].px[1] - features[b].px[1]),
          10.0);
    }
  }
}

TEST(FeatureTracker, TheStereoPairSeesTheWallWhereItIs) {
  Camera left = SmallCamera(), right = SmallCamera();
  right.T_b_c.p() = Vector3(0.11, 0.0, 0.0);
  FeatureTracker tracker({left, right}, SmallOptions());
  for (int k = 0; k < 3; ++k) {
    const Image a = SeeWall(left, PoseAt(k), 1.0, 1 + static_cast<std::uint32_t>(k));
    const Image b = SeeWall(right, PoseAt(k) * right.T_b_c, 1.0, 9 + static_cast<std::uint32_t>(k));
    const ImageView views[] = {a.view(), b.view()};
    TrackerReport report;
    ASSERT_TRUE(tracker.Track(k * kPeriod, views, {}, &report).ok());
    EXPECT_GT(report.stereo, 25) << k;
    std::map<std::int64_t, Feature> first;
    for (const Feature& f : tracker.features()) {
      if (f.camera == 0) {
        first[f.track] = f;
        continue;
      }
      const Feature& l = first.at(f.track);
      const Vector3 ray = PoseAt(k).q() * Vector3(l.xy[0], l.xy[1], 1.0);
      const double depth = (4.0 - PoseAt(k).p()[2]) / ray[2];  // of the point, along its z
      EXPECT_NEAR(l.xy[0] - f.xy[0], 0.11 / depth, 0.6 / 180.0);
      EXPECT_NEAR(l.xy[1], f.xy[1], 1.5 / 180.0);
    }
  }
}

TEST(FeatureTracker, OneBlackFrameLosesNoTrack) {
  const Camera camera = SmallCamera();
  for (const int grey : {0, 255, 120}) {
    FeatureTracker tracker({camera}, SmallOptions());
    ASSERT_TRUE(TrackOne(&tracker, 0, SeeWall(camera, PoseAt(0), 1.0, 1), {}).ok());
    const std::vector<Feature> before(tracker.features().begin(), tracker.features().end());
    TrackerReport report;
    ASSERT_TRUE(TrackOne(&tracker, kPeriod, Uniform(static_cast<std::uint8_t>(grey)),
                         TurnBetween(0, 1), &report)
                    .ok());
    EXPECT_TRUE(report[grey == 0     ? TrackerEvent::kImageDark
                       : grey == 255 ? TrackerEvent::kImageBright
                                     : TrackerEvent::kImageFlat]);
    EXPECT_TRUE(tracker.features().empty());
    ASSERT_TRUE(TrackOne(&tracker, 2 * kPeriod, SeeWall(camera, PoseAt(2), 1.0, 2),
                         TurnBetween(1, 2), &report)
                    .ok());
    EXPECT_GT(report.tracked, 25);
    EXPECT_LE(tracker.features()[0].track, before.back().track);
  }
}

TEST(FeatureTracker, AfterALongDarknessItBeginsAnew) {
  const Camera camera = SmallCamera();
  FeatureTracker tracker({camera}, SmallOptions());
  ASSERT_TRUE(TrackOne(&tracker, 0, SeeWall(camera, Pose(), 1.0, 1), {}).ok());
  const std::int64_t last = tracker.features().back().track;
  TrackerReport report;
  bool lost = false;
  for (int k = 1; k <= 10; ++k) {
    ASSERT_TRUE(TrackOne(&tracker, k * kPeriod, Uniform(0), BodyTurn(), &report).ok());
    EXPECT_TRUE(report[TrackerEvent::kImageDark]);
    lost = lost || report[TrackerEvent::kTracksLost];
  }
  EXPECT_TRUE(lost);
  ASSERT_TRUE(
      TrackOne(&tracker, 11 * kPeriod, SeeWall(camera, Pose(), 1.0, 2), BodyTurn(), &report).ok());
  EXPECT_GT(report.detected, 35);
  EXPECT_GT(tracker.features()[0].track, last);
}

TEST(FeatureTracker, ARepeatedImageIsNoObservation) {
  const Camera camera = SmallCamera();
  FeatureTracker tracker({camera}, SmallOptions());
  const Image image = SeeWall(camera, PoseAt(0), 1.0, 1);
  TrackerReport report;
  ASSERT_TRUE(TrackOne(&tracker, 0, image, {}).ok());
  ASSERT_TRUE(TrackOne(&tracker, kPeriod, image, TurnBetween(0, 1), &report).ok());
  EXPECT_TRUE(report[TrackerEvent::kImageRepeated]);
  EXPECT_TRUE(tracker.observations().empty());
  ASSERT_TRUE(TrackOne(&tracker, 2 * kPeriod, SeeWall(camera, PoseAt(2), 1.0, 2), TurnBetween(1, 2),
                       &report)
                  .ok());
  EXPECT_GT(report.tracked, 25);
}

TEST(FeatureTracker, ASecondCameraThatHangsOrIsCoveredIsNamed) {
  Camera left = SmallCamera(), right = SmallCamera();
  right.T_b_c.p() = Vector3(0.11, 0.0, 0.0);
  FeatureTracker tracker({left, right}, SmallOptions());
  const Image hangs = SeeWall(right, PoseAt(0) * right.T_b_c, 1.0, 9);
  const Image black = Uniform(0);
  for (int k = 0; k < 4; ++k) {
    const Image a = SeeWall(left, PoseAt(k), 1.0, 1 + static_cast<std::uint32_t>(k));
    const ImageView views[] = {a.view(), k < 3 ? hangs.view() : black.view()};
    TrackerReport report;
    ASSERT_TRUE(tracker.Track(k * kPeriod, views, {}, &report).ok());
    EXPECT_EQ(report[TrackerEvent::kSecondCameraLost], k > 0) << k;
    EXPECT_EQ(report.stereo > 25, k == 0) << k;
    EXPECT_GT(tracker.features().size(), 35u);
  }
}

TEST(FeatureTracker, ABlurredImageIsNamedAndLosesNoTrack) {
  const Camera camera = SmallCamera();
  FeatureTracker tracker({camera}, SmallOptions());
  ASSERT_TRUE(TrackOne(&tracker, 0, SeeWall(camera, PoseAt(0), 1.0, 1), {}).ok());
  const std::int64_t last = tracker.features().back().track;
  Image blurred = SeeWall(camera, PoseAt(1), 1.0, 2);
  for (int y = 0; y < blurred.height; ++y) {  // 60 px along the rows
    const std::vector<std::uint8_t> row(blurred.pixels.begin() + y * blurred.width,
                                        blurred.pixels.begin() + (y + 1) * blurred.width);
    for (int x = 0; x < blurred.width; ++x) {
      int sum = 0, count = 0;
      for (int i = std::max(0, x - 30); i < std::min(blurred.width, x + 30); ++i, ++count)
        sum += row[static_cast<std::size_t>(i)];
      blurred.pixels[static_cast<std::size_t>(y * blurred.width + x)] =
          static_cast<std::uint8_t>(sum / count);
    }
  }
  TrackerReport report;
  ASSERT_TRUE(TrackOne(&tracker, kPeriod, blurred, TurnBetween(0, 1), &report).ok());
  EXPECT_TRUE(report[TrackerEvent::kImageBlurred]);
  ASSERT_TRUE(TrackOne(&tracker, 2 * kPeriod, SeeWall(camera, PoseAt(2), 1.0, 3), TurnBetween(1, 2),
                       &report)
                  .ok());
  EXPECT_GT(report.tracked, 25);
  EXPECT_LE(tracker.features()[0].track, last);
}

TEST(FeatureTracker, TheSameImagesGiveTheSameBits) {
  const Camera camera = SmallCamera();
  std::vector<double> numbers[2];
  for (auto& list : numbers) {
    FeatureTracker tracker({camera}, SmallOptions());
    for (int k = 0; k < 4; ++k) {
      std::optional<BodyTurn> turn;
      if (k > 0) turn = TurnBetween(k - 1, k);
      ASSERT_TRUE(TrackOne(&tracker, k * kPeriod, SeeWall(camera, PoseAt(k), 3.0, 7), turn).ok());
      for (const FrameObservation& o : tracker.observations())
        list.insert(list.end(), {static_cast<double>(o.track), o.u, o.v});
    }
  }
  EXPECT_EQ(numbers[0], numbers[1]);
}

TEST(FeatureTracker, RefusesAndChangesNothing) {
  const Camera camera = SmallCamera();
  FeatureTracker tracker({camera}, SmallOptions());
  const Image image = SeeWall(camera, Pose(), 1.0, 1);
  ASSERT_TRUE(TrackOne(&tracker, 100, image, {}).ok());
  const std::size_t count = tracker.features().size();
  EXPECT_FALSE(TrackOne(&tracker, 100, image, {}).ok());
  EXPECT_FALSE(TrackOne(&tracker, 50, image, {}).ok());
  Image small = image;
  small.width = 10;
  EXPECT_EQ(TrackOne(&tracker, 200, small, {}).code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(TrackOne(&tracker, 200, Image(), {}).ok());
  EXPECT_FALSE(tracker.Track(200, {}, {}).ok());
  BodyTurn none;
  none.R_from_to *= 2.0;
  EXPECT_FALSE(TrackOne(&tracker, 200, image, none).ok());
  EXPECT_EQ(tracker.features().size(), count);
  EXPECT_EQ(tracker.last_stamp_ns(), 100);

  EXPECT_FALSE(
      TrackOne(std::make_unique<FeatureTracker>(std::vector<Camera>()).get(), 0, image, {}).ok());
  TrackerOptions even;
  even.window_px = 20;
  FeatureTracker wrong({camera}, even);
  EXPECT_EQ(TrackOne(&wrong, 0, image, {}).code(), StatusCode::kInvalidArgument);
  BodyTurn reflection;
  reflection.R_from_to(2, 2) = -1.0;
  EXPECT_FALSE(TrackOne(&tracker, 200, image, reflection).ok());
  // Pairs that are none: in one place, or of two sizes.
  EXPECT_FALSE(FeatureTracker({camera, camera}).Validate().ok());
  Camera other = camera;
  other.T_b_c.p() = Vector3(0.1, 0.0, 0.0);
  EXPECT_TRUE(FeatureTracker({camera, other}).Validate().ok());
  other.width = 200;
  EXPECT_FALSE(FeatureTracker({camera, other}).Validate().ok());
}

}  // namespace
}  // namespace glissade::vision
