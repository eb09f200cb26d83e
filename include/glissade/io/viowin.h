// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "glissade/base/matrix.h"
#include "glissade/base/status.h"
#include "glissade/edges/imu.h"
#include "glissade/edges/pose_prior_vec.h"
#include "glissade/edges/preintegrated_imu.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/speed_bias_prior.h"
#include "glissade/graph/graph.h"
#include "glissade/lie/pose.h"
#include "glissade/losses/loss.h"
#include "glissade/vertices/inverse_depth.h"
#include "glissade/vertices/pose.h"
#include "glissade/vertices/speed_bias.h"

/// \file
/// VIOWIN files: sliding-window problems, visual and visual-inertial, as text. One file holds many
/// windows: keyframes, landmarks with their observations, priors, preintegrated IMU terms, marginal
/// priors. Poses are T_w_b; quaternions x y z w; SI units; images in pixels.
namespace glissade {

/// Pinhole without distortion: u = fx X/Z + cx, v = fy Y/Z + cy.
struct ViowinCamera {
  double fx = 1.0, fy = 1.0, cx = 0.0, cy = 0.0;  ///< px
  int width = 1, height = 1;                      ///< px
  double sigma_px = 1.0;                          ///< of an observation, each coordinate
};

struct ViowinKeyframe {
  double stamp = 0.0;  ///< s
  Pose T_w_b;
  VertexSpeedBias speed_bias;
};

struct ViowinObservation {
  std::int32_t frame = 0;
  double u = 0.0, v = 0.0;  ///< px
};

/// An inverse depth along the ray of the host's pixel, which is taken as exact.
struct ViowinLandmark {
  std::int32_t host = 0;
  double u_host = 0.0, v_host = 0.0;  ///< px
  double rho = 0.0;                   ///< 1/m, where a solve begins
  double rho_true = 0.0;              ///< 1/m
  std::vector<ViowinObservation> observations;
};

/// r = diag(s) [p - p0; 2 vec(q0^-1 q)]: EdgePosePriorVec.
struct ViowinPosePrior {
  std::int32_t frame = 0;
  int use = 3;  ///< bit 1: vision-only problem, bit 2: visual-inertial problem
  Pose T_w_b;
  std::array<double, 6> sqrt_information{};
};

/// r = diag(s) ([v ba bg] - x0): EdgeSpeedBiasPrior. Visual-inertial problem only.
struct ViowinSpeedBiasPrior {
  std::int32_t frame = 0;
  VertexSpeedBias prior;
  std::array<double, 9> sqrt_information{};
};

/// r = U e between frames i and j: EdgeImu. Visual-inertial problem only.
struct ViowinImu {
  std::int32_t i = 0, j = 0;
  PreintegratedImu imu;
  SquareMatrix<15> sqrt_information = SquareMatrix<15>::Zero();  ///< U, upper triangular
};

/// r = r0 + J (x boxminus x0): EdgeMarginalPrior. Visual-inertial problem only.
struct ViowinMarginalPrior {
  /// More than that is refused: a prior has a dense Hessian, of the square of its columns (here 128
  /// MB), however few rows, and so bytes of a file, it has.
  static constexpr std::size_t kMaxTangentDim = 4096;
  enum class Kind : char { kPose = 'p', kSpeedBias = 's', kInverseDepth = 'l' };
  struct Block {
    Kind kind = Kind::kPose;
    std::int32_t index = 0;  ///< keyframe or landmark
  };
  std::vector<Block> blocks;
  std::vector<double> x0;        ///< states of the blocks: 7, 9 or 1 numbers each
  std::vector<double> r0;        ///< rows
  std::vector<double> jacobian;  ///< rows x sum of 6, 9 or 1, row-major
};

struct ViowinWindow {
  std::int64_t id = 0;
  ViowinCamera camera;
  Pose T_b_c;                                  ///< camera in body, fixed
  Vector3 gravity = Vector3(0.0, 0.0, -9.81);  ///< acceleration in the world, m/s^2
  std::vector<ViowinKeyframe> keyframes;       ///< where a solve begins
  std::vector<ViowinKeyframe> ground_truth;    ///< one per keyframe
  std::vector<ViowinLandmark> landmarks;
  std::vector<ViowinPosePrior> pose_priors;
  std::vector<ViowinSpeedBiasPrior> speed_bias_priors;
  std::vector<ViowinImu> imu;
  std::vector<ViowinMarginalPrior> marginal_priors;

  /// What neither a file nor a graph can hold: a frame that does not exist, a number that is not
  /// finite, sigma <= 0, an IMU term from a frame to itself, sizes that do not match.
  [[nodiscard]] Status Validate() const;
};

/// Reads VIOWIN 1 and 2: plain text, .gz or .bz2 (told by content). All or nothing: on failure a
/// status whose message is "file:line: what was expected, what was found" (kIoError where the file
/// cannot be opened or decompressed, else kParseError).
[[nodiscard]] Result<std::vector<ViowinWindow>> ReadViowin(const std::string& path);

/// Writes VIOWIN 2, compressed if the name ends in .gz or .bz2, with the digits it takes: reading
/// it gives the same bits. Refuses what ReadViowin would not take back; then nothing is written.
Status WriteViowin(const std::vector<ViowinWindow>& windows, const std::string& path);

enum class WindowKind {
  kVision,          ///< poses, landmarks, pose priors with use bit 1
  kVisualInertial,  ///< everything but pose priors without use bit 2
};

struct WindowOptions {
  Loss loss = {};  ///< of the reprojections; its width in sigmas
};

/// Where a window went in a graph, in its order.
struct WindowHandles {
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexSpeedBias>> speed_biases;  ///< empty for kVision
  std::vector<VertexHandle<VertexInverseDepth>> depths;
  std::vector<EdgeHandle<EdgeReprojection>> reprojections;  ///< landmark by landmark
};

/// Adds a window, or nothing where it or the loss is refused. Reprojections are on normalized
/// coordinates with square-root information diag(fx, fy) / sigma_px: costs are the format's.
[[nodiscard]] Result<WindowHandles> AddToGraph(const ViowinWindow& window, WindowKind kind,
                                               const WindowOptions& options, Graph* graph);

}  // namespace glissade
