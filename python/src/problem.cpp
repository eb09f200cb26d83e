// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "problem.h"

#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/unique_ptr.h>
#include <nanobind/stl/vector.h>

#include <algorithm>
#include <cstring>
#include <optional>

#include "arrays.h"
#include "errors.h"
#include "glissade/graph/pools.h"
#include "glissade/vertices/camera_bal.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/point_xyz.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"
#include "glissade/vertices/vector.h"
#include "handles.h"

namespace glissade::python {

namespace {

/// Calls f.operator()<V>() for the vertex type of that name; false where there is no such type.
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
  const std::size_t n = values.ndim() == 2 ? values.dim(1) : 0;
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
                            .append(values.Shape())
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
        for (std::size_t j = 0; j < k; ++j)
          (void)set(j, before[j]);
        p.Seen(status);
      }
    }
  });
  if (!known) throw nb::value_error("vertices of this type cannot be set from Python");
}

template <class F>
void ForAll(PyProblem& p, const VertexArray& vertices, F&& f) {
  for (const AnyVertex& v : vertices.handles) {
    if (!p.read().Contains(v)) Raise(p.read().UnknownHandle(v));
  }
  for (const AnyVertex& v : vertices.handles)
    p.Seen(f(v));
}

OutArray Chi2OfEdges(PyProblem& p, const EdgeArray& edges) {
  std::vector<double> chi2(edges.size());
  for (std::size_t k = 0; k < chi2.size(); ++k)
    chi2[k] = Unwrap(p.read().Chi2(edges[k]));
  return Own(std::move(chi2), {edges.size()});
}

void BindValues(nb::class_<PyProblem>& problem) {
  problem
      .def(
          "add_poses",
          [](PyProblem& p, const ArrayLike& T) { return AddVertices<VertexPose>(p, T, "poses"); },
          nb::arg("poses"),
          "Adds poses T_world_body.\n\nposes: (n, 7), position x y z [m] and unit quaternion "
          "x y z w (Hamilton).\nTangent, 6: [dp (world axes), dtheta (body axes)].")
      .def(
          "add_inverse_depths",
          [](PyProblem& p, const ArrayLike& d) {
            return AddVertices<VertexInverseDepth>(p, d, "inverse depths");
          },
          nb::arg("inverse_depths"),
          "Adds landmarks by their inverse depth along a ray of their host frame.\n\n"
          "inverse_depths: (n,) or (n, 1) [1/m].")
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
            ForAll(p, v, [&](AnyVertex x) { return p.write().SetFixed(x, fix); });
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
            ForAll(p, v, [&](AnyVertex x) { return p.write().SetFixedNumbers(x, held); });
          },
          nb::arg("vertices"), nb::arg("numbers"),
          "Holds some numbers of additive vertices: fix_numbers(cameras, [2, 3]).")
      .def(
          "free",
          [](PyProblem& p, const VertexArray& v) {
            ForAll(p, v, [&](AnyVertex x) { return p.write().SetFixed(x, Fix::kFree); });
          },
          nb::arg("vertices"), "Lets go what fix() holds.")
      .def(
          "fixed",
          [](PyProblem& p, const VertexArray& v) {
            std::vector<Fix> fixed;
            for (const AnyVertex& x : v.handles)
              fixed.push_back(p.read().GetFixed(x));
            return fixed;
          },
          nb::arg("vertices"), "What of each vertex is held.")
      .def(
          "eliminate",
          [](PyProblem& p, const VertexArray& v, bool on) {
            ForAll(p, v, [&](AnyVertex x) { return p.write().SetEliminated(x, on); });
          },
          nb::arg("vertices"), nb::arg("eliminated") = true,
          "Whether vertices are eliminated by the Schur complement; landmarks are by default.");
}

void BindQueries(nb::class_<PyProblem>& problem) {
  problem.def_prop_ro("num_vertices", [](PyProblem& p) { return p.read().NumVertices(); })
      .def_prop_ro("num_edges", [](PyProblem& p) { return p.read().NumEdges(); })
      .def(
          "vertices", [](PyProblem& p) { return VertexArray(p.read().Vertices()); },
          "All vertices: by type in the order of first use, in order of insertion.")
      .def(
          "edges", [](PyProblem& p) { return EdgeArray(p.read().Edges()); }, "All edges.")
      .def(
          "edges_of",
          [](PyProblem& p, const VertexArray& v) {
            return EdgeArray(Unwrap(p.read().EdgesOf(OnlyOne(v, "vertex"))));
          },
          nb::arg("vertex"), "The edges that touch a vertex.")
      .def(
          "vertices_of",
          [](PyProblem& p, const EdgeArray& e) {
            if (e.size() != 1) throw nb::value_error("one edge is needed");
            return VertexArray(Unwrap(p.read().VerticesOf(e[0])));
          },
          nb::arg("edge"), "The vertices of an edge, in the order of its type.")
      .def(
          "contains",
          [](PyProblem& p, const VertexArray& v) {
            return std::all_of(v.handles.begin(), v.handles.end(),
                               [&](AnyVertex x) { return p.read().Contains(x); });
          },
          nb::arg("vertices"), "Whether all of them are in the problem.")
      .def(
          "remove_vertices",
          [](PyProblem& p, const VertexArray& v, bool with_prior) {
            const auto prior = with_prior ? PriorOnVertex::kRemove : PriorOnVertex::kRefuse;
            ForAll(p, v, [&](AnyVertex x) { return p.write().RemoveVertex(x, prior); });
          },
          nb::arg("vertices"), nb::arg("with_prior") = false,
          "Removes vertices and their edges. One under a marginal prior is refused unless the "
          "prior may go as well; marginalize() keeps what it knows.")
      .def(
          "remove_edges",
          [](PyProblem& p, const EdgeArray& edges) {
            for (const AnyEdge& e : edges.handles) {
              if (!p.read().Contains(e)) Raise(p.read().UnknownHandle(e));
            }
            for (const AnyEdge& e : edges.handles)
              p.Seen(p.write().RemoveEdge(e));
          },
          nb::arg("edges"), "Removes edges.")
      .def("chi2", &Chi2OfEdges, nb::arg("edges"),
           "s = r' Omega r of each edge, without 1/2 and loss: (n,).")
      .def(
          "cost", [](PyProblem& p) { return Unwrap(p.read().Cost()); },
          "1/2 sum rho(s) over all edges: what solve() minimizes.")
      .def(
          "depths",
          [](PyProblem& p, const EdgeArray& edges) {
            std::vector<double> depths;
            for (const AnyEdge& e : edges.handles)
              depths.push_back(Unwrap(p.read().DepthOf(e)));
            const std::size_t n = depths.size();
            return Own(std::move(depths), {n});
          },
          nb::arg("edges"), "Depth [m] of the observed point in the observing camera: (n,).")
      .def(
          "outliers",
          [](PyProblem& p, double max_chi2, double min_depth) {
            return EdgeArray(p.read().GetOutlierEdges({max_chi2, min_depth}));
          },
          nb::arg("max_chi2") = OutlierOptions().max_chi2,
          nb::arg("min_depth") = OutlierOptions().min_depth,
          "Observations with chi2 over max_chi2 (default: 99 % of two degrees of freedom) or less "
          "depth than min_depth [m].")
      .def(
          "clone",
          [](PyProblem& p) { return std::make_unique<PyProblem>(Unwrap(p.read().Clone())); },
          "A deep copy. Handles of this problem are valid in it.");
}

}  // namespace

Problem& PyProblem::read() {
  if (busy_ && worker_ != std::this_thread::get_id()) {
    throw nb::builtin_exception(nb::exception_type::runtime_error,
                                "another thread is working on this problem");
  }
  return problem_;
}

Problem& PyProblem::write() {
  if (busy_) {
    throw nb::builtin_exception(
        nb::exception_type::runtime_error,
        "the problem is being worked on: it can be read in a callback, not changed");
  }
  return problem_;
}

void PyProblem::Seen(const Status& status) {
  if (status.ok()) return;
  (void)problem_.AcknowledgeRefusal();
  Raise(status);
}

void BindProblem(nb::module_& m) {
  nb::enum_<Fix>(m, "Fix", "What of a vertex is held.")
      .value("FREE", Fix::kFree)
      .value("WHOLE", Fix::kWhole)
      .value("POSITION", Fix::kPosition)
      .value("POSITION_AND_YAW", Fix::kPositionAndYaw, "of a pose")
      .value("BIASES", Fix::kBiases, "both biases; the velocity stays free")
      .value("NUMBERS", Fix::kNumbers, "some numbers: Problem.fix_numbers()");
  auto problem = nb::class_<PyProblem>(
                     m, "Problem",
                     "A factor graph with everything that is needed to solve it.\n\n"
                     "Poses are T_world_body, 7 numbers: position [m], unit quaternion x y z "
                     "w. SI units.\nCalls that are refused raise glissade.Error and change "
                     "nothing.\nNot for use by two threads at once; solves run without the "
                     "interpreter's lock.")
                     .def(nb::init<>());
  BindValues(problem);
  BindQueries(problem);
  BindEdges(problem);
  BindImuEdges(problem);
  BindEdgeKinds(m, problem);
  BindSolve(m, problem);
  BindStudy(m, problem);
  BindMarginal(m, problem);
  BindFiles(m, problem);
}

}  // namespace glissade::python
