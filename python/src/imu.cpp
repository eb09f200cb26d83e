// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "imu.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <array>
#include <optional>

#include "add_edges.h"
#include "errors.h"
#include "glissade/imu/buffer.h"
#include "glissade/imu/imu_factor.h"
#include "glissade/imu/preintegration.h"
#include "problem.h"

namespace glissade::python {

std::vector<ImuSample> SamplesFrom(const IndexLike& stamps_ns, const ArrayLike& gyro,
                                   const ArrayLike& accel) {
  const Rows rates(gyro, 3, "gyro"), forces(accel, 3, "accel");
  const Integers stamps(stamps_ns, "stamps_ns");
  const std::size_t n = stamps.size();
  rates.Expect(n);
  forces.Expect(n);
  std::vector<ImuSample> samples(n);
  for (std::size_t k = 0; k < n; ++k) {
    samples[k].stamp_ns = stamps.data()[k];
    std::copy_n(rates[k], 3, samples[k].gyro.data());
    std::copy_n(forces[k], 3, samples[k].accel.data());
  }
  return samples;
}

nb::tuple ArraysOf(std::span<const ImuSample> samples) {
  std::vector<std::int64_t> stamps;
  std::vector<double> gyro, accel;
  stamps.reserve(samples.size());
  gyro.reserve(3 * samples.size());
  accel.reserve(3 * samples.size());
  for (const ImuSample& s : samples) {
    stamps.push_back(s.stamp_ns);
    gyro.insert(gyro.end(), s.gyro.data(), s.gyro.data() + 3);
    accel.insert(accel.end(), s.accel.data(), s.accel.data() + 3);
  }
  const std::size_t n = samples.size();
  return nb::make_tuple(Own(std::move(stamps)), Own(std::move(gyro), {n, 3}),
                        Own(std::move(accel), {n, 3}));
}

namespace {

ImuBias BiasFrom(const std::optional<ArrayLike>& accel_bias,
                 const std::optional<ArrayLike>& gyro_bias) {
  ImuBias bias;
  if (accel_bias) std::copy_n(OneRow(*accel_bias, 3, "accel_bias").data(), 3, bias.ba.data());
  if (gyro_bias) std::copy_n(OneRow(*gyro_bias, 3, "gyro_bias").data(), 3, bias.bg.data());
  return bias;
}

OutArray Vector3Of(const Vector3& x) {
  return Own({x[0], x[1], x[2]}, {3});
}

void BindNoise(nb::module_& m) {
  nb::enum_<ImuGaps>(m, "ImuGaps", "What preintegration does where readings are missing.")
      .value("INFLATE", ImuGaps::kInflate)
      .value("REFUSE", ImuGaps::kRefuse);
  nb::class_<ImuNoise>(m, "ImuNoise",
                       "Noise of an IMU in continuous time, as data sheets and Kalibr give it.")
      .def(
          "__init__",
          [](ImuNoise* self, double gyro, double accel, double gyro_walk, double accel_walk) {
            new (self) ImuNoise{gyro, accel, gyro_walk, accel_walk};
          },
          nb::arg("gyro_noise_density") = ImuNoise().gyro_noise_density,
          nb::arg("accel_noise_density") = ImuNoise().accel_noise_density,
          nb::arg("gyro_random_walk") = ImuNoise().gyro_random_walk,
          nb::arg("accel_random_walk") = ImuNoise().accel_random_walk)
      .def_rw("gyro_noise_density", &ImuNoise::gyro_noise_density, "rad/s/sqrt(Hz)")
      .def_rw("accel_noise_density", &ImuNoise::accel_noise_density, "m/s^2/sqrt(Hz)")
      .def_rw("gyro_random_walk", &ImuNoise::gyro_random_walk, "rad/s^2/sqrt(Hz)")
      .def_rw("accel_random_walk", &ImuNoise::accel_random_walk, "m/s^3/sqrt(Hz)")
      .def_rw("saturation_inflation", &ImuNoise::saturation_inflation)
      .def_rw("max_gap_ns", &ImuNoise::max_gap_ns)
      .def_rw("gaps", &ImuNoise::gaps)
      .def_rw("gap_gyro_walk", &ImuNoise::gap_gyro_walk, "rad/s/sqrt(s)")
      .def_rw("gap_accel_walk", &ImuNoise::gap_accel_walk, "m/s^2/sqrt(s)");
}

EdgeArray AddImu(PyProblem& p, const VertexArray& pose_i, const VertexArray& sb_i,
                 const VertexArray& pose_j, const VertexArray& sb_j,
                 const std::vector<ImuPreintegration>& intervals, const ArrayLike& gravity,
                 const Loss& loss) {
  const std::array<NamedVertices, 4> vertices = {
      {{&pose_i, "pose_i"}, {&sb_i, "speed_bias_i"}, {&pose_j, "pose_j"}, {&sb_j, "speed_bias_j"}}};
  const Rows g(gravity, 3, "gravity");
  g.Expect(1);
  const std::size_t n = NumEdges(vertices, intervals.size());
  if (intervals.size() != n) throw nb::value_error("an interval is needed for each edge");
  std::vector<EdgeImu> edges;
  std::vector<double> weights;
  for (const ImuPreintegration& interval : intervals) {
    ImuFactor factor = Unwrap(MakeImuFactor(interval));
    std::copy_n(g[0], 3, factor.edge.gravity.data());
    edges.push_back(factor.edge);
    const auto& U = *factor.options.sqrt_information;
    for (int r = 0; r < 15; ++r) {
      for (int c = 0; c < 15; ++c)
        weights.push_back(U(r, c));
    }
  }
  Weights each(std::nullopt, std::nullopt, 15, n);
  each.SetSqrt(std::move(weights));
  return AddEdges<EdgeImu>(p, n, vertices, each, loss, [&](std::size_t k) { return edges[k]; });
}

}  // namespace

void BindImu(nb::module_& m) {
  BindNoise(m);
  nb::class_<ImuPreintegration>(m, "ImuPreintegration",
                                "What is known about an interval from its IMU samples alone, in "
                                "axes of the body at its beginning (Forster et al., TRO 2017).")
      .def_prop_ro(
          "dt", [](const ImuPreintegration& x) { return x.imu.dt; }, "s")
      .def_prop_ro(
          "dp", [](const ImuPreintegration& x) { return Vector3Of(x.imu.dp); }, "(3,) m")
      .def_prop_ro(
          "dq",
          [](const ImuPreintegration& x) {
            const auto& q = x.imu.dq;
            return Own({q.x(), q.y(), q.z(), q.w()}, {4});
          },
          "(4,) x y z w")
      .def_prop_ro(
          "dv", [](const ImuPreintegration& x) { return Vector3Of(x.imu.dv); }, "(3,) m/s")
      .def_prop_ro(
          "covariance",
          [](const ImuPreintegration& x) {
            std::vector<double> c;
            for (int i = 0; i < 15; ++i) {
              for (int j = 0; j < 15; ++j)
                c.push_back(x.covariance(i, j));
            }
            return Own(std::move(c), {15, 15});
          },
          "(15, 15), order p, theta, v, ba, bg")
      .def_prop_ro("num_gaps", [](const ImuPreintegration& x) { return x.gaps.count; })
      .def(
          "predict",
          [](const ImuPreintegration& x, const ArrayLike& pose, const ArrayLike& speed_bias,
             const ArrayLike& gravity) {
            const OneRow T(pose, 7, "pose"), s(speed_bias, 9, "speed_bias"),
                g(gravity, 3, "gravity");
            EdgeImu edge;
            edge.imu = x.imu;
            std::copy_n(g.data(), 3, edge.gravity.data());
            VertexSpeedBias sb;
            std::copy_n(s.data(), 9, sb.Data());
            const ImuPrediction to = Predict(edge, VertexPose{PoseFrom(T.data())}, sb);
            return nb::make_tuple(
                Own(std::vector<double>(to.pose.pose.data, to.pose.pose.data + 7), {7}),
                Own(std::vector<double>(to.speed_bias.Data(), to.speed_bias.Data() + 9), {9}));
          },
          nb::arg("pose"), nb::arg("speed_bias"),
          nb::arg("gravity") = nb::make_tuple(0.0, 0.0, -9.81),
          nb::sig(
              "def predict(self, pose: numpy.typing.ArrayLike, speed_bias: numpy.typing.ArrayLike, "
              "gravity: numpy.typing.ArrayLike = (0.0, 0.0, -9.81)) -> "
              "tuple[numpy.typing.NDArray[numpy.float64], numpy.typing.NDArray[numpy.float64]]"),
          "Pose (7,) and speed and biases (9,) at the end, from those at the beginning.");
  m.def(
      "preintegrate",
      [](const IndexLike& stamps, const ArrayLike& gyro, const ArrayLike& accel,
         const ImuNoise& noise, const std::optional<ArrayLike>& ba,
         const std::optional<ArrayLike>& bg) {
        const auto samples = SamplesFrom(stamps, gyro, accel);
        return Unwrap(Preintegrate(samples, BiasFrom(ba, bg), noise));
      },
      nb::arg("stamps_ns"), nb::arg("gyro"), nb::arg("accel"), nb::arg("noise") = ImuNoise(),
      nb::arg("accel_bias") = nb::none(), nb::arg("gyro_bias") = nb::none(),
      "Integrates an interval of IMU samples.\n\nstamps_ns: (n,). gyro: (n, 3) [rad/s]. accel: (n, "
      "3), specific force [m/s^2]. Biases: (3,), where the increments are linearized.");
  nb::class_<ImuBuffer>(m, "ImuBuffer", "IMU samples in the order of time.")
      .def(nb::init<>())
      .def(
          "add",
          [](ImuBuffer& b, const IndexLike& stamps, const ArrayLike& gyro, const ArrayLike& accel) {
            Status first;
            for (const ImuSample& s : SamplesFrom(stamps, gyro, accel)) {
              const Status status = b.Add(s);
              if (first.ok()) first = status;
            }
            Check(first);
          },
          nb::arg("stamps_ns"), nb::arg("gyro"), nb::arg("accel"),
          "Takes all samples that make sense; raises for the first that does not.")
      .def("__len__", [](const ImuBuffer& b) { return b.samples().size(); })
      .def(
          "between",
          [](const ImuBuffer& b, std::int64_t begin, std::int64_t end) {
            ImuInterval interval;
            Check(b.Between(begin, end, &interval));
            return ArraysOf(interval.samples);
          },
          nb::arg("begin_ns"), nb::arg("end_ns"),
          nb::sig("def between(self, begin_ns: int, end_ns: int) -> "
                  "tuple[numpy.typing.NDArray[numpy.int64], numpy.typing.NDArray[numpy.float64], "
                  "numpy.typing.NDArray[numpy.float64]]"),
          "Samples of an interval, its ends interpolated: stamps_ns, gyro, accel.")
      .def(
          "preintegrate",
          [](const ImuBuffer& b, std::int64_t begin, std::int64_t end, const ImuNoise& noise,
             const std::optional<ArrayLike>& ba, const std::optional<ArrayLike>& bg) {
            ImuInterval interval;
            Check(b.Between(begin, end, &interval));
            return Unwrap(Preintegrate(interval.samples, BiasFrom(ba, bg), noise));
          },
          nb::arg("begin_ns"), nb::arg("end_ns"), nb::arg("noise") = ImuNoise(),
          nb::arg("accel_bias") = nb::none(), nb::arg("gyro_bias") = nb::none(),
          "Integrates an interval, its ends interpolated.")
      .def("drop_before", &ImuBuffer::DropBefore, nb::arg("stamp_ns"),
           "Forgets what is not needed for intervals that begin at or after a stamp.");
}

void BindImuEdges(nb::class_<PyProblem>& problem) {
  problem.def(
      "add_imu", &AddImu, nb::arg("pose_i"), nb::arg("speed_bias_i"), nb::arg("pose_j"),
      nb::arg("speed_bias_j"), nb::arg("intervals"),
      nb::arg("gravity") = nb::make_tuple(0.0, 0.0, -9.81), nb::kw_only(), nb::arg("loss") = Loss(),
      nb::sig(
          "def add_imu(self, pose_i: VertexArray, speed_bias_i: VertexArray, pose_j: VertexArray, "
          "speed_bias_j: VertexArray, intervals: collections.abc.Sequence[ImuPreintegration], "
          "gravity: numpy.typing.ArrayLike = (0.0, 0.0, -9.81), *, loss: Loss = ...) -> EdgeArray"),
      "Preintegrated IMU measurements between frames.\n\nintervals: one for each edge; their "
      "covariance is the weight. gravity: acceleration in the world [m/s^2].");
}

}  // namespace glissade::python
