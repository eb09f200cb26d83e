// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/fix.h"

#include <algorithm>
#include <bit>
#include <cmath>

#include "glissade/base/matrix.h"
#include "glissade/lie/pose.h"
#include "glissade/lie/so3.h"

namespace glissade {

namespace {

struct Plane {
  double a[3], b[3];  ///< unit vectors that span it
};

/// Two unit vectors orthogonal to n and to each other.
Plane PlaneOf(const double* n) {
  const Vector3 normal(n[0], n[1], n[2]);
  int smallest = 0;
  normal.cwiseAbs().minCoeff(&smallest);
  Vector3 a = normal.cross(Vector3(Vector3::Unit(smallest)));
  a.normalize();
  const Vector3 b = normal.cross(a);
  return {{a[0], a[1], a[2]}, {b[0], b[1], b[2]}};
}

}  // namespace

FreeTangent FreeTangent::At(AnyVertex vertex, Fix fix, const double* state) {
  FreeTangent tangent;
  tangent.vertex = vertex;
  tangent.fix = fix;
  if (fix == Fix::kBiases) {
    tangent.tangent_dim = 9;
    tangent.free_dim = 3;
  } else {
    tangent.free_dim = fix == Fix::kPosition ? 3 : 2;
    std::copy_n(state + 3, 4, tangent.q0);
  }
  tangent.UpdateBasis(state);
  return tangent;
}

FreeTangent FreeTangent::InChart(AnyVertex vertex, const double* q0, const double* pose) {
  FreeTangent tangent = At(vertex, Fix::kPositionAndYaw, pose);
  std::copy_n(q0, 4, tangent.q0);
  const Quaternion q(pose + 3), rotation0(q0);
  const Vector3 phi = so3::Log(Quaternion(q * rotation0.conjugate()));
  std::copy_n(phi.data(), 3, tangent.dphi);
  tangent.UpdateBasis(pose);
  return tangent;
}

FreeTangent FreeTangent::OnPlane(AnyVertex vertex, const double* normal, const double* lever,
                                 const double* pose) {
  FreeTangent tangent;
  tangent.vertex = vertex;
  tangent.fix = Fix::kCoordinate;
  tangent.free_dim = 5;
  std::copy_n(normal, 3, tangent.normal);
  std::copy_n(lever, 3, tangent.lever);
  tangent.UpdateBasis(pose);
  return tangent;
}

FreeTangent FreeTangent::Numbers(AnyVertex vertex, int tangent_dim, std::uint32_t held) {
  FreeTangent tangent;
  tangent.vertex = vertex;
  tangent.fix = Fix::kNumbers;
  tangent.tangent_dim = tangent_dim;
  tangent.free_dim = tangent_dim - std::popcount(held);
  tangent.held = held;
  tangent.UpdateBasis(nullptr);
  return tangent;
}

void FreeTangent::UpdateBasis(const double* state) {
  std::fill(std::begin(basis), std::end(basis), 0.0);
  const auto at = [&](int row, int col) -> double& { return basis[row * free_dim + col]; };
  switch (fix) {
    case Fix::kPosition:
      for (int k = 0; k < 3; ++k)
        at(3 + k, k) = 1.0;
      return;
    case Fix::kBiases:
      for (int k = 0; k < 3; ++k)
        at(k, k) = 1.0;
      return;
    case Fix::kNumbers:
      for (int k = 0, col = 0; k < tangent_dim; ++k) {
        if ((held >> k & 1u) == 0) at(k, col++) = 1.0;
      }
      return;
    case Fix::kCoordinate: {
      // n'(dp - R [l]x dtheta) = 0.
      const Plane plane = PlaneOf(normal);
      const Matrix3 R = RotationMatrix(state + 3);
      const Vector3 n(normal[0], normal[1], normal[2]), l(lever[0], lever[1], lever[2]);
      const Vector3 along = (n.transpose() * R * so3::Hat(l)).transpose();
      for (int k = 0; k < 3; ++k) {
        at(k, 0) = plane.a[k];
        at(k, 1) = plane.b[k];
        for (int c = 0; c < 3; ++c)
          at(k, 2 + c) = n[k] * along[c];
        at(3 + k, 2 + k) = 1.0;
      }
      return;
    }
    default: {
      const Quaternion rotation0(q0);
      const Vector3 phi(dphi[0], dphi[1], dphi[2]);
      const Matrix3 d_theta_d_phi = rotation0.toRotationMatrix().transpose() * so3::Jr(phi);
      for (int row = 0; row < 3; ++row) {
        for (int k = 0; k < 2; ++k)
          at(3 + row, k) = d_theta_d_phi(row, k);
      }
    }
  }
}

void FreeTangent::Plus(const double* d, double* state) {
  if (fix == Fix::kBiases) {
    for (int k = 0; k < 3; ++k)
      state[k] += d[k];
    return;
  }
  if (fix == Fix::kNumbers) {
    for (int k = 0, col = 0; k < tangent_dim; ++k) {
      if ((held >> k & 1u) == 0) state[k] += d[col++];
    }
    return;
  }
  Quaternion q(state + 3);
  const Matrix3 R = RotationMatrix(state + 3);
  if (fix == Fix::kPosition) {
    q = q * so3::ExpQuaternion(Vector3(d[0], d[1], d[2]));
  } else if (fix == Fix::kCoordinate) {
    q = q * so3::ExpQuaternion(Vector3(d[2], d[3], d[4]));
  } else {
    dphi[0] += d[0];
    dphi[1] += d[1];
    const Quaternion rotation0(q0);
    q = so3::ExpQuaternion(Vector3(dphi[0], dphi[1], dphi[2])) * rotation0;
  }
  q.normalize();
  std::copy_n(q.coeffs().data(), 4, state + 3);
  if (fix != Fix::kCoordinate) return;
  const Plane plane = PlaneOf(normal);
  const Vector3 n(normal[0], normal[1], normal[2]), l(lever[0], lever[1], lever[2]);
  const double back = n.dot((R - RotationMatrix(state + 3)) * l);
  for (int k = 0; k < 3; ++k)
    state[k] += plane.a[k] * d[0] + plane.b[k] * d[1] + n[k] * back;
}

}  // namespace glissade
