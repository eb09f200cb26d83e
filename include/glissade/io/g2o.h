// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "glissade/base/status.h"
#include "glissade/edges/pose_point.h"
#include "glissade/edges/relative_pose.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/se3_prior.h"
#include "glissade/graph/graph.h"
#include "glissade/losses/loss.h"

/// \file
/// Graphs of g2o (R. Kuemmerle, G. Grisetti, H. Strasdat, K. Konolige, W. Burgard, ICRA 2011):
/// pose graphs in 3-D, landmarks, bundle adjustment with known cameras. Text, an element a line, #
/// begins a comment at the beginning of a line:
///
///     PARAMS_SE3OFFSET  <id> pose                               sensor in body, T_b_s
///     VERTEX_SE3:QUAT   <id> pose                               T_w_b
///     VERTEX_TRACKXYZ   <id> x y z                              or VERTEX_XYZ
///     VERTEX_CAM        <id> pose fx fy cx cy baseline          T_w_c, looks along z
///     FIX               <id>...
///     EDGE_SE3:QUAT     <i> <j> pose I{21}                      measured T_i_j
///     EDGE_SE3_PRIOR    <i> <offset> pose I{21}                 measured T_w_s
///     EDGE_SE3_TRACKXYZ <i> <point> <offset> x y z I{6}         measured in the sensor
///     EDGE_PROJECT_P2MC <point> <camera> u v I{3}               px
///
/// pose is x y z qx qy qz qw; I the upper triangle of the information matrix by rows, of poses with
/// translation before rotation. g2o's rotation is the vector part of a quaternion, half of ours.
namespace glissade {

struct G2oOffset {
  std::int64_t id = 0;
  Pose T_b_s;

  friend bool operator==(const G2oOffset&, const G2oOffset&) = default;
};

struct G2oPose {
  std::int64_t id = 0;
  Pose T_w_b;
  bool fixed = false;

  friend bool operator==(const G2oPose&, const G2oPose&) = default;
};

struct G2oPoint {
  std::int64_t id = 0;
  double xyz[3] = {};  ///< world
  bool fixed = false;
  bool sba = false;  ///< VERTEX_XYZ, else VERTEX_TRACKXYZ; the same to us

  friend bool operator==(const G2oPoint&, const G2oPoint&) = default;
};

struct G2oCamera {
  std::int64_t id = 0;
  Pose T_w_c;
  double fx = 1.0, fy = 1.0, cx = 0.0, cy = 0.0;  ///< px
  double baseline = 0.0;                          ///< m; nothing that we read has to do with it
  bool fixed = false;

  friend bool operator==(const G2oCamera&, const G2oCamera&) = default;
};

struct G2oRelativePose {
  std::int64_t from = 0, to = 0;
  Pose T_i_j;
  std::array<double, 21> information = {};

  friend bool operator==(const G2oRelativePose&, const G2oRelativePose&) = default;
};

struct G2oPosePrior {
  std::int64_t pose = 0, offset = 0;
  Pose T_w_s;
  std::array<double, 21> information = {};

  friend bool operator==(const G2oPosePrior&, const G2oPosePrior&) = default;
};

struct G2oPointMeasurement {
  std::int64_t pose = 0, point = 0, offset = 0;
  double xyz[3] = {};  ///< in the sensor
  std::array<double, 6> information = {};

  friend bool operator==(const G2oPointMeasurement&, const G2oPointMeasurement&) = default;
};

struct G2oProjection {
  std::int64_t point = 0, camera = 0;
  double u = 0.0, v = 0.0;  ///< px
  std::array<double, 3> information = {};

  friend bool operator==(const G2oProjection&, const G2oProjection&) = default;
};

/// The content of a file, its numbers as they stand there: quaternions have unit length within 1e-2
/// (rounded in the file), and are made unit by AddToGraph, as g2o does. Ids are 0 to 2^63 - 1,
/// those of vertices unique whatever their kind.
struct G2oProblem {
  std::vector<G2oOffset> offsets;
  std::vector<G2oPose> poses;
  std::vector<G2oPoint> points;
  std::vector<G2oCamera> cameras;
  std::vector<G2oRelativePose> relative_poses;
  std::vector<G2oPosePrior> priors;
  std::vector<G2oPointMeasurement> point_measurements;
  std::vector<G2oProjection> projections;
  /// Lines with other tags, where they were to be kept.
  std::vector<std::string> other_lines;

  friend bool operator==(const G2oProblem&, const G2oProblem&) = default;
};

/// What becomes of a line whose tag is none of the above: EDGE_SE2, DATA, ...
enum class G2oOtherTags : std::uint8_t {
  kRefuse,
  kKeep,  ///< in G2oProblem::other_lines; in no graph. So is FIX of what only they may have
};

/// Reads a file, plain or compressed (told by content). All or nothing: on failure kIoError, or
/// kParseError with "file:line: what was expected, what was found"; also for an id that is there
/// twice or nowhere or of another kind, an edge from a vertex to itself, information that is not
/// positive semi-definite. Elements may come in any order.
[[nodiscard]] Result<G2oProblem> ReadG2o(const std::string& path,
                                         G2oOtherTags other = G2oOtherTags::kRefuse);

/// Writes a file, compressed if its name ends in .gz or .bz2: by kind, vertices before edges.
/// Reading it gives the same problem, to the last bit of every number. Refuses what ReadG2o would
/// not take back; then nothing is written.
Status WriteG2o(const G2oProblem& problem, const std::string& path);

/// What ReadG2o and WriteG2o ask of a problem.
[[nodiscard]] Status CheckG2o(const G2oProblem& problem);

/// Whether a file is one of g2o's by its first word: a capital letter begins it, and no number.
/// False for what cannot be read.
[[nodiscard]] bool IsG2o(const std::string& path);

struct G2oGraphOptions {
  Loss loss = {};
  /// Holds the first pose (of cameras, if there is no other) where nothing is fixed and no pose has
  /// a prior, as g2o does. The scale of bundle adjustment with one camera stays free.
  bool hold_first = true;
};

/// Where a G2oProblem went in a graph, in its order.
struct G2oHandles {
  std::vector<VertexHandle<VertexPose>> poses;
  std::vector<VertexHandle<VertexPointXYZ>> points;
  std::vector<VertexHandle<VertexPose>> cameras;  ///< T_w_c
  std::vector<EdgeHandle<EdgeRelativePose>> relative_poses;
  std::vector<EdgeHandle<EdgeSE3Prior>> priors;
  std::vector<EdgeHandle<EdgePosePoint>> point_measurements;
  std::vector<EdgeHandle<EdgeReprojectionXYZOf<CameraPinhole>>> projections;
  std::int64_t held = -1;  ///< id of the vertex that hold_first holds; -1: none
};

/// Adds all vertices and edges, or nothing: a problem that CheckG2o refuses, an impossible loss, a
/// focal length that is not positive, a prior on a sensor that is not at the body's origin
/// (kInvalidArgument: its residual is none of EdgeSE3Prior).
///
/// What is minimized is g2o's chi2 / 2 to second order in the rotation errors, and exactly so where
/// there are none:
///     EDGE_SE3_TRACKXYZ, EDGE_PROJECT_P2MC   the same residuals and information
///     EDGE_SE3:QUAT    g2o's e = [R_ij' dt, vec(dq)], ours r = [dt, Log(dq)]
///     EDGE_SE3_PRIOR   e = [R_ws' dp, R_bs' vec(dq)], r = [dp, Log(dq)]
/// vec(dq) is sin(theta / 2) times the axis, Log(dq) theta times the axis. So the information of r
/// is B' I B with B = diag(R_ij', 1/2) or diag(R_ws', R_bs' / 2): a quarter of g2o's for rotation,
/// half of it between rotation and translation. An edge whose rotation error is theta weighs more
/// with us by the factor (theta / 2)^2 / sin^2(theta / 2): 1 + 8e-4 at 0.1 rad, 1.09 at 1 rad.
[[nodiscard]] Result<G2oHandles> AddToGraph(const G2oProblem& problem, Graph& graph,
                                            const G2oGraphOptions& options = {});

/// Takes over poses and points from the graph; what is fixed in the problem, or was held, keeps its
/// numbers. Refused, with the problem unchanged: handles that the graph does not know, or that are
/// of another problem.
Status UpdateFromGraph(const Graph& graph, const G2oHandles& handles, G2oProblem* problem);

/// The problem that a graph of one's own holds, poses and then points numbered from 0 in their
/// order; AddToGraph makes the same costs of it. Losses have no place in the format and are left
/// out. kInvalidArgument: types of vertices or edges other than VertexPose, VertexPointXYZ,
/// EdgeRelativePose, EdgeSE3Prior and EdgePosePoint; a vertex that is held in part (which it
/// names).
[[nodiscard]] Result<G2oProblem> G2oFromGraph(const Graph& graph);

}  // namespace glissade
