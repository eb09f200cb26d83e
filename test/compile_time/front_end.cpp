// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// A front end: a recording from a folder, keyframes with IMU and two cameras, a solve and a
// marginalization for each, the last window to a file. Its tracks are what the recording says.
#include <glissade/glissade.h>
#include <glissade/io/viotracks.h>
#include <glissade/io/viowin.h>

#include <cstdio>
#include <deque>
#include <map>
#include <vector>

using namespace glissade;

namespace {

struct Keyframe {
  std::int64_t stamp_ns = 0;
  VertexHandle<VertexPose> pose;
  VertexHandle<VertexSpeedBias> speed_bias;
};

struct Track {
  Keyframe host;
  Vector2 uv = Vector2::Zero();
  VertexHandle<VertexInverseDepth> depth;
};

class FrontEnd {
 public:
  explicit FrontEnd(const Viotracks& recording) : recording_(recording) {}

  Status Run() {
    if (recording_.cameras.size() < 2 || !recording_.imu_noise || recording_.ground_truth.empty()) {
      return {StatusCode::kInvalidArgument, "no stereo recording with an IMU and a start"};
    }
    for (const ImuSample& sample : recording_.imu) {
      if (Status s = buffer_.Add(sample); !s.ok()) std::printf("%s\n", s.message().c_str());
    }
    problem_.SetFirstEstimates(FirstEstimates::kFull);
    for (std::size_t k = 0; k < recording_.frames.size(); ++k) {
      if (Status s = AddKeyframe(k); !s.ok()) return s;
      if (Status s = Observe(static_cast<std::int32_t>(k)); !s.ok()) return s;
      const SolveSummary& summary = problem_.Solve({.max_iterations = 8});
      if (!summary.ok()) return summary.status;
      std::printf("%s\n", summary.BriefReport().c_str());
      for (const AnyEdge outlier : problem_.GetOutlierEdges()) {
        if (Status s = problem_.RemoveEdge(outlier); !s.ok()) return s;
      }
      if (Status s = DropOldest(); !s.ok()) return s;
    }
    return {};
  }

  Status Write(const std::string& path) const {
    ViowinWindow window;
    window.T_b_c = recording_.cameras[0].T_b_c;
    for (const Keyframe& frame : window_) {
      ViowinKeyframe written;
      written.T_w_b = problem_.Get(frame.pose).pose;
      written.speed_bias = problem_.Get(frame.speed_bias);
      window.keyframes.push_back(written);
    }
    window.ground_truth = window.keyframes;
    return WriteViowin({window}, path);
  }

 private:
  Status AddKeyframe(std::size_t k) {
    Keyframe frame;
    frame.stamp_ns = recording_.frames[k].stamp_ns;
    if (window_.empty()) {
      const GroundTruthState& start = recording_.ground_truth.front();
      frame.pose = problem_.AddVertex(VertexPose{start.T_w_b});
      frame.speed_bias = problem_.AddVertex(start.speed_bias.value_or(VertexSpeedBias{}));
      EdgeSE3Prior prior;
      prior.T_w_b = start.T_w_b;
      const auto added = problem_.AddEdge(
          prior, {frame.pose},
          {.sqrt_information = SquareMatrix<6>(1e3 * SquareMatrix<6>::Identity())});
      if (!added.ok()) return added.status();
      const auto slow = problem_.AddEdge(EdgeSpeedBiasPrior{}, {frame.speed_bias});
      if (!slow.ok()) return slow.status();
    } else {
      const Keyframe& last = window_.back();
      const VertexSpeedBias& speed_bias = problem_.Get(last.speed_bias);
      ImuInterval interval;
      Status s = buffer_.Between(last.stamp_ns, frame.stamp_ns, &interval);
      if (!s.ok()) return s;
      const ImuBias bias{Vector3(speed_bias.ba()), Vector3(speed_bias.bg())};
      const auto integral = Preintegrate(interval.samples, bias, *recording_.imu_noise);
      if (!integral.ok()) return integral.status();
      const auto factor = MakeImuFactor(*integral);
      if (!factor.ok()) return factor.status();
      const ImuPrediction predicted = Predict(factor->edge, problem_.Get(last.pose), speed_bias);
      frame.pose = problem_.AddVertex(predicted.pose);
      frame.speed_bias = problem_.AddVertex(predicted.speed_bias);
      const auto added =
          problem_.AddEdge(factor->edge, {last.pose, last.speed_bias, frame.pose, frame.speed_bias},
                           factor->options);
      if (!added.ok()) return added.status();
    }
    window_.push_back(frame);
    return {};
  }

  Status Observe(std::int32_t k) {
    const Keyframe& frame = window_.back();
    for (const ViotracksObservation& o : recording_.tracks) {
      if (o.frame != k) continue;
      const ViotracksCamera& camera = recording_.cameras[static_cast<std::size_t>(o.camera)];
      const Vector2 uv((o.u - camera.cx) / camera.fx, (o.v - camera.cy) / camera.fy);
      const Matrix2 weight = Vector2(camera.fx, camera.fy).asDiagonal() * (1.0 / camera.sigma_px);
      Track& track = tracks_[o.track];
      if (!problem_.Contains(track.depth)) {
        if (o.camera == 0) track = {frame, uv, problem_.AddVertex(VertexInverseDepth{0.2})};
        continue;
      }
      const Pose& T_b_host = recording_.cameras[0].T_b_c;
      Status s;
      if (o.camera == 0) {
        s = problem_
                .AddEdge(EdgeReprojection{track.uv, uv, T_b_host},
                         {track.host.pose, frame.pose, track.depth},
                         {.sqrt_information = weight, .loss = Huber{2.0}})
                .status();
      } else if (track.host.pose == frame.pose) {
        s = problem_
                .AddEdge(EdgeReprojectionStereoSame{track.uv, uv, T_b_host, camera.T_b_c},
                         {track.depth}, {.sqrt_information = weight, .loss = Huber{2.0}})
                .status();
      } else {
        s = problem_
                .AddEdge(EdgeReprojectionStereo{track.uv, uv, T_b_host, camera.T_b_c},
                         {track.host.pose, frame.pose, track.depth},
                         {.sqrt_information = weight, .loss = Cauchy{2.0}})
                .status();
      }
      if (!s.ok()) return s;
    }
    return {};
  }

  Status DropOldest() {
    if (window_.size() < 10) return {};
    std::vector<AnyVertex> going = {window_.front().pose, window_.front().speed_bias};
    for (const auto& [id, track] : tracks_) {
      if (track.host.pose == window_.front().pose && problem_.Contains(track.depth))
        going.emplace_back(track.depth);
    }
    const auto prior = problem_.Marginalize(going);
    if (!prior.ok()) return prior.status();
    window_.pop_front();
    const auto covariance = problem_.ComputeCovariance(std::vector<AnyVertex>{window_.back().pose});
    if (!covariance.ok()) return covariance.status();
    const auto nullspace = problem_.CheckNullspace();
    return nullspace.ok() ? Status() : nullspace.status();
  }

  const Viotracks& recording_;
  ImuBuffer buffer_;
  Problem problem_;
  std::deque<Keyframe> window_;
  std::map<std::int32_t, Track> tracks_;
};

}  // namespace

int main(int argc, char** argv) {
  if (argc != 3) return 2;
  const auto recording = ReadViotracks(argv[1]);
  if (!recording.ok()) return 1;
  FrontEnd front_end(*recording);
  Status status = front_end.Run();
  if (status.ok()) status = front_end.Write(argv[2]);
  std::printf("%s\n", status.message().c_str());
  return status.ok() ? 0 : 1;
}
