// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What was solved for goes back into the model.

#include <algorithm>
#include <cmath>
#include <vector>

#include "glissade/base/out_of_memory.h"
#include "glissade/io/colmap_graph.h"
#include "io/colmap_intrinsics.h"
#include "io/colmap_poses.h"

namespace glissade {

namespace {

using internal::CameraInWorld;
using internal::ColmapIds;
using internal::IntrinsicsOf;

/// T_W_C into an image, with the sign of the quaternion that the image has.
void SetCameraInWorld(const Pose& T_w_c, ColmapImage* image) {
  const Pose T_c_w = T_w_c.Inverse();
  const double wxyz[4] = {T_c_w.data[6], T_c_w.data[3], T_c_w.data[4], T_c_w.data[5]};
  double dot = 0.0;
  for (int k = 0; k < 4; ++k)
    dot += wxyz[k] * image->q[k];
  for (int k = 0; k < 4; ++k)
    image->q[k] = dot < 0.0 ? -wxyz[k] : wxyz[k];
  std::copy_n(T_c_w.data, 3, image->t);
}

/// Distances between features and where their points project to.
class ReprojectionErrors {
 public:
  explicit ReprojectionErrors(const ColmapModel& model) : model_(model), ids_(model) {
    for (const ColmapImage& image : model.images) {
      T_c_w_.push_back(CameraInWorld(image).Inverse());
      camera_.push_back(ids_.camera.at(image.camera));
    }
  }
  /// Over the track of a point; -1 where nothing of it has a value.
  [[nodiscard]] double Mean(const ColmapPoint& point) const {
    double sum = 0.0;
    int count = 0;
    for (const ColmapTrackElement& element : point.track) {
      const std::size_t k = ids_.image.at(element.image);
      const ColmapFeature& feature = model_.images[k].features[element.feature];
      const Vector3 p_c = T_c_w_[k] * Vector3(point.xyz[0], point.xyz[1], point.xyz[2]);
      Vec<double, 2> uv;
      if (!internal::ProjectColmap(model_.cameras[camera_[k]], {{p_c[0], p_c[1], p_c[2]}}, uv))
        continue;
      const double error = std::hypot(uv[0] - feature.x, uv[1] - feature.y);
      if (!std::isfinite(error)) continue;
      sum += error;
      ++count;
    }
    return count > 0 ? sum / count : -1.0;
  }

 private:
  const ColmapModel& model_;
  ColmapIds ids_;
  std::vector<Pose> T_c_w_;
  std::vector<std::size_t> camera_;
};

Status CheckHandles(const Graph& graph, const ColmapHandles& handles, const ColmapModel& model) {
  if (handles.images.size() != model.images.size() ||
      handles.cameras.size() != model.cameras.size() ||
      handles.points.size() != model.points.size()) {
    return {StatusCode::kInvalidArgument, "UpdateFromGraph: the handles are of another model"};
  }
  const auto check = [&](const AnyVertex& vertex) -> Status {
    if (!vertex || graph.Contains(vertex)) return {};
    return graph.UnknownHandle(vertex);
  };
  for (const AnyVertex vertex : handles.images) {
    if (Status status = check(vertex); !status.ok()) return status;
  }
  for (std::size_t k = 0; k < handles.cameras.size(); ++k) {
    const AnyVertex& vertex = handles.cameras[k];
    if (!vertex) continue;
    if (Status status = check(vertex); !status.ok()) return status;
    const int dim = IntrinsicsOf(model.cameras[k].model).dim();
    const TypeInfo* type =
        dim == IntrinsicsRadial::kDim ? &kTypeInfo<VertexVector<5>> : &kTypeInfo<VertexVector<8>>;
    if (dim == 0 || vertex.type != type)
      return {StatusCode::kInvalidArgument, "UpdateFromGraph: the handles are of another model"};
  }
  for (const AnyVertex vertex : handles.points) {
    if (Status status = check(vertex); !status.ok()) return status;
  }
  return {};
}

template <int N>
void TakeIntrinsics(const Graph& graph, const AnyVertex& vertex, ColmapCamera* camera) {
  const auto handle = vertex.As<VertexVector<N>>();
  if (!handle) return;
  const VertexVector<N>& value = graph.Get(*handle);
  std::copy_n(value.value.begin(), camera->parameters.size(), camera->parameters.begin());
}

}  // namespace

Status UpdateFromGraph(const Graph& graph, const ColmapHandles& handles, ColmapModel* model) {
  return internal::OrOutOfMemory([&]() -> Status {
    if (Status status = CheckColmap(*model); !status.ok()) return status;
    if (Status status = CheckHandles(graph, handles, *model); !status.ok()) return status;
    for (std::size_t k = 0; k < handles.images.size(); ++k) {
      if (const VertexPose* pose = graph.Find(handles.images[k]))
        SetCameraInWorld(pose->pose, &model->images[k]);
    }
    for (std::size_t k = 0; k < handles.cameras.size(); ++k) {
      if (!handles.cameras[k]) continue;
      TakeIntrinsics<5>(graph, handles.cameras[k], &model->cameras[k]);
      TakeIntrinsics<8>(graph, handles.cameras[k], &model->cameras[k]);
    }
    for (std::size_t k = 0; k < handles.points.size(); ++k) {
      const VertexPointXYZ* point = graph.Find(handles.points[k]);
      if (point != nullptr) std::copy_n(point->data, 3, model->points[k].xyz);
    }
    const ReprojectionErrors errors(*model);
    for (std::size_t k = 0; k < handles.points.size(); ++k) {
      ColmapPoint& point = model->points[k];
      if (graph.Contains(handles.points[k])) point.error = errors.Mean(point);
    }
    return {};
  });
}

}  // namespace glissade
