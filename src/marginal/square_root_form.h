// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <vector>

#include "marginal/staircase_qr.h"
#include "marginal/system.h"

namespace glissade::internal {

/// Marginalization by orthogonal transformations of the rows [J | r0]: H is never formed, and what
/// is lost is cond(J) and not cond(H).
///
/// 1. Landmark by landmark: QR of its own columns, in rows over the poses it touches only; the rows
///    below are the same problem without it.
/// 2. These rows, batch by batch, into one triangle over the poses that landmarks touch.
/// 3. That triangle, the rows of other edges and of older priors, each beginning where its first
///    number is: columns that go (rank-revealing), then those that stay.
class SquareRootForm {
 public:
  Status Run(MarginalSystem* system, const MarginalizeOptions& options, MarginalReport* report,
             std::vector<double>* r0, std::vector<double>* jacobian);

 private:
  Status EliminateLandmarks(MarginalSystem* system, double cut, MarginalReport* report);
  void FindLandmarkColumns(const MarginalSystem& system);
  void Compress();
  Status LinearizeOthers(MarginalSystem* system);
  void StackRows(const MarginalSystem& system);
  void AddSource(const RowPanel& panel, const MarginalSystem& system);

  RowPanel landmark_panel_;
  std::vector<RowPanel> other_panels_;
  int num_others_ = 0;
  /// The triangle of landmark rows: variables and their columns, new rows waiting to be merged.
  std::vector<RowPanel::Part> landmark_parts_;
  std::vector<std::int32_t> local_column_;  // of a variable among these columns, -1
  int landmark_columns_ = 0;
  StaircaseQr batch_;
  std::vector<double> triangle_;  // rows as in batch_
  int triangle_rows_ = 0;
  std::vector<double> waiting_;
  std::vector<std::int32_t> waiting_begin_, waiting_order_, count_;
  int waiting_rows_ = 0;
  double squared_rest_ = 0.0;
  double rounding_ = 0.0;  ///< of a column's length

  StaircaseQr stack_;
  struct Source {
    const double* row;
    const RowPanel::Part* parts;
    std::int32_t num_parts;
    std::int32_t residual;  ///< column of r0 in the row
    std::int32_t begin;     ///< in the stack
  };
  std::vector<Source> sources_;
  QrScratch scratch_;
  std::vector<std::int32_t> deficient_;
};

}  // namespace glissade::internal
