// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <vector>

#include "marginal/dense_schur.h"
#include "marginal/system.h"

namespace glissade::internal {

/// Marginalization by Schur complements: landmark by landmark in products of their own rows, then
/// the dense part, then a square root of the information that is left.
class SchurForm {
 public:
  Status Run(MarginalSystem* system, const MarginalizeOptions& options, MarginalReport* report,
             std::vector<double>* r0, std::vector<double>* jacobian);

 private:
  void AddProducts(const MarginalSystem& system, const RowPanel& panel);
  void AddPrior(const MarginalSystem& system, const MarginalEdge& edge);

  RowPanel panel_;
  std::vector<double> A_, products_;
  std::vector<std::int32_t> column_of_;
  int stride_ = 0;
  DenseScratch scratch_;
  std::vector<unsigned char> weak_;
};

}  // namespace glissade::internal
