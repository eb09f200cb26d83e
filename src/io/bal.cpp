// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/bal.h"
#include "glissade/base/out_of_memory.h"

#include <span>
#include <tuple>
#include <utility>

#include "io/bal_binary.h"
#include "io/text_reader.h"
#include "io/text_writer.h"

namespace glissade {

namespace {

using internal::CheckBal;
using internal::ReserveFor;
using internal::TextReader;
using internal::TextWriter;

constexpr const char* kCameraFields[9] = {"rotation x of camera",
                                          "rotation y of camera",
                                          "rotation z of camera",
                                          "translation x of camera",
                                          "translation y of camera",
                                          "translation z of camera",
                                          "focal length of camera",
                                          "k1 of camera",
                                          "k2 of camera"};
constexpr const char* kPointFields[3] = {"x of point", "y of point", "z of point"};

/// An observation is one line: a count in the first line that is too high or too low then shows
/// where observations end, not thousands of lines later.
BalObservation ReadObservation(TextReader& in, int cameras, int points, int index) {
  BalObservation observation;
  observation.camera = in.Index(cameras, "camera of observation", index);
  const std::int64_t line = in.line();
  observation.point = in.Index(points, "point of observation", index);
  observation.u = in.Number("u of observation", index);
  observation.v = in.Number("v of observation", index);
  const bool one_line = in.line() == line;
  if (in.ok() && (!one_line || !in.AtEndOfLine())) {
    in.Fail("expected observation " + std::to_string(index) +
            " (camera, point, u, v) alone on its line; is the number of observations in the first "
            "line right?");
  }
  return observation;
}

}  // namespace

Status internal::CheckBal(const BalProblem& problem) {
  const auto invalid = [](const std::string& what) {
    return Status(StatusCode::kInvalidArgument, "BAL problem: " + what);
  };
  if (problem.cameras.empty()) return invalid("no cameras");
  if (problem.points.empty()) return invalid("no points");
  if (problem.observations.empty()) return invalid("no observations");
  const auto num_cameras = static_cast<std::int64_t>(problem.cameras.size());
  const auto num_points = static_cast<std::int64_t>(problem.points.size());
  for (std::size_t k = 0; k < problem.cameras.size(); ++k) {
    const double* camera = problem.cameras[k].data;
    if (internal::AllFinite(camera, 9)) continue;
    return ValidateFinite(camera, 9, "BAL camera " + std::to_string(k));
  }
  for (std::size_t k = 0; k < problem.points.size(); ++k) {
    const double* point = problem.points[k].data;
    if (internal::AllFinite(point, 3)) continue;
    return ValidateFinite(point, 3, "BAL point " + std::to_string(k));
  }
  for (std::size_t k = 0; k < problem.observations.size(); ++k) {
    const BalObservation& o = problem.observations[k];
    const bool camera_known = o.camera >= 0 && o.camera < num_cameras;
    const bool point_known = o.point >= 0 && o.point < num_points;
    const double uv[2] = {o.u, o.v};
    if (camera_known && point_known && internal::AllFinite(uv, 2)) continue;
    const std::string name = "observation " + std::to_string(k);
    if (!camera_known) return invalid(name + ": no such camera");
    if (!point_known) return invalid(name + ": no such point");
    return ValidateFinite(uv, 2, "BAL " + name);
  }
  return {};
}

Result<BalProblem> ReadBal(const std::string& path) {
  return internal::OrOutOfMemory([&]() -> Result<BalProblem> {
    auto source = internal::OpenByteSource(path);
    if (!source.ok()) return source.status();
    if (internal::IsBalBinary(source.value()->FirstBytes())) {
      return internal::ReadBalBinary(*source.value(), path);
    }
    TextReader in(path, '\0', std::move(source).value());

    const int num_cameras = in.Count(1, "number of cameras");
    const std::int64_t line = in.line();
    const int num_points = in.Count(1, "number of points");
    const int num_observations = in.Count(1, "number of observations");
    if (in.ok() && in.line() != line) {
      in.Fail("expected the numbers of cameras, points and observations on one line");
    }
    if (!in.ok()) return in.status();

    // A line of an observation has 8 characters or more, any other number 2.
    BalProblem problem;
    problem.observations.reserve(ReserveFor(num_observations, in.size() / 8));
    for (int k = 0; k < num_observations && in.ok(); ++k) {
      problem.observations.push_back(ReadObservation(in, num_cameras, num_points, k));
    }
    problem.cameras.reserve(ReserveFor(num_cameras, in.size() / 18));
    for (int k = 0; k < num_cameras && in.ok(); ++k) {
      VertexCameraBal camera;
      for (int i = 0; i < 9; ++i)
        camera.data[i] = in.Number(kCameraFields[i], k);
      problem.cameras.push_back(camera);
    }
    problem.points.reserve(ReserveFor(num_points, in.size() / 6));
    for (int k = 0; k < num_points && in.ok(); ++k) {
      VertexPointXYZ point;
      for (int i = 0; i < 3; ++i)
        point.data[i] = in.Number(kPointFields[i], k);
      problem.points.push_back(point);
    }
    if (in.ok() && !in.AtEnd()) {
      in.Fail("expected the end of the file after the last point, found '" +
              internal::Printable(in.Peek()) + "'; are the counts in the first line right?");
    }
    if (!in.ok()) return in.status();
    return problem;
  });
}

Status WriteBal(const BalProblem& problem, const std::string& path,
                const std::function<void(double)>& progress) {
  if (Status status = CheckBal(problem); !status.ok()) return status;
  if (path.ends_with(".bbal")) return internal::WriteBalBinary(problem, path);
  auto writer = TextWriter::Create(path);
  if (!writer.ok()) return writer.status();
  TextWriter& out = writer.value();

  const std::size_t numbers =
      4 * problem.observations.size() + 9 * problem.cameras.size() + 3 * problem.points.size();
  std::size_t written = 0;
  const auto wrote = [&](std::size_t n) {
    constexpr std::size_t kStep = 1 << 18;
    const std::size_t before = written;
    written += n;
    if (progress && written / kStep != before / kStep) {
      progress(static_cast<double>(written) / static_cast<double>(numbers));
    }
  };
  const auto count = [&](const auto& list) { out.Integer(static_cast<std::int64_t>(list.size())); };
  count(problem.cameras);
  count(problem.points);
  count(problem.observations);
  out.EndLine();
  for (const BalObservation& o : problem.observations) {
    out.Integer(o.camera).Integer(o.point).Number(o.u).Number(o.v).EndLine();
    wrote(4);
  }
  for (const VertexCameraBal& camera : problem.cameras) {
    for (double x : camera.data)
      out.Number(x).EndLine();
    wrote(9);
  }
  for (const VertexPointXYZ& point : problem.points) {
    for (double x : point.data)
      out.Number(x).EndLine();
    wrote(3);
  }
  return out.Close();
}

namespace {

/// Not `*list = {}`, which keeps the memory.
template <class T>
void Free(std::vector<T>* list) {
  std::vector<T>().swap(*list);
}

/// Adds a problem that has been checked, and frees its lists once they are in the graph if
/// `consume` is set. Only memory can fail: then some vertices are there, in *handles.
Status AddChecked(BalProblem* consume, const BalProblem& problem, Graph& graph, const Loss& loss,
                  BalHandles* handles) {
  auto cameras = graph.AddVertices(std::span<const VertexCameraBal>(problem.cameras));
  if (!cameras.ok()) return cameras.status();
  handles->cameras = std::move(cameras).value();
  auto points = graph.AddVertices(std::span<const VertexPointXYZ>(problem.points));
  if (!points.ok()) return points.status();
  handles->points = std::move(points).value();
  if (consume != nullptr) {
    Free(&consume->cameras);
    Free(&consume->points);
  }

  std::vector<EdgeBal> edges;
  std::vector<EdgeVertexHandles<EdgeBal>> vertices;
  edges.reserve(problem.observations.size());
  vertices.reserve(problem.observations.size());
  for (const BalObservation& o : problem.observations) {
    edges.push_back(EdgeBal{Vector2(o.u, o.v)});
    vertices.emplace_back(handles->cameras[static_cast<std::size_t>(o.camera)],
                          handles->points[static_cast<std::size_t>(o.point)]);
  }
  if (consume != nullptr) Free(&consume->observations);
  auto added =
      graph.AddEdges(std::span<const EdgeBal>(edges),
                     std::span<const EdgeVertexHandles<EdgeBal>>(vertices), {.loss = loss});
  if (!added.ok()) return added.status();
  handles->edges = std::move(added).value();
  return {};
}

/// All or nothing: what could be refused is refused first, and where memory runs out, what has been
/// added is taken away again.
Status AddAll(BalProblem* consume, const BalProblem& problem, Graph& graph, const Loss& loss,
              BalHandles* handles) {
  if (Status status = CheckBal(problem); !status.ok()) return status;
  if (Status status = loss.Validate(); !status.ok()) return status;
  Status added =
      internal::OrOutOfMemory([&] { return AddChecked(consume, problem, graph, loss, handles); });
  if (added.ok()) return added;
  for (const auto& camera : handles->cameras)
    graph.RemoveVertex(camera);
  for (const auto& point : handles->points)
    graph.RemoveVertex(point);
  return added;
}

}  // namespace

Result<BalHandles> AddToGraph(const BalProblem& problem, Graph& graph, const Loss& loss) {
  BalHandles handles;
  if (Status s = AddAll(nullptr, problem, graph, loss, &handles); !s.ok()) return s;
  return handles;
}

Status MoveToGraph(BalProblem problem, Graph& graph, const Loss& loss) {
  BalHandles handles;
  return AddAll(&problem, problem, graph, loss, &handles);
}

Result<BalProblem> BalFromGraph(const Graph& graph) {
  if (graph.NumVertices() !=
          graph.NumVertices<VertexCameraBal>() + graph.NumVertices<VertexPointXYZ>() ||
      graph.NumEdges() != graph.NumEdges<EdgeBal>()) {
    return Status(StatusCode::kInvalidArgument,
                  "a BAL problem consists of VertexCameraBal, VertexPointXYZ and EdgeBal alone");
  }
  BalProblem problem;
  problem.cameras.reserve(static_cast<std::size_t>(graph.NumVertices<VertexCameraBal>()));
  problem.points.reserve(static_cast<std::size_t>(graph.NumVertices<VertexPointXYZ>()));
  std::vector<std::int32_t> camera_of_slot;
  std::vector<std::int32_t> point_of_slot;
  const auto number = [](std::vector<std::int32_t>& of_slot, std::uint32_t slot,
                         std::size_t index) {
    if (slot >= of_slot.size()) of_slot.resize(slot + std::size_t{1}, -1);
    of_slot[slot] = static_cast<std::int32_t>(index);
  };
  graph.ForEachVertex<VertexCameraBal>(
      [&](VertexHandle<VertexCameraBal> handle, const VertexCameraBal& camera) {
        number(camera_of_slot, handle.slot, problem.cameras.size());
        problem.cameras.push_back(camera);
      });
  graph.ForEachVertex<VertexPointXYZ>(
      [&](VertexHandle<VertexPointXYZ> handle, const VertexPointXYZ& point) {
        number(point_of_slot, handle.slot, problem.points.size());
        problem.points.push_back(point);
      });
  problem.observations.reserve(static_cast<std::size_t>(graph.NumEdges()));
  graph.ForEachEdge<EdgeBal>(
      [&](EdgeHandle<EdgeBal>, const EdgeBal& edge, const EdgeVertexHandles<EdgeBal>& vertices) {
        problem.observations.push_back({camera_of_slot[std::get<0>(vertices).slot],
                                        point_of_slot[std::get<1>(vertices).slot], edge.uv[0],
                                        edge.uv[1]});
      });
  return problem;
}

}  // namespace glissade
