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
#include "glissade/io/replay.h"
#include "glissade/window/policy.h"
#include "glissade/window/sliding_window.h"
#include "imu.h"

namespace glissade::python {

namespace {

/// As PyProblem: no two threads at once. Calls that work do so without the interpreter's lock.
class PyWindow {
 public:
  explicit PyWindow(const SlidingWindowOptions& options)
      : window_(options), has_imu_(options.imu_noise.has_value()) {
    Check(options.Validate());
  }
  SlidingWindow& get() {
    if (busy_) {
      throw nb::builtin_exception(nb::exception_type::runtime_error,
                                  "another thread is working on this window");
    }
    return window_;
  }
  [[nodiscard]] bool has_imu() const { return has_imu_; }
  template <class F>
  auto Work(F&& f) {
    SlidingWindow& window = get();
    busy_ = true;
    struct Done {
      std::atomic<bool>& busy;
      ~Done() { busy = false; }
    } done{busy_};
    nb::gil_scoped_release release;
    return f(window);
  }

 private:
  SlidingWindow window_;
  bool has_imu_;
  std::atomic<bool> busy_ = false;
};

OutArray PoseArray(const Pose& T) {
  return Own(std::vector<double>(T.data, T.data + 7), {7});
}

std::vector<FrameObservation> ObservationsFrom(const IndexLike& tracks, const ArrayLike& uv,
                                               const std::optional<IndexLike>& cameras) {
  const Rows pixels(uv, 2, "uv");
  const std::size_t n = tracks.size();
  pixels.Expect(n);
  if (cameras && cameras->size() != n) throw nb::value_error("cameras must be as many as tracks");
  std::vector<FrameObservation> out(n);
  for (std::size_t k = 0; k < n; ++k) {
    out[k].track = tracks.data()[k];
    const std::int64_t camera = cameras ? cameras->data()[k] : 0;
    // What no int holds is no camera: the window counts it as refused.
    out[k].camera = camera >= 0 && camera < 1000 ? static_cast<int>(camera) : -1;
    out[k].u = pixels[k][0];
    out[k].v = pixels[k][1];
  }
  return out;
}

void BindPolicies(nb::module_& m) {
  nb::class_<WindowPolicy>(m, "WindowPolicy", "Which frames stay in a window.");
  nb::class_<OkvisPolicy, WindowPolicy>(m, "OkvisPolicy",
                                        "The newest frames, and keyframes with poses only "
                                        "(Leutenegger et al., IJRR 2015).")
      .def(nb::init<int, int>(), nb::arg("num_frames") = 3, nb::arg("num_keyframes") = 7);
  nb::class_<TwoWayPolicy, WindowPolicy>(m, "TwoWayPolicy",
                                         "Two-way marginalization (Qin, Li, Shen, TRO 2018).")
      .def(nb::init<int>(), nb::arg("num_frames") = 10);
  nb::class_<LeastSeenKeyframePolicy, WindowPolicy>(
      m, "LeastSeenKeyframePolicy",
      "As OKVIS, the least seen keyframe goes (Usenko et al., RA-L "
      "2020).")
      .def(nb::init<int, int, double>(), nb::arg("num_frames") = 3, nb::arg("num_keyframes") = 7,
           nb::arg("min_seen_share") = 0.1);
  nb::class_<FixedLagPolicy, WindowPolicy>(m, "FixedLagPolicy", "The last so many seconds.")
      .def(nb::init<double>(), nb::arg("lag_s") = 1.0);
}

void BindWindowOptions(nb::module_& m) {
  nb::class_<WindowCamera>(m, "WindowCamera", "A pinhole camera on the body, without distortion.")
      .def(
          "__init__",
          [](WindowCamera* self, double fx, double fy, double cx, double cy, double sigma_px,
             const std::optional<ArrayLike>& T_b_c) {
            new (self) WindowCamera{fx, fy, cx, cy, sigma_px, Pose()};
            if (T_b_c) self->T_b_c = PoseFrom(Rows(*T_b_c, 7, "T_body_camera")[0]);
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
      .def_rw("cameras", &Options::cameras)
      .def_rw("imu_noise", &Options::imu_noise, nb::arg().none(),
              "None: no IMU; needs two cameras then")
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
      "A sliding-window estimator: frames, IMU samples and tracked features go in, "
      "the newest state comes out, at bounded cost.\n\n"
      "    window.add_imu(stamps_ns, gyro, accel)   # up to the frame's stamp\n"
      "    window.add_frame(stamp_ns, tracks, uv)\n"
      "    window.optimize()\n"
      "    if window.running: use(window.newest)")
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
            state.T_w_b = PoseFrom(Rows(pose, 7, "pose")[0]);
            std::copy_n(Rows(speed_bias, 9, "speed_bias")[0], 9, state.speed_bias.Data());
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

  nb::class_<Viotracks>(m, "Viotracks", "A recording with feature tracks (read_viotracks).")
      .def_ro("origin", &Viotracks::origin)
      .def_prop_ro("cameras", [](const Viotracks& r) { return WindowCameras(r); })
      .def_prop_ro("imu_noise", [](const Viotracks& r) { return r.imu_noise; })
      .def_prop_ro(
          "gravity", [](const Viotracks& r) { return r.gravity.norm(); }, "m/s^2")
      .def_prop_ro(
          "imu", [](const Viotracks& r) { return ArraysOf(r.imu); },
          nb::sig("def imu(self) -> tuple[numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.float64], "
                  "numpy.typing.NDArray[numpy.float64]]"),
          "stamps_ns, gyro, accel")
      .def_prop_ro("frame_stamps_ns",
                   [](const Viotracks& r) {
                     std::vector<std::int64_t> stamps;
                     for (const ViotracksFrame& f : r.frames)
                       stamps.push_back(f.stamp_ns);
                     return Own(std::move(stamps));
                   })
      .def_prop_ro(
          "ground_truth",
          [](const Viotracks& r) {
            std::vector<std::int64_t> stamps;
            std::vector<double> poses;
            for (const GroundTruthState& s : r.ground_truth) {
              stamps.push_back(s.stamp_ns);
              poses.insert(poses.end(), s.T_w_b.data, s.T_w_b.data + 7);
            }
            const std::size_t n = stamps.size();
            return nb::make_tuple(Own(std::move(stamps)), Own(std::move(poses), {n, 7}));
          },
          nb::sig("def ground_truth(self) -> tuple[numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.float64]]"),
          "stamps_ns, poses (n, 7)")
      .def(
          "observations",
          [](const Viotracks& r, std::int64_t frame) {
            std::vector<std::int64_t> tracks, cameras;
            std::vector<double> uv;
            for (const ViotracksObservation& o : r.tracks) {
              if (o.frame != frame) continue;
              tracks.push_back(o.track);
              cameras.push_back(o.camera);
              uv.push_back(o.u);
              uv.push_back(o.v);
            }
            const std::size_t n = tracks.size();
            return nb::make_tuple(Own(std::move(tracks)), Own(std::move(uv), {n, 2}),
                                  Own(std::move(cameras)));
          },
          nb::arg("frame"),
          nb::sig("def observations(self, frame: int) -> tuple[numpy.typing.NDArray[numpy.int64], "
                  "numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.int64]]"),
          "What frame k shows: tracks, uv (n, 2) [px], cameras.")
      .def(
          "options",
          [](const Viotracks& r, std::size_t num_cameras) {
            SlidingWindowOptions options;
            options.cameras = WindowCameras(r, num_cameras);
            options.imu_noise = r.imu_noise;
            options.gravity = r.gravity.norm();
            return options;
          },
          nb::arg("num_cameras") = 1000, "Options of a SlidingWindow for this recording.");
  m.def(
      "read_viotracks", [](const std::string& folder) { return Unwrap(ReadViotracks(folder)); },
      nb::arg("folder"), "Reads a VIOTRACKS folder.");
  m.def(
      "replay",
      [](const Viotracks& recording, PyWindow& window, nb::object callback) {
        ViotracksReplay replay(recording);
        std::vector<std::int64_t> stamps;
        std::vector<double> poses;
        while (replay.Next()) {
          const Status status = window.Work([&](SlidingWindow& w) {
            (void)w.AddImu(replay.imu());
            if (!w.AddFrame(replay.stamp_ns(), replay.observations()).ok()) return Status();
            return w.Optimize();
          });
          if (PyErr_CheckSignals() != 0) throw nb::python_error();
          Check(status);
          SlidingWindow& w = window.get();
          if (w.phase() != WindowPhase::kRunning) continue;
          stamps.push_back(w.newest().stamp_ns);
          poses.insert(poses.end(), w.newest().T_w_b.data, w.newest().T_w_b.data + 7);
          if (!callback.is_none() && callback(nb::cast(w.newest())).is(nb::bool_(false))) break;
        }
        const std::size_t n = stamps.size();
        return nb::make_tuple(Own(std::move(stamps)), Own(std::move(poses), {n, 7}));
      },
      nb::arg("recording"), nb::arg("window"), nb::arg("callback") = nb::none(),
      nb::sig("def replay(recording: Viotracks, window: SlidingWindow, callback: "
              "collections.abc.Callable[[WindowState], bool | None] | None = None) -> "
              "tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64]]"),
      "Hands a recording to a window in the order of time.\n\nReturns the newest state after "
      "every frame: stamps_ns (n,), poses (n, 7). callback: called with each, stops by returning "
      "False.");
}

}  // namespace glissade::python
