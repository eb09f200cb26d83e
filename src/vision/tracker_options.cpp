// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/tracker_options.h"

#include <string>

namespace glissade::vision {

namespace {

Status Between(double x, double low, double high, const char* name) {
  if (x >= low && x <= high) return {};
  return {StatusCode::kInvalidArgument, std::string(name)
                                            .append(" must be from ")
                                            .append(std::to_string(low))
                                            .append(" to ")
                                            .append(std::to_string(high))
                                            .append(", is ")
                                            .append(std::to_string(x))};
}

}  // namespace

Status TrackerOptions::Validate() const {
  if (Status s = Between(max_features, 1, 100000, "max_features"); !s.ok()) return s;
  if (Status s = Between(cell_px, 8, 1000, "cell_px"); !s.ok()) return s;
  if (Status s = Between(min_relative_corner, 0, 1, "min_relative_corner"); !s.ok()) return s;
  if (Status s = Between(min_corner, 1e-3, 1e6, "min_corner"); !s.ok()) return s;
  if (Status s = Between(contrast_limit, 0, 100, "contrast_limit"); !s.ok()) return s;
  if (Status s = Between(window_px, 5, 61, "window_px"); !s.ok()) return s;
  if (window_px % 2 == 0) return {StatusCode::kInvalidArgument, "window_px must be odd"};
  if (Status s = Between(levels_predicted, 0, 8, "levels_predicted"); !s.ok()) return s;
  if (Status s = Between(levels_blind, 0, 8, "levels_blind"); !s.ok()) return s;
  if (Status s = Between(max_forward_backward_px, 1e-3, 100, "max_forward_backward_px"); !s.ok()) {
    return s;
  }
  if (Status s = Between(max_epipolar_px, 1e-2, 100, "max_epipolar_px"); !s.ok()) return s;
  if (Status s = Between(max_stereo_epipolar_px, 1e-2, 100, "max_stereo_epipolar_px"); !s.ok()) {
    return s;
  }
  if (Status s = Between(min_depth_m, 1e-3, 1e3, "min_depth_m"); !s.ok()) return s;
  if (Status s = Between(min_contrast, 0, 127, "min_contrast"); !s.ok()) return s;
  return Between(max_blind_s, 0, 1e3, "max_blind_s");
}

}  // namespace glissade::vision
