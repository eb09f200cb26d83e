// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <algorithm>
#include <bit>
#include <cstdint>
#include <string>
#include <vector>

#include "glissade/base/status.h"

namespace glissade::app {

/// A square grey picture that goes on for ever in both directions, and smaller and smaller versions
/// of it (a mip map: L. Williams, SIGGRAPH 1983), so that what is far away does not flicker.
class Texture {
 public:
  /// Plain grey.
  Texture() : Texture(std::vector<std::uint8_t>(64, 128), 8, 1.0) {}
  /// side x side grey values, row by row, of texels so many metres wide. The side is a power of
  /// two, at least 8.
  Texture(const std::vector<std::uint8_t>& pixels, int side, double texel_m);

  /// Corners at all scales from 3 cm to 1 m, on a wall of 16 m that repeats: rectangles and
  /// ellipses, turned anyhow, over noise of many octaves. The same seed, the same picture.
  static Texture Random(std::uint64_t seed);
  /// The middle of a picture, so many metres wide, and its mirror images beside it, so that there
  /// are no seams. The status of ReadImage.
  static Result<Texture> FromFile(const std::string& path, double width_m);

  /// The grey value at (u, v) metres, both >= 0, averaged over about width_m: between the two
  /// versions whose texels are next to that wide.
  [[nodiscard]] float At(float u_m, float v_m, float width_m) const {
    const float u = u_m * per_m_, v = v_m * per_m_, width = width_m * per_m_;
    if (!(width > 1.0f)) return Interpolated(0, u, v);
    const float level = std::min(Log2(width), static_cast<float>(levels_.size() - 1) - 1e-3f);
    const int fine = static_cast<int>(level);
    const float part = level - static_cast<float>(fine);
    const float a = Interpolated(fine, u, v), b = Interpolated(fine + 1, u, v);
    return a + part * (b - a);
  }
  [[nodiscard]] double period_m() const { return static_cast<double>(side_) / per_m_; }

 private:
  /// Log to the base of 2, to 0.09, continuous; x >= 1.
  static float Log2(float x) {
    const auto bits = std::bit_cast<std::uint32_t>(x);
    return static_cast<float>(bits) * 0x1p-23f - 127.0f;
  }
  /// Bilinearly in one version; u and v in texels of the first.
  [[nodiscard]] float Interpolated(int level, float u, float v) const {
    const std::uint8_t* pixels = levels_[static_cast<std::size_t>(level)].data();
    const int shift = log2_side_ - level, mask = (1 << shift) - 1;
    const float scale = std::bit_cast<float>(static_cast<std::uint32_t>(127 - level) << 23);
    const float x = u * scale, y = v * scale;
    const int xi = static_cast<int>(x), yi = static_cast<int>(y);
    const float fx = x - static_cast<float>(xi), fy = y - static_cast<float>(yi);
    const int x0 = xi & mask, x1 = (xi + 1) & mask;
    const std::uint8_t* row0 = pixels + ((yi & mask) << shift);
    const std::uint8_t* row1 = pixels + (((yi + 1) & mask) << shift);
    const auto mix = [](float t, int a, int b) {
      return static_cast<float>(a) + t * static_cast<float>(b - a);
    };
    const float top = mix(fx, row0[x0], row0[x1]), bottom = mix(fx, row1[x0], row1[x1]);
    return top + fy * (bottom - top);
  }

  int side_, log2_side_;
  float per_m_;  // texels
  std::vector<std::vector<std::uint8_t>> levels_;
};

}  // namespace glissade::app
