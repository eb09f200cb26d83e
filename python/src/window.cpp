// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/shared_ptr.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <atomic>
#include <limits>
#include <memory>
#include <optional>

#include "add_edges.h"
#include "arrays.h"
#include "errors.h"
#include "glissade/window/policy.h"
#include "glissade/window/sliding_window.h"
#include "imu.h"
#include "window.h"

namespace glissade::python {

namespace {

OutArray PoseArray(const Pose& T) {
  return Own(std::vector<double>(T.data, T.data + 7), {7});
}

std::vector<FrameObservation> ObservationsFrom(const IndexLike& tracks, const ArrayLike& uv,
                                               const std::optional<IndexLike>& cameras) {
  const Rows pixels(uv, 2, "uv");
  const Integers track(tracks, "tracks");
  const std::size_t n = track.size();
  pixels.Expect(n);
  std::optional<Integers> camera_of;
  if (cameras) camera_of.emplace(*cameras, "cameras");
  if (cameras && camera_of->size() != n) throw nb::value_error("cameras must be as many as tracks");
  std::vector<FrameObservation> out(n);
  for (std::size_t k = 0; k < n; ++k) {
    out[k].track = track.data()[k];
    const std::int64_t camera = cameras ? camera_of->data()[k] : 0;
    // What no int holds is no camera: the window counts it as refused.
    out[k].camera = camera >= 0 && camera < 1000 ? static_cast<int>(camera) : -1;
    out[k].u = pixels[k][0];
    out[k].v = pixels[k][1];
  }
  return out;
}

int AtLeast(int number, int least, const char* name) {
  if (number >= least) return number;
  throw nb::value_error(std::string(name)
                            .append(" must be ")
                            .append(std::to_string(least))
                            .append(" or more")
                            .c_str());
}

void BindPolicies(nb::module_& m) {
  nb::class_<WindowPolicy>(m, "WindowPolicy", "Which frames stay in a window.");
  nb::class_<OkvisPolicy, WindowPolicy>(
      m, "OkvisPolicy",
      "The newest frames, and keyframes with poses only (Leutenegger et al., IJRR 2015).")
      .def(
          "__init__",
          [](OkvisPolicy* self, int frames, int keyframes) {
            new (self) OkvisPolicy(AtLeast(frames, 2, "num_frames"),
                                   AtLeast(keyframes, 1, "num_keyframes"));
          },
          nb::arg("num_frames") = 3, nb::arg("num_keyframes") = 7);
  nb::class_<TwoWayPolicy, WindowPolicy>(m, "TwoWayPolicy",
                                         "Two-way marginalization (Qin, Li, Shen, TRO 2018).")
      .def(
          "__init__",
          [](TwoWayPolicy* self, int frames) {
            new (self) TwoWayPolicy(AtLeast(frames, 3, "num_frames"));
          },
          nb::arg("num_frames") = 10);
  nb::class_<LeastSeenKeyframePolicy, WindowPolicy>(
      m, "LeastSeenKeyframePolicy",
      "As OKVIS, the least seen keyframe goes (Usenko et al., RA-L 2020).")
      .def(
          "__init__",
          [](LeastSeenKeyframePolicy* self, int frames, int keyframes, double share) {
            if (!(share >= 0.0 && share <= 1.0)) {
              throw nb::value_error("min_seen_share must be from 0 to 1");
            }
            new (self) LeastSeenKeyframePolicy(AtLeast(frames, 2, "num_frames"),
                                               AtLeast(keyframes, 1, "num_keyframes"), share);
          },
          nb::arg("num_frames") = 3, nb::arg("num_keyframes") = 7, nb::arg("min_seen_share") = 0.1);
  nb::class_<FixedLagPolicy, WindowPolicy>(m, "FixedLagPolicy", "The last so many seconds.")
      .def(
          "__init__",
          [](FixedLagPolicy* self, double lag) {
            if (!(lag > 0.0)) throw nb::value_error("lag_s must be > 0");
            new (self) FixedLagPolicy(lag);
          },
          nb::arg("lag_s") = 1.0);
}

void BindWindowOptions(nb::module_& m) {
  nb::class_<WindowCamera>(m, "WindowCamera", "A pinhole camera on the body, without distortion.")
      .def(
          "__init__",
          [](WindowCamera* self, double fx, double fy, double cx, double cy, double sigma_px,
             const std::optional<ArrayLike>& T_b_c) {
            new (self) WindowCamera{fx, fy, cx, cy, sigma_px, Pose()};
            if (T_b_c) self->T_b_c = PoseFrom(OneRow(*T_b_c, 7, "T_body_camera").data());
          },
          nb::arg("fx") = 1.0, nb::arg("fy") = 1.0, nb::arg("cx") = 0.0, nb::arg("cy") = 0.0,
          nb::arg("sigma_px") = 1.0, nb::arg("T_body_camera") = nb::none())
      .def_rw("fx", &WindowCamera::fx)
      .def_rw("fy", &WindowCamera::fy)
      .def_rw("cx", &WindowCamera::cx)
      .def_rw("cy", &WindowCamera::cy)
      .def_rw("sigma_px", &WindowCamera::sigma_px)
      .def_prop_ro("T_body_camera", [](const WindowCamera& c) { return PoseArray(c.T_b_c); });
  using Options = SlidingWindowOptions;
  nb::class_<Options>(m, "SlidingWindowOptions", "What a SlidingWindow is told once.")
      .def(nb::init<>())
      .def_prop_rw(
          "cameras", [](const Options& o) { return o.cameras; },
          [](Options& o, const std::vector<WindowCamera>& cameras) { o.cameras = cameras; },
          "A list: assign it, what is read are copies.")
      .def_prop_rw(
          "imu_noise", [](const Options& o) { return o.imu_noise; },
          [](Options& o, const std::optional<ImuNoise>& noise) { o.imu_noise = noise; },
          nb::arg("noise").none(), "None: no IMU; needs two cameras then. What is read is a copy.")
      .def_rw("gravity", &Options::gravity, "m/s^2; the world's z axis points up")
      .def_rw("policy", &Options::policy, nb::arg().none(), "which frames stay")
      .def_rw("first_estimates", &Options::first_estimates)
      .def_rw("loss", &Options::loss)
      .def_rw("max_chi2", &Options::max_chi2)
      .def_rw("cost_tolerance", &Options::cost_tolerance)
      .def_rw("min_observations", &Options::min_observations)
      .def_rw("use_stillness", &Options::use_stillness);
  nb::enum_<WindowPhase>(m, "WindowPhase", "Of a SlidingWindow.")
      .value("INITIALIZING", WindowPhase::kInitializing)
      .value("RUNNING", WindowPhase::kRunning);
  nb::enum_<KeyframeChoice>(m, "KeyframeChoice", "Who decides about a keyframe.")
      .value("BY_RULES", KeyframeChoice::kByRules)
      .value("YES", KeyframeChoice::kYes)
      .value("NO", KeyframeChoice::kNo);
}

nb::dict Counts(const WindowEventCounts& counts) {
  nb::dict d;
  for (std::size_t k = 0; k < kNumWindowEvents; ++k) {
    const auto name = ToString(static_cast<WindowEvent>(k));
    d[nb::str(name.data(), name.size())] = counts.count[k];
  }
  return d;
}

}  // namespace

void BindWindow(nb::module_& m) {
  BindPolicies(m);
  BindWindowOptions(m);
  nb::class_<WindowState>(m, "WindowState", "The newest state.")
      .def_ro("stamp_ns", &WindowState::stamp_ns)
      .def_prop_ro(
          "pose", [](const WindowState& s) { return PoseArray(s.T_w_b); }, "T_world_body, (7,)")
      .def_prop_ro(
          "speed_bias",
          [](const WindowState& s) {
            return Own(std::vector<double>(s.speed_bias.Data(), s.speed_bias.Data() + 9), {9});
          },
          "(9,): velocity, accelerometer bias, gyroscope bias; zero without an IMU");
  nb::class_<PyWindow>(
      m, "SlidingWindow",
      "A sliding-window estimator: frames, IMU samples and tracked features go in, the newest "
      "state comes out, at bounded cost.\n\n    window.add_imu(stamps_ns, gyro, accel)   # up to "
      "the frame's stamp\n    window.add_frame(stamp_ns, tracks, uv)\n    window.optimize()\n    "
      "if window.running: use(window.newest)")
      .def(nb::init<const SlidingWindowOptions&>(), nb::arg("options"))
      .def(
          "add_imu",
          [](PyWindow& w, const IndexLike& stamps, const ArrayLike& gyro, const ArrayLike& accel) {
            const auto samples = SamplesFrom(stamps, gyro, accel);
            Check(w.Work([&](SlidingWindow& x) { return x.AddImu(samples); }));
          },
          nb::arg("stamps_ns"), nb::arg("gyro"), nb::arg("accel"),
          "Takes all samples that make sense; raises for the first that does not.\n\nstamps_ns: "
          "(n,). gyro: (n, 3) [rad/s]. accel: (n, 3), specific force [m/s^2].")
      .def(
          "add_frame",
          [](PyWindow& w, std::int64_t stamp_ns, const IndexLike& tracks, const ArrayLike& uv,
             const std::optional<IndexLike>& cameras, KeyframeChoice keyframe) {
            const auto seen = ObservationsFrom(tracks, uv, cameras);
            Check(w.Work([&](SlidingWindow& x) { return x.AddFrame(stamp_ns, seen, keyframe); }));
          },
          nb::arg("stamp_ns"), nb::arg("tracks"), nb::arg("uv"), nb::arg("cameras") = nb::none(),
          nb::arg("keyframe") = KeyframeChoice::kByRules,
          "A frame later than the last one.\n\ntracks: (n,) the same number in all images that "
          "show the same point. uv: (n, 2), undistorted pixels. cameras: (n,), 0 where not given.")
      .def(
          "optimize",
          [](PyWindow& w, int max_iterations, double max_time_s) {
            Check(w.Work([&](SlidingWindow& x) {
              return x.Optimize({max_iterations, max_time_s});
            }));
          },
          nb::arg("max_iterations") = WindowBudget().max_iterations,
          nb::arg("max_time_s") = std::numeric_limits<double>::infinity(),
          "Solves, takes outliers out, slides.")
      .def(
          "start",
          [](PyWindow& w, std::int64_t stamp_ns, const ArrayLike& pose, const ArrayLike& speed_bias,
             double tilt, double speed, double accel_bias, double gyro_bias) {
            WindowState state;
            state.stamp_ns = stamp_ns;
            state.T_w_b = PoseFrom(OneRow(pose, 7, "pose").data());
            std::copy_n(OneRow(speed_bias, 9, "speed_bias").data(), 9, state.speed_bias.Data());
            Check(w.get().Start(state, {tilt, speed, accel_bias, gyro_bias}));
          },
          nb::arg("stamp_ns"), nb::arg("pose"), nb::arg("speed_bias"), nb::kw_only(),
          nb::arg("tilt_sigma") = InitialSigmas().tilt,
          nb::arg("speed_sigma") = InitialSigmas().speed,
          nb::arg("accel_bias_sigma") = InitialSigmas().accel_bias,
          nb::arg("gyro_bias_sigma") = InitialSigmas().gyro_bias,
          "Begins at a state that is known, with standard deviations of each coordinate.")
      .def(
          "reset", [](PyWindow& w) { Check(w.get().Reset()); },
          "Begins anew at the newest state, without landmarks and prior.")
      .def_prop_ro("phase", [](PyWindow& w) { return w.get().phase(); })
      .def_prop_ro("running", [](PyWindow& w) { return w.get().phase() == WindowPhase::kRunning; })
      .def_prop_ro("newest", [](PyWindow& w) { return WindowState(w.get().newest()); })
      .def_prop_ro("initial_scale_sigma", [](PyWindow& w) { return w.get().initial_scale_sigma(); })
      .def_prop_ro(
          "poses",
          [](PyWindow& w) {
            std::vector<double> poses;
            for (const WindowFrame& f : w.get().view().frames)
              poses.insert(poses.end(), f.T_w_b.data, f.T_w_b.data + 7);
            const std::size_t n = poses.size() / 7;
            return Own(std::move(poses), {n, 7});
          },
          "Of the frames in the window, oldest first: (n, 7).")
      .def_prop_ro(
          "points",
          [](PyWindow& w) {
            std::vector<double> points;
            const auto& window = w.get();
            for (const WindowLandmark& l : window.view().landmarks) {
              if (!l.InGraph()) continue;
              const double* x = window.problem().Get(l.point).Data();
              points.insert(points.end(), x, x + 3);
            }
            const std::size_t n = points.size() / 3;
            return Own(std::move(points), {n, 3});
          },
          "Landmarks in the window: (n, 3) [m].")
      .def(
          "covariance",
          [](PyWindow& w) {
            const std::size_t n = w.has_imu() ? 15 : 6;
            std::vector<double> covariance(n * n);
            Check(w.Work([&](SlidingWindow& x) { return x.NewestCovariance(covariance); }));
            return Own(std::move(covariance), {n, n});
          },
          "Of the newest state, (15, 15): pose [dp, dtheta], velocity, biases; (6, 6) without an "
          "IMU. Position and yaw of the window's oldest frame are certain.")
      .def(
          "events", [](PyWindow& w) { return Counts(w.get().total_events()); },
          nb::sig("def events(self) -> dict[str, int]"), "How often what happened.");
  BindViotracks(m);
}

}  // namespace glissade::python
