// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <ceres/manifold.h>

#include <memory>

#include "glissade/vertices/concept.h"

/// \file
/// Vertex types as Ceres sees them. A Ceres parameter block holds a vertex's ambient state as
/// Data() gives it: a VertexPose is px py pz qx qy qz qw.
namespace glissade::bridge {

/// d(x boxplus d)/dd at d = 0, row-major ambient_dim x tangent_dim. Exact for glissade's own vertex
/// types, otherwise by extrapolated central differences of Plus (about 1e-12 relative).
void PlusJacobian(const VertexOps& ops, const double* x, double* jacobian);

/// d(y boxminus x)/dy at y = x, row-major tangent_dim x ambient_dim. For vertex types that are not
/// glissade's own it is the pseudo-inverse of PlusJacobian: in either case the product
/// MinusJacobian * PlusJacobian is the identity to rounding, and this is what matters when a
/// tangent Jacobian travels through Ceres, which wants ambient ones and projects them back.
void MinusJacobian(const VertexOps& ops, const double* x, double* jacobian);

/// The vertex type as a ceres::Manifold; null where it is additive, as Ceres takes it.
std::unique_ptr<ceres::Manifold> MakeManifold(const VertexOps& ops);

}  // namespace glissade::bridge
