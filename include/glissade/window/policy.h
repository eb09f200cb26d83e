// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/window/view.h"

namespace glissade {

/// What is to leave a window. Indices are those of the view that the policy was shown.
struct WindowPlan {
  /// Frames of which pose, and speed and biases where they are still there, go into the prior.
  std::vector<int> marginalize_frames;
  /// Frames of which only speed and biases go into the prior.
  std::vector<int> marginalize_speed_biases;
  /// Frames that go without a trace: their observations are lost, the IMU terms before, between and
  /// after neighbours become one. A frame that a prior knows, or the newest, cannot go like this;
  /// it is marginalized without its observations.
  std::vector<int> drop_frames;
  /// Landmarks that go into the prior with all their observations but those in dropped frames. Of
  /// landmarks that stay, observations in frames that go are lost: kept, they would tie the
  /// landmark to the prior for ever.
  std::vector<int> marginalize_landmarks;

  void Clear() {
    marginalize_frames.clear();
    marginalize_speed_biases.clear();
    drop_frames.clear();
    marginalize_landmarks.clear();
  }
};

/// A rule for what leaves the window after each solve.
class WindowPolicy {
 public:
  virtual ~WindowPolicy() = default;
  /// The plan is empty when it is called.
  virtual void Decide(const WindowView& window, WindowPlan* plan) = 0;
};

/// The strategy of OKVIS (Leutenegger et al., "Keyframe-based visual-inertial odometry using
/// nonlinear optimization", IJRR 2015, Sec. 3.4): the newest frames with speed and biases, and some
/// keyframes with poses only. Speed and biases of a frame that is no longer among the newest are
/// marginalized; then, if it is no keyframe, its pose, without its observations. When there are too
/// many keyframes the oldest is marginalized with the landmarks that no frame from the newest of
/// the older frames on sees.
class OkvisPolicy : public WindowPolicy {
 public:
  explicit OkvisPolicy(int num_frames = 3, int num_keyframes = 7)
      : num_frames_(num_frames), num_keyframes_(num_keyframes) {}
  void Decide(const WindowView& window, WindowPlan* plan) override;

 private:
  int num_frames_, num_keyframes_;
};

/// The two-way marginalization of VINS-Mono (Qin, Li, Shen, TRO 2018, Sec. V-C): where the frame
/// before the newest is no keyframe, it is dropped and the IMU terms on its sides become one; else
/// the oldest frame is marginalized, with the landmarks first seen there.
class TwoWayPolicy : public WindowPolicy {
 public:
  explicit TwoWayPolicy(int num_frames = 10) : num_frames_(num_frames) {}
  void Decide(const WindowView& window, WindowPlan* plan) override;

 private:
  int num_frames_;
};

/// The strategy of Basalt (Usenko et al., RA-L 2020): as OKVIS, but the keyframe that goes is the
/// one with the smallest part of its landmarks still seen, if that is under a limit, else the one
/// that lies worst: crowded by others and far from the newest (Engel, Koltun, Cremers, "Direct
/// Sparse Odometry", TPAMI 2018, Eq. 20).
class LeastSeenKeyframePolicy : public WindowPolicy {
 public:
  explicit LeastSeenKeyframePolicy(int num_frames = 3, int num_keyframes = 7,
                                   double min_seen_share = 0.1)
      : num_frames_(num_frames), num_keyframes_(num_keyframes), min_seen_share_(min_seen_share) {}
  void Decide(const WindowView& window, WindowPlan* plan) override;

 private:
  int num_frames_, num_keyframes_;
  double min_seen_share_;
};

/// The last so many seconds: frames older than that are marginalized with all landmarks they see.
class FixedLagPolicy : public WindowPolicy {
 public:
  explicit FixedLagPolicy(double lag_s = 1.0) : lag_s_(lag_s) {}
  void Decide(const WindowView& window, WindowPlan* plan) override;

 private:
  double lag_s_;
};

}  // namespace glissade
