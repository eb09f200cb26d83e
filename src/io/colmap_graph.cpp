// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/colmap_graph.h"

#include <algorithm>
#include <span>
#include <utility>

#include "glissade/base/out_of_memory.h"
#include "io/colmap_check.h"
#include "io/colmap_intrinsics.h"
#include "io/colmap_poses.h"

namespace glissade {

namespace {

using internal::CameraInWorld;
using internal::ColmapIds;
using internal::ColmapIntrinsics;
using internal::IntrinsicsOf;
using internal::Joined;

struct Observation {
  std::uint32_t image = 0, camera = 0, point = 0;  ///< indices
  const ColmapFeature* feature = nullptr;
};

/// What takes part.
struct Selection {
  std::vector<Observation> observations;
  std::vector<char> images, cameras, points;
};

Selection Select(const ColmapModel& model, const ColmapIds& ids, ColmapHandles* handles) {
  Selection selected;
  selected.images.assign(model.images.size(), 0);
  selected.cameras.assign(model.cameras.size(), 0);
  selected.points.assign(model.points.size(), 0);
  std::vector<std::size_t> last_point(model.images.size(), model.points.size());
  for (std::size_t p = 0; p < model.points.size(); ++p) {
    const std::size_t first = selected.observations.size();
    std::int64_t repeated = 0;
    for (const ColmapTrackElement& element : model.points[p].track) {
      const std::size_t image = ids.image.at(element.image);
      if (std::exchange(last_point[image], p) == p) {
        ++repeated;
        continue;
      }
      const std::size_t camera = ids.camera.at(model.images[image].camera);
      selected.observations.push_back(
          {static_cast<std::uint32_t>(image), static_cast<std::uint32_t>(camera),
           static_cast<std::uint32_t>(p), &model.images[image].features[element.feature]});
    }
    if (selected.observations.size() < first + 2) {
      selected.observations.resize(first);
      ++handles->num_points_left_out;
      continue;
    }
    handles->num_features_left_out += repeated;
    selected.points[p] = 1;
    for (std::size_t k = first; k < selected.observations.size(); ++k) {
      selected.images[selected.observations[k].image] = 1;
      selected.cameras[selected.observations[k].camera] = 1;
    }
  }
  handles->num_observations = static_cast<std::int64_t>(selected.observations.size());
  handles->num_images_left_out = std::count(selected.images.begin(), selected.images.end(), 0);
  return selected;
}

Status CheckCameras(const ColmapModel& model, const std::vector<char>& selected) {
  for (std::size_t k = 0; k < model.cameras.size(); ++k) {
    if (selected[k] == 0) continue;
    const ColmapCamera& camera = model.cameras[k];
    const ColmapIntrinsics intrinsics = IntrinsicsOf(camera.model);
    const std::string id = std::to_string(camera.id);
    if (intrinsics.family == ColmapIntrinsics::Family::kNone) {
      return {StatusCode::kInvalidArgument,
              Joined({"COLMAP model: camera ", id, " is ", ColmapModelName(camera.model),
                      ", which cannot be solved for"})};
    }
    for (int f = 0; f < intrinsics.num_focal; ++f) {
      Status status = ValidatePositive(camera.parameters[static_cast<std::size_t>(f)],
                                       Joined({"COLMAP model: focal length of camera ", id}));
      if (!status.ok()) return status;
    }
  }
  return {};
}

/// Adds the selected ones of a list, made by `make`, and puts their handles in place.
template <class V, class Handle, class Make>
Status AddSelected(Graph& graph, const std::vector<char>& selected, std::vector<Handle>* handles,
                   Make make) {
  handles->resize(selected.size());
  std::vector<V> values;
  for (std::size_t k = 0; k < selected.size(); ++k) {
    if (selected[k] != 0) values.push_back(make(k));
  }
  auto added = graph.AddVertices(std::span<const V>(values));
  if (!added.ok()) return added.status();
  std::size_t next = 0;
  for (std::size_t k = 0; k < selected.size(); ++k) {
    if (selected[k] != 0) (*handles)[k] = added.value()[next++];
  }
  return {};
}

template <int N>
Status AddIntrinsics(const ColmapModel& model, const Selection& selected, Graph& graph,
                     const ColmapGraphOptions& options, ColmapHandles* handles) {
  for (std::size_t k = 0; k < model.cameras.size(); ++k) {
    const ColmapCamera& camera = model.cameras[k];
    const ColmapIntrinsics intrinsics = IntrinsicsOf(camera.model);
    if (selected.cameras[k] == 0 || intrinsics.dim() != N) continue;
    VertexVector<N> vertex;
    std::copy(camera.parameters.begin(), camera.parameters.end(), vertex.value.begin());
    const auto added = graph.AddVertex(vertex);
    if (!added.ok()) return added.status();
    handles->cameras[k] = added.value();
    const Status status = graph.SetFixedNumbers(
        added.value(), intrinsics.Held(options.free_focal_length, options.free_principal_point,
                                       options.free_distortion));
    if (!status.ok()) return status;
  }
  return {};
}

template <class E>
Status AddObservations(const ColmapModel& model, const Selection& selected,
                       ColmapIntrinsics::Family family, Graph& graph,
                       const ColmapGraphOptions& options, const ColmapHandles& handles) {
  std::vector<E> edges;
  std::vector<EdgeVertexHandles<E>> vertices;
  for (const Observation& o : selected.observations) {
    if (IntrinsicsOf(model.cameras[o.camera].model).family != family) continue;
    E edge;
    edge.uv = Vector2(o.feature->x, o.feature->y);
    edges.push_back(edge);
    vertices.emplace_back(handles.images[o.image], handles.points[o.point],
                          *handles.cameras[o.camera].template As<typename E::Intrinsics>());
  }
  if (edges.empty()) return {};
  return graph
      .AddEdges(std::span<const E>(edges), std::span<const EdgeVertexHandles<E>>(vertices),
                {.loss = options.loss})
      .status();
}

Result<ColmapHandles> Add(const ColmapModel& model, Graph& graph,
                          const ColmapGraphOptions& options) {
  // Whatever could be refused below is refused here, so that the graph gets all or nothing.
  if (Status status = CheckColmap(model); !status.ok()) return status;
  if (Status status = options.loss.Validate(); !status.ok()) return status;
  ColmapHandles handles;
  const Selection selected = Select(model, ColmapIds(model), &handles);
  if (selected.observations.empty()) {
    return Status(StatusCode::kInvalidArgument,
                  "COLMAP model: there is no point that two images see");
  }
  if (Status status = CheckCameras(model, selected.cameras); !status.ok()) return status;

  Status status = AddSelected<VertexPose>(
      graph, selected.images, &handles.images,
      [&](std::size_t k) { return VertexPose{CameraInWorld(model.images[k])}; });
  if (!status.ok()) return status;
  handles.cameras.resize(model.cameras.size());
  status = AddIntrinsics<IntrinsicsRadial::kDim>(model, selected, graph, options, &handles);
  if (!status.ok()) return status;
  status = AddIntrinsics<IntrinsicsRadtan::kDim>(model, selected, graph, options, &handles);
  if (!status.ok()) return status;
  status = AddSelected<VertexPointXYZ>(graph, selected.points, &handles.points, [&](std::size_t k) {
    const double* x = model.points[k].xyz;
    return VertexPointXYZ(x[0], x[1], x[2]);
  });
  if (!status.ok()) return status;
  using Family = ColmapIntrinsics::Family;
  status = AddObservations<EdgeReprojectionRadial>(model, selected, Family::kRadial, graph, options,
                                                   handles);
  if (!status.ok()) return status;
  status = AddObservations<EdgeReprojectionRadtan>(model, selected, Family::kRadtan, graph, options,
                                                   handles);
  if (!status.ok()) return status;
  status = AddObservations<EdgeReprojectionFisheye>(model, selected, Family::kFisheye, graph,
                                                    options, handles);
  if (!status.ok()) return status;
  if (options.fix_first_image) {
    const auto first = std::find(selected.images.begin(), selected.images.end(), 1);
    const auto k = static_cast<std::size_t>(first - selected.images.begin());
    status = graph.SetFixed(handles.images[k]);
    if (!status.ok()) return status;
  }
  return handles;
}

}  // namespace

Result<ColmapHandles> AddToGraph(const ColmapModel& model, Graph& graph,
                                 const ColmapGraphOptions& options) {
  return internal::OrOutOfMemory([&] { return Add(model, graph, options); });
}

}  // namespace glissade
