// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "glissade/edges/reprojection.h"
#include "glissade/linear/normal_equations.h"
#include "kernels/kernels.h"
#include "linear/schur_storage.h"

namespace glissade {

/// The fused path of NormalEquations: landmarks of a ReprojectionPlan, from residuals to the Schur
/// complement and back, by the kernels of kernels/reprojection.h.
///
/// Poses are linearized as twists about the position o of the plan's center, in which one 6-vector
/// per residual serves host and target; sums over landmarks are mapped to the public tangent block
/// by block, with xi = T [dp; dtheta], T = [I, [p - o]x R; 0, R].
class ReprojectionTerms {
 public:
  /// Measurements, weights and losses as arrays; once per analysis, and where weights changed.
  void Pack(const Structure& structure, const Graph& graph);

  /// Cameras at the graph's present values; then, for each chunk, what pairs of them and inverse
  /// depths make.
  void Update(const Structure& structure, const Graph& graph);
  void UpdateChunk(const Structure& structure, const Graph& graph, int chunk);
  /// T at the same values, for Linearize. Not for Cost: after a rejected step what is eliminated
  /// once more is still the old linearization.
  void UpdateMaps(const Structure& structure, const Graph& graph);
  /// Adds a chunk's part of H_pp and b_p; h and b_l of its lanes are kept here.
  double Linearize(const Structure& structure, int chunk, double* h_pp, double* b_p);
  double Cost(const Structure& structure, int chunk);
  /// H_ll and b_l per lane.
  [[nodiscard]] const std::vector<double>& h() const { return h_; }
  [[nodiscard]] const std::vector<double>& b() const { return b_; }

  /// The chunk's part of the Schur complement, in twists. Returns the lane of a landmark that
  /// cannot be eliminated, or -1.
  int Eliminate(const Structure& structure, const DampingTerm& damping, int chunk);
  /// Takes the sum over chunks to the tangent and adds it to S and b_s; places: of the plan's
  /// blocks in S. P projects partly fixed poses.
  void AddReduced(const Structure& structure, const Graph& graph, ThreadPool* threads,
                  const std::vector<BlockPlace>& places, double* S, double* b_s);
  /// y -= W H_ll^-1 W' x of a chunk, after AddReduced.
  void SubtractProduct(const Structure& structure, const double* x, int chunk, double* y);
  void BackSubstitute(const Structure& structure, const std::vector<double>& dx, int chunk,
                      double* step);
  /// sum over lanes of dl (2 W'dp + h dl): the fused landmarks' part of d'H d. T P of the last
  /// Linearize.
  double QuadraticForm(const Structure& structure, const Graph& graph,
                       const std::vector<double>& d);
  /// The edge without a finite value, for the message; -1 if all have one.
  [[nodiscard]] int FindFailed(const Graph& graph) const;

 private:
  using Host = kernels::ReprojectionHost;
  using Target = kernels::ReprojectionTarget;
  struct Camera {
    double R_wc[9];
    double c[3];  // minus o
  };
  /// 6 x 6 row-major with rows of 8.
  struct Map {
    double T[48] = {};
  };
  /// Diagonal block of H_pp and b_p of one frame, in twists.
  struct FrameSum {
    double H[36] = {};
    double g[6] = {};
    bool used = false;
    void Add(const double* H_add, const double* g_add, double sign_of_g) {
      for (int i = 0; i < 36; ++i)
        H[i] += H_add[i];
      for (int i = 0; i < 6; ++i)
        g[i] += sign_of_g * g_add[i];
      used = true;
    }
  };
  struct Chunk {
    std::vector<double> panel, reduced, blocks, twist_rhs, twists, product;
    std::vector<FrameSum> frames;
  };

  void ProjectMaps(const Structure& structure, const Graph& graph);
  void AddRhs(const Structure& structure, std::int32_t block, double* b_s) const;
  void FillTwists(const Structure& structure, const double* x, int group, int chunk);
  void Apply(const Structure& structure, const double* dx, int chunk, const double* factor,
             double* out);
  void ListExtrinsics(const ReprojectionPlan& plan, const EdgePool<EdgeReprojection>& pool);
  void UpdateCameras(const VertexPool<VertexPose>& poses);
  void UpdateHost(const ReprojectionPlan& plan, const ReprojectionGroup& group,
                  const Camera* cameras, Host* host) const;
  Host* HostOf(int group) { return &hosts_[static_cast<std::size_t>(group)]; }

  std::uint64_t analysis_ = 0;
  std::uint64_t weights_ = 0;
  std::vector<Host> hosts_;
  std::vector<Target> targets_;
  std::vector<double> x_, y_, rho_, point_, h_, b_, scale_, beta_, inverse_h_, ones_, product_;
  std::vector<double> u_, v_, mask_, sqrt_information_, huber_, force_;
  std::vector<Pose> extrinsics_;  // all different
  std::vector<std::int32_t> extrinsic_of_group_;
  std::vector<Camera> cameras_;  // of every pose, for each extrinsic
  double origin_[3] = {};
  std::vector<Map> maps_;            // T per pose block
  std::vector<Map> projected_maps_;  // T P
  std::vector<Chunk> chunks_;
};

}  // namespace glissade
