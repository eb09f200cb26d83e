// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
// Vertices of a problem: adding them, their values, what of them is held.
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstdint>
#include <cstring>
#include <string>
#include <vector>

#include "arrays.h"
#include "errors.h"
#include "for_all.h"
#include "glissade/graph/pools.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

namespace {

/// Calls f.operator()<V>() for the vertex type of that name; false where there
/// is no such type.
template <class F>
bool ForVertexType(const TypeInfo* type, F&& f) {
  const auto is = [&]<class V>() {
    if (type != &kTypeInfo<V>) return false;
    f.template operator()<V>();
    return true;
  };
  return is.template operator()<VertexPose>() || is.template operator()<VertexInverseDepth>() ||
         is.template operator()<VertexPointXYZ>() || is.template operator()<VertexSpeedBias>() ||
         is.template operator()<VertexCameraBal>() || is.template operator()<VertexVector<1>>() ||
         is.template operator()<VertexVector<2>>() || is.template operator()<VertexVector<3>>() ||
         is.template operator()<VertexVector<4>>() || is.template operator()<VertexVector<5>>() ||
         is.template operator()<VertexVector<6>>() || is.template operator()<VertexVector<7>>() ||
         is.template operator()<VertexVector<8>>() || is.template operator()<VertexVector<9>>();
}

template <class V>
VertexArray AddVertices(PyProblem& p, const ArrayLike& array, const char* name) {
  const Rows rows(array, V::kAmbientDim, name);
  std::vector<V> values(rows.size());
  for (std::size_t k = 0; k < values.size(); ++k)
    std::memcpy(values[k].Data(), rows[k], sizeof(double) * V::kAmbientDim);
  return ArrayOf<AnyVertex>(p.Seen(p.write().AddVertices<V>(values)));
}

VertexArray AddVectors(PyProblem& p, const ArrayLike& values) {
  const Doubles given(values, "values");
  const std::size_t n = given.ndim() == 2 ? given.dim(1) : 0;
  switch (n) {
    case 1:
      return AddVertices<VertexVector<1>>(p, values, "values");
    case 2:
      return AddVertices<VertexVector<2>>(p, values, "values");
    case 3:
      return AddVertices<VertexVector<3>>(p, values, "values");
    case 4:
      return AddVertices<VertexVector<4>>(p, values, "values");
    case 5:
      return AddVertices<VertexVector<5>>(p, values, "values");
    case 6:
      return AddVertices<VertexVector<6>>(p, values, "values");
    case 7:
      return AddVertices<VertexVector<7>>(p, values, "values");
    case 8:
      return AddVertices<VertexVector<8>>(p, values, "values");
    case 9:
      return AddVertices<VertexVector<9>>(p, values, "values");
    default:
      break;
  }
  throw nb::value_error(std::string("values must have the shape (n, k), k from 1 to 9, not ")
                            .append(given.Shape())
                            .c_str());
}

/// Their common type; ValueError where they differ.
const TypeInfo* CommonType(const VertexArray& vertices) {
  for (const AnyVertex& v : vertices.handles) {
    if (v.type != vertices[0].type)
      throw nb::value_error("the vertices are of more than one type: ask for those of each");
  }
  return vertices.size() == 0 ? nullptr : vertices[0].type;
}

OutArray Values(PyProblem& p, const VertexArray& vertices) {
  const Graph& graph = p.read();
  const TypeInfo* type = CommonType(vertices);
  const VertexPoolBase* pool = type == nullptr ? nullptr : graph.PoolOf(type);
  const std::size_t dim = pool == nullptr ? 0 : static_cast<std::size_t>(pool->ops().ambient_dim);
  std::vector<double> values(vertices.size() * dim);
  for (std::size_t k = 0; k < vertices.size(); ++k) {
    if (!graph.Contains(vertices[k])) Raise(graph.UnknownHandle(vertices[k]));
    std::copy_n(pool->Data(pool->slots().IndexOf(vertices[k].slot)), dim, values.data() + k * dim);
  }
  return Own(std::move(values), {vertices.size(), dim});
}

void SetValues(PyProblem& p, const VertexArray& vertices, const ArrayLike& array) {
  const TypeInfo* type = CommonType(vertices);
  if (type == nullptr) return;
  Problem& problem = p.write();
  const bool known = ForVertexType(type, [&]<class V>() {
    const Rows rows(array, V::kAmbientDim, "values");
    rows.ExpectOneOr(vertices.size());
    std::vector<V> before;
    before.reserve(vertices.size());
    const auto set = [&](std::size_t k, const V& value) {
      return problem.Set(*vertices[k].As<V>(), value);
    };
    for (std::size_t k = 0; k < vertices.size(); ++k) {
      V value;
      std::memcpy(value.Data(), rows.ForEach(k), sizeof(double) * V::kAmbientDim);
      before.push_back(problem.Get(*vertices[k].As<V>()));
      if (Status status = set(k, value); !status.ok()) {
        for (std::size_t j = k; j-- > 0;)  // backwards: a vertex may be there twice
          (void)set(j, before[j]);
        p.Seen(status);
      }
    }
  });
  if (!known) throw nb::value_error("vertices of this type cannot be set from Python");
}

/// Holds vertices by f(vertex), or leaves all as they are.
template <class F>
void HoldAll(PyProblem& p, const VertexArray& vertices, F&& f) {
  Problem& problem = p.write();
  std::vector<Fix> before;
  std::vector<std::uint32_t> numbers;
  for (const AnyVertex& v : vertices.handles) {
    before.push_back(problem.GetFixed(v));
    numbers.push_back(problem.FixedNumbers(v));
  }
  ForAll(p, vertices, f, [&](std::size_t k) {
    (void)(before[k] == Fix::kNumbers ? problem.SetFixedNumbers(vertices[k], numbers[k])
                                      : problem.SetFixed(vertices[k], before[k]));
  });
}

}  // namespace

void BindVertices(nb::class_<PyProblem>& problem) {
  problem
      .def(
          "add_poses",
          [](PyProblem& p, const ArrayLike& T) { return AddVertices<VertexPose>(p, T, "poses"); },
          nb::arg("poses"),
          "Adds poses T_world_body.\n\nposes: (n, 7), position x y z [m] and unit quaternion x y z "
          "w (Hamilton).\nTangent, 6: [dp (world axes), dtheta (body axes)].")
      .def(
          "add_inverse_depths",
          [](PyProblem& p, const ArrayLike& d) {
            return AddVertices<VertexInverseDepth>(p, d, "inverse depths");
          },
          nb::arg("inverse_depths"),
          "Adds landmarks by their inverse depth along a ray of their host "
          "frame.\n\ninverse_depths: (n,) or (n, 1) [1/m].")
      .def(
          "add_points",
          [](PyProblem& p, const ArrayLike& X) {
            return AddVertices<VertexPointXYZ>(p, X, "points");
          },
          nb::arg("points"), "Adds points in the world.\n\npoints: (n, 3) [m].")
      .def(
          "add_speed_biases",
          [](PyProblem& p, const ArrayLike& x) {
            return AddVertices<VertexSpeedBias>(p, x, "speeds and biases");
          },
          nb::arg("speed_biases"),
          "Adds velocities and IMU biases.\n\nspeed_biases: (n, 9), velocity in the world [m/s], "
          "bias of the accelerometer [m/s^2], of the gyroscope [rad/s].")
      .def(
          "add_bal_cameras",
          [](PyProblem& p, const ArrayLike& c) {
            return AddVertices<VertexCameraBal>(p, c, "cameras");
          },
          nb::arg("cameras"),
          "Adds cameras as BAL files have them.\n\ncameras: (n, 9), rotation vector [rad], "
          "translation, focal length [px], k1, k2.")
      .def("add_vectors", &AddVectors, nb::arg("values"),
           "Adds plain vectors, additive.\n\nvalues: (n, k), k from 1 to 9.")
      .def("values", &Values, nb::arg("vertices"),
           "The present values of vertices of one type: (n, k), a copy.")
      .def("set_values", &SetValues, nb::arg("vertices"), nb::arg("values"),
           "Sets the values of vertices of one type, all or none: (n, k), or one row for all.")
      .def(
          "fix",
          [](PyProblem& p, const VertexArray& v, Fix fix) {
            HoldAll(p, v, [&](AnyVertex x) { return p.write().SetFixed(x, fix); });
          },
          nb::arg("vertices"), nb::arg("what") = Fix::kWhole,
          "Holds vertices, or a part of poses, at their present values.")
      .def(
          "fix_numbers",
          [](PyProblem& p, const VertexArray& v, const std::vector<int>& numbers) {
            std::uint32_t held = 0;
            for (const int k : numbers) {
              if (k < 0 || k > 8) throw nb::value_error("numbers are from 0 to 8");
              held |= 1u << k;
            }
            HoldAll(p, v, [&](AnyVertex x) { return p.write().SetFixedNumbers(x, held); });
          },
          nb::arg("vertices"), nb::arg("numbers"),
          "Holds some numbers of additive vertices: fix_numbers(cameras, [2, 3]).")
      .def(
          "free",
          [](PyProblem& p, const VertexArray& v) {
            HoldAll(p, v, [&](AnyVertex x) { return p.write().SetFixed(x, Fix::kFree); });
          },
          nb::arg("vertices"), "Lets go what fix() holds.")
      .def(
          "fixed",
          [](PyProblem& p, const VertexArray& v) {
            std::vector<Fix> fixed;
            ExpectKnown(p, v);
            for (const AnyVertex& x : v.handles)
              fixed.push_back(p.read().GetFixed(x));
            return fixed;
          },
          nb::arg("vertices"), "What of each vertex is held.")
      .def(
          "eliminate",
          [](PyProblem& p, const VertexArray& v, bool on) {
            ForAll(
                p, v, [&](AnyVertex x) { return p.write().SetEliminated(x, on); },
                [&](std::size_t k) { (void)p.write().SetEliminated(v[k], !on); });
          },
          nb::arg("vertices"), nb::arg("eliminated") = true,
          "Whether vertices are eliminated by the Schur complement; landmarks are by default.");
}

}  // namespace glissade::python
