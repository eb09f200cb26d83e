// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/testing/check_jacobians.h"

#include <algorithm>
#include <cmath>
#include <vector>

#include "glissade/testing/format_number.h"
#include "glissade/testing/numeric_derivative.h"

namespace glissade::internal {

namespace {

double MaxAbs(const double* x, std::size_t n) {
  double max = 0.0;
  for (std::size_t i = 0; i < n; ++i)
    max = std::max(max, std::abs(x[i]));
  return max;
}

/// |a - b| <= tolerance for all entries; false if there is a NaN.
bool Near(const std::vector<double>& a, const double* b, double tolerance) {
  for (std::size_t i = 0; i < a.size(); ++i) {
    if (!(std::abs(a[i] - b[i]) <= tolerance)) return false;
  }
  return true;
}

std::string EntryName(int row, int column) {
  return "entry (" + std::to_string(row) + ", " + std::to_string(column) + ")";
}

/// Two evaluations of the same Jacobians are compared by the largest entry of all of them: a block
/// may be the difference of terms as large as those of another, nearly equal, and where the
/// compiler contracts the two differently (FMA), what is left differs by the rounding of these
/// terms.
class Checker {
 public:
  Checker(const EdgeUnderTest& edge, const JacobianCheckOptions& options)
      : edge_(edge), options_(options), rows_(static_cast<std::size_t>(edge.rows)) {}

  JacobianCheck Run() {
    std::size_t size = 0;
    for (int v = 0; v < edge_.vertices; ++v)
      size += rows_ * Columns(v);
    r_.resize(rows_);
    J_.resize(size);
    if (CheckResidual()) {
      const double* J = J_.data();
      for (int v = 0; v < edge_.vertices && result_.message.empty(); ++v) {
        if (CheckWritten(v, J) && CheckAlone(v, J)) CompareToNumeric(v, J);
        J += rows_ * Columns(v);
      }
    }
    if (result_.message.empty()) CheckRelative();
    for (int v = 0; v < edge_.vertices && edge_.in_packs && result_.message.empty(); ++v) {
      if (Columns(v) <= 4) CheckPacks(v);  // else it is no landmark: no run has it
    }
    result_.ok = result_.message.empty();
    return result_;
  }

 private:
  [[nodiscard]] std::size_t Columns(int vertex) const {
    return static_cast<std::size_t>(edge_.columns(vertex));
  }

  bool CheckResidual() {
    if (!edge_.evaluate(-1, -1, 0.0, ~0u, r_.data(), J_.data())) {
      return Fail("Evaluate returned false");
    }
    for (std::size_t row = 0; row < rows_; ++row) {
      if (std::isfinite(r_[row])) continue;
      return Fail("residual " + std::to_string(row) + " is not written or not finite");
    }
    std::vector<double> r(rows_);
    if (!edge_.evaluate(-1, -1, 0.0, 0u, r.data(), nullptr) || !SameResidual(r)) {
      return Fail("the residual without Jacobians differs from the one with Jacobians");
    }
    return true;
  }

  bool CheckWritten(int vertex, const double* J) {
    for (std::size_t i = 0; i < rows_ * Columns(vertex); ++i) {
      if (std::isfinite(J[i])) continue;
      return Fail(
          Name(vertex) +
          EntryName(static_cast<int>(i / Columns(vertex)), static_cast<int>(i % Columns(vertex))) +
          " is not written or not finite");
    }
    return true;
  }

  bool CheckAlone(int vertex, const double* J) {
    std::vector<double> r(rows_), alone(rows_ * Columns(vertex));
    if (!edge_.evaluate(-1, -1, 0.0, 1u << vertex, r.data(), alone.data()) || !SameResidual(r) ||
        !Near(alone, J, 1e-12 * MaxAbs(J_.data(), J_.size()))) {
      return Fail(Name(vertex) + "asked for alone it differs from all together");
    }
    return true;
  }

  bool CheckPacks(int landmark) {
    constexpr int kLanes = 24, kCount = 19;  // the last pack is not full, however wide
    const std::size_t numbers = rows_ + J_.size();
    std::vector<double> packs(numbers * kLanes, std::nan("")), single(packs);
    double steps[kLanes];
    for (int s = 0; s < kLanes; ++s)
      steps[s] = options_.step * (s - kCount / 2) / kLanes;
    const int failed = edge_.in_packs(landmark, kCount, kLanes, steps, packs.data(), single.data());
    if (failed >= 0) return Fail("no value in packs where it has one alone");
    for (int s = 0; s < kCount; ++s) {
      std::vector<double> one(numbers), other(numbers);
      for (std::size_t n = 0; n < numbers; ++n) {
        one[n] = single[n * kLanes + static_cast<std::size_t>(s)];
        other[n] = packs[n * kLanes + static_cast<std::size_t>(s)];
      }
      const auto same = [&](std::size_t begin, std::size_t count, double scale) {
        const std::vector<double> part(one.begin() + static_cast<std::ptrdiff_t>(begin),
                                       one.begin() + static_cast<std::ptrdiff_t>(begin + count));
        return Near(part, other.data() + begin, 1e-11 * scale);
      };
      if (!same(0, rows_, 1.0 + MaxAbs(one.data(), rows_))) {
        return Fail("the residual in packs differs from that of one edge");
      }
      const double largest = MaxAbs(one.data() + rows_, J_.size());
      std::size_t begin = rows_;
      for (int v = 0; v < edge_.vertices; ++v) {
        if (!same(begin, rows_ * Columns(v), largest)) {
          return Fail(Name(v) + "in packs it differs from that of one edge");
        }
        begin += rows_ * Columns(v);
      }
    }
    return true;
  }

  // Of vertices 0 and 1, whose Jacobians come first.
  bool CheckRelative() {
    if (edge_.motions.empty()) return true;
    const double* J_1 = J_.data() + rows_ * Columns(0);
    const double* motion_1 = edge_.motions.data() + 6 * Columns(0);
    const double scale = MaxAbs(J_.data(), J_.size());
    for (std::size_t row = 0; row < rows_; ++row) {
      for (std::size_t axis = 0; axis < 6; ++axis) {
        double change[2] = {};
        for (std::size_t c = 0; c < Columns(0); ++c)
          change[0] += J_[row * Columns(0) + c] * edge_.motions[6 * c + axis];
        for (std::size_t c = 0; c < Columns(1); ++c)
          change[1] += J_1[row * Columns(1) + c] * motion_1[6 * c + axis];
        if (std::abs(change[0] + change[1]) <= 1e-9 * (scale + std::abs(change[0]))) continue;
        return Fail(std::string("kFirstEstimateRule says that vertices 0 and 1 enter by their ") +
                    "relative pose or point alone, but residual " + std::to_string(row) +
                    " sees them move together");
      }
    }
    return true;
  }

  void CompareToNumeric(int vertex, const double* J) {
    const std::size_t columns = Columns(vertex);
    // A column of zeros has no scale of its own, nor has one whose terms cancel: the differences of
    // the residual have the rounding of these.
    const double floor = 1e-6 * std::max(MaxAbs(J_.data(), J_.size()), 1e-3);
    for (std::size_t column = 0; column < columns; ++column) {
      const NumericDerivative numeric = Differentiate(
          [&](double t, double* r) {
            return edge_.evaluate(vertex, static_cast<int>(column), t, 0u, r, nullptr) &&
                   std::all_of(r, r + rows_, [](double x) { return std::isfinite(x); });
          },
          edge_.rows, options_.step);
      double scale = std::max(floor, MaxAbs(numeric.value.data(), rows_));
      for (std::size_t row = 0; row < rows_; ++row) {
        scale = std::max(scale, std::abs(J[row * columns + column]));
      }
      for (std::size_t row = 0; row < rows_; ++row) {
        Record(vertex, static_cast<int>(row), static_cast<int>(column), J[row * columns + column],
               numeric.value[row], scale);
      }
    }
    if (!(result_.worst_error <= options_.tolerance)) {
      Fail(Name(result_.vertex) + EntryName(result_.row, result_.column) + " is " +
           FormatNumber(result_.analytic) + ", numerically " + FormatNumber(result_.numeric) +
           ", relative error " + FormatNumber(result_.worst_error));
    }
  }

  void Record(int vertex, int row, int column, double analytic, double numeric, double scale) {
    const double error = std::abs(analytic - numeric) / scale;
    if (result_.vertex >= 0 && error <= result_.worst_error) return;
    result_.worst_error = error;
    result_.vertex = vertex;
    result_.row = row;
    result_.column = column;
    result_.analytic = analytic;
    result_.numeric = numeric;
  }

  [[nodiscard]] bool SameResidual(const std::vector<double>& r) const {
    // Not to the bit: the compiler may contract the two evaluations differently.
    return Near(r, r_.data(), 1e-12 * (1.0 + MaxAbs(r_.data(), rows_)));
  }

  static std::string Name(int vertex) { return "Jacobian " + std::to_string(vertex) + ": "; }

  bool Fail(const std::string& message) {
    result_.message = std::string(edge_.name) + ": " + message;
    return false;
  }

  const EdgeUnderTest& edge_;
  const JacobianCheckOptions& options_;
  std::size_t rows_;
  std::vector<double> r_;  // residual and Jacobians at the point itself
  std::vector<double> J_;
  JacobianCheck result_;
};

}  // namespace

JacobianCheck RunJacobianCheck(const EdgeUnderTest& edge, const JacobianCheckOptions& options) {
  return Checker(edge, options).Run();
}

}  // namespace glissade::internal
