// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "weights.h"

#include <algorithm>
#include <string>

namespace glissade::python {

Weights::Weights(const std::optional<ArrayLike>& sqrt_information,
                 const std::optional<ArrayLike>& information, std::size_t rows,
                 std::size_t num_edges)
    : rows_(rows) {
  if (sqrt_information && information) {
    throw nb::value_error("give sqrt_information or information, not both");
  }
  if (!sqrt_information && !information) return;
  is_sqrt_ = sqrt_information.has_value();
  const char* name = is_sqrt_ ? "sqrt_information" : "information";
  const Doubles given(is_sqrt_ ? *sqrt_information : *information, name);
  const std::size_t square = rows * rows;
  const bool diagonal = given.ndim() == 0 || (given.ndim() == 1 && given.dim(0) == rows);
  if (diagonal) {
    matrices_.assign(square, 0.0);
    for (std::size_t k = 0; k < rows; ++k)
      matrices_[k * rows + k] = given.data()[given.ndim() == 0 ? 0 : k];
    return;
  }
  const std::size_t n = given.ndim();
  const bool matrix = n == 2 && given.dim(0) == rows && given.dim(1) == rows;
  const bool one_each =
      n == 3 && given.dim(0) == num_edges && given.dim(1) == rows && given.dim(2) == rows;
  if (!matrix && !one_each) {
    const std::string r = std::to_string(rows);
    std::string message(name);
    message.append(" must be a number or have the shape (").append(r).append(",), (");
    message.append(r).append(", ").append(r).append(") or (");
    message.append(std::to_string(num_edges)).append(", ").append(r).append(", ");
    message.append(r).append("), not ").append(given.Shape());
    throw nb::value_error(message.c_str());
  }
  matrices_.assign(given.data(), given.data() + given.size());
}

}  // namespace glissade::python
