// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <algorithm>
#include <span>
#include <utility>

#include "glissade/edges/marginal_prior.h"
#include "glissade/io/viowin.h"

namespace glissade {

namespace {

using Kind = ViowinMarginalPrior::Kind;

template <std::size_t N>
SquareMatrix<static_cast<int>(N)> Diagonal(const std::array<double, N>& s) {
  SquareMatrix<static_cast<int>(N)> m = SquareMatrix<static_cast<int>(N)>::Zero();
  for (std::size_t k = 0; k < N; ++k)
    m(static_cast<int>(k), static_cast<int>(k)) = s[k];
  return m;
}

Status AddStates(const ViowinWindow& window, WindowKind kind, WindowHandles* handles,
                 Graph* graph) {
  std::vector<VertexPose> poses;
  std::vector<VertexSpeedBias> speed_biases;
  std::vector<VertexInverseDepth> depths;
  poses.reserve(window.keyframes.size());
  speed_biases.reserve(window.keyframes.size());
  depths.reserve(window.landmarks.size());
  for (const ViowinKeyframe& keyframe : window.keyframes) {
    poses.push_back({keyframe.T_w_b});
    speed_biases.push_back(keyframe.speed_bias);
  }
  for (const ViowinLandmark& landmark : window.landmarks)
    depths.push_back({landmark.rho});

  const auto add = [&](const auto& values, auto* added) {
    using V = typename std::decay_t<decltype(values)>::value_type;
    auto result = graph->AddVertices(std::span<const V>(values));
    if (result.ok()) *added = std::move(result).value();
    return result.status();
  };
  if (Status s = add(poses, &handles->poses); !s.ok()) return s;
  if (kind == WindowKind::kVisualInertial) {
    if (Status s = add(speed_biases, &handles->speed_biases); !s.ok()) return s;
  }
  return add(depths, &handles->depths);
}

Status AddReprojections(const ViowinWindow& window, const Loss& loss, WindowHandles* handles,
                        Graph* graph) {
  const ViowinCamera& camera = window.camera;
  std::size_t count = 0;
  for (const ViowinLandmark& landmark : window.landmarks)
    count += landmark.observations.size();
  std::vector<EdgeReprojection> edges;
  std::vector<EdgeVertexHandles<EdgeReprojection>> vertices;
  edges.reserve(count);
  vertices.reserve(count);
  const auto normalized = [&](double u, double v) {
    return Vector2((u - camera.cx) / camera.fx, (v - camera.cy) / camera.fy);
  };
  EdgeReprojection edge;
  edge.T_b_c = window.T_b_c;
  for (std::size_t l = 0; l < window.landmarks.size(); ++l) {
    const ViowinLandmark& landmark = window.landmarks[l];
    const auto host = handles->poses[static_cast<std::size_t>(landmark.host)];
    edge.uv_host = normalized(landmark.u_host, landmark.v_host);
    for (const ViowinObservation& o : landmark.observations) {
      edge.uv_target = normalized(o.u, o.v);
      edges.push_back(edge);
      vertices.emplace_back(host, handles->poses[static_cast<std::size_t>(o.frame)],
                            handles->depths[l]);
    }
  }
  EdgeOptions<EdgeReprojection> options;
  options.sqrt_information =
      Diagonal<2>({camera.fx / camera.sigma_px, camera.fy / camera.sigma_px});
  options.loss = loss;
  auto added =
      graph->AddEdges(std::span<const EdgeReprojection>(edges),
                      std::span<const EdgeVertexHandles<EdgeReprojection>>(vertices), options);
  if (!added.ok()) return added.status();
  handles->reprojections = std::move(added).value();
  return {};
}

using PriorEdges = std::vector<std::unique_ptr<DynamicEdge>>;

/// Made before the graph is touched: their Hessians are what may want more memory than there is.
Status MakePriorEdges(const ViowinWindow& window, PriorEdges* edges) {
  for (const ViowinMarginalPrior& prior : window.marginal_priors) {
    std::vector<const VertexOps*> types;
    for (const auto& block : prior.blocks) {
      types.push_back(block.kind == Kind::kPose        ? &kVertexOps<VertexPose>
                      : block.kind == Kind::kSpeedBias ? &kVertexOps<VertexSpeedBias>
                                                       : &kVertexOps<VertexInverseDepth>);
    }
    auto edge = EdgeMarginalPrior::Create(types, prior.x0, prior.r0, prior.jacobian);
    if (!edge.ok()) return edge.status();
    edges->push_back(std::move(edge).value());
  }
  return {};
}

Status AddMarginalPrior(const ViowinMarginalPrior& prior, std::unique_ptr<DynamicEdge> edge,
                        const WindowHandles& handles, Graph* graph) {
  std::vector<AnyVertex> vertices;
  for (const auto& block : prior.blocks) {
    const auto index = static_cast<std::size_t>(block.index);
    switch (block.kind) {
      case Kind::kPose:
        vertices.emplace_back(handles.poses[index]);
        break;
      case Kind::kSpeedBias:
        vertices.emplace_back(handles.speed_biases[index]);
        break;
      case Kind::kInverseDepth:
        vertices.emplace_back(handles.depths[index]);
        break;
    }
  }
  // An edge may touch one eliminated vertex only: the depths of a prior with several are kept.
  if (std::count_if(prior.blocks.begin(), prior.blocks.end(),
                    [](const auto& b) { return b.kind == Kind::kInverseDepth; }) > 1) {
    for (const auto& block : prior.blocks) {
      if (block.kind != Kind::kInverseDepth) continue;
      const auto depth = handles.depths[static_cast<std::size_t>(block.index)];
      if (Status s = graph->SetEliminated(depth, false); !s.ok()) return s;
    }
  }
  return graph->AddEdge(std::move(edge), vertices).status();
}

Status AddInertialTerms(const ViowinWindow& window, PriorEdges priors, const WindowHandles& handles,
                        Graph* graph) {
  const auto index = [](std::int32_t i) { return static_cast<std::size_t>(i); };
  for (const ViowinSpeedBiasPrior& prior : window.speed_bias_priors) {
    const auto added =
        graph->AddEdge(EdgeSpeedBiasPrior{prior.prior}, {handles.speed_biases[index(prior.frame)]},
                       {.sqrt_information = Diagonal<9>(prior.sqrt_information)});
    if (!added.ok()) return added.status();
  }
  for (const ViowinImu& term : window.imu) {
    const auto added =
        graph->AddEdge(EdgeImu{term.imu, window.gravity},
                       {handles.poses[index(term.i)], handles.speed_biases[index(term.i)],
                        handles.poses[index(term.j)], handles.speed_biases[index(term.j)]},
                       {.sqrt_information = term.sqrt_information});
    if (!added.ok()) return added.status();
  }
  for (std::size_t k = 0; k < priors.size(); ++k) {
    if (Status s =
            AddMarginalPrior(window.marginal_priors[k], std::move(priors[k]), handles, graph);
        !s.ok()) {
      return s;
    }
  }
  return {};
}

}  // namespace

Result<WindowHandles> AddToGraph(const ViowinWindow& window, WindowKind kind,
                                 const WindowOptions& options, Graph* graph) {
  // Whatever could be refused below is refused here, so that the graph gets all or nothing.
  if (Status s = window.Validate(); !s.ok()) return s;
  if (Status s = options.loss.Validate(); !s.ok()) return s;
  if (kind != WindowKind::kVision && kind != WindowKind::kVisualInertial) {
    return Status(StatusCode::kInvalidArgument, "window: kind is no WindowKind");
  }
  PriorEdges priors;
  if (kind == WindowKind::kVisualInertial) {
    if (Status s = MakePriorEdges(window, &priors); !s.ok()) return s;
  }

  WindowHandles handles;
  if (Status s = AddStates(window, kind, &handles, graph); !s.ok()) return s;
  if (Status s = AddReprojections(window, options.loss, &handles, graph); !s.ok()) return s;
  const int bit = kind == WindowKind::kVision ? 1 : 2;
  for (const ViowinPosePrior& prior : window.pose_priors) {
    if ((prior.use & bit) == 0) continue;
    const auto added = graph->AddEdge(EdgePosePriorVec{prior.T_w_b},
                                      {handles.poses[static_cast<std::size_t>(prior.frame)]},
                                      {.sqrt_information = Diagonal<6>(prior.sqrt_information)});
    if (!added.ok()) return added.status();
  }
  if (kind == WindowKind::kVisualInertial) {
    if (Status s = AddInertialTerms(window, std::move(priors), handles, graph); !s.ok()) return s;
  }
  return handles;
}

}  // namespace glissade
