// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "images/texture.h"

#include <cmath>
#include <numbers>
#include <opencv2/imgproc.hpp>

#include "glissade/sim/noise_source.h"
#include "glissade/vision/image.h"

namespace glissade::app {

namespace {

constexpr int kSide = 4096;
constexpr double kTexelM = 0.004;
constexpr std::uint64_t kTextureStream = 301;

std::vector<std::uint8_t> PixelsOf(const cv::Mat& grey) {
  std::vector<std::uint8_t> pixels;
  pixels.reserve(grey.total());
  for (int y = 0; y < grey.rows; ++y)
    pixels.insert(pixels.end(), grey.ptr(y), grey.ptr(y) + grey.cols);
  return pixels;
}

/// So many times larger, smooth, as a picture that goes on at its edges.
cv::Mat Enlarged(const cv::Mat& image, int times) {
  constexpr int kBorder = 2;  // what bicubic interpolation needs
  cv::Mat wrapped, large;
  cv::copyMakeBorder(image, wrapped, kBorder, kBorder, kBorder, kBorder, cv::BORDER_WRAP);
  cv::resize(wrapped, large, wrapped.size() * times, 0, 0, cv::INTER_CUBIC);
  return large(cv::Rect(kBorder * times, kBorder * times, image.cols * times, image.rows * times));
}

/// Random numbers on grids from 4 to kSide / 4 cells wide, smooth in between, those of finer grids
/// smaller; 16 bits, signed.
cv::Mat Noise(sim::NoiseSource* random) {
  double amplitude = 18.0;
  cv::Mat noise = cv::Mat::zeros(2, 2, CV_32F);
  while (noise.cols < kSide / 4) {
    noise = Enlarged(noise, 2).clone();
    for (int y = 0; y < noise.rows; ++y)
      for (int x = 0; x < noise.cols; ++x)
        noise.at<float>(y, x) += static_cast<float>(random->Uniform(-amplitude, amplitude));
    amplitude *= 0.85;
  }
  noise.convertTo(noise, CV_16S);
  return Enlarged(noise, 4);
}

constexpr double kMeanGrey = 135.0;

/// Where small things lie: on some parts of a wall many, on others few.
class Clutter {
 public:
  explicit Clutter(sim::NoiseSource* random) {
    for (double& x : density_)
      x = std::pow(random->Uniform(0.0, 1.0), 2.0);
  }
  /// 0.15 to 1 at a place in texels, bilinear.
  [[nodiscard]] double At(double x, double y) const {
    const double u = x * kCells / kSide, v = y * kCells / kSide;
    const int i = static_cast<int>(u), j = static_cast<int>(v);
    const double s = u - i, t = v - j;
    return 0.15 + 0.85 * ((1.0 - t) * ((1.0 - s) * Cell(i, j) + s * Cell(i + 1, j)) +
                          t * ((1.0 - s) * Cell(i, j + 1) + s * Cell(i + 1, j + 1)));
  }

 private:
  static constexpr int kCells = 20;
  [[nodiscard]] double Cell(int i, int j) const {
    return density_[static_cast<std::size_t>((j % kCells) * kCells + i % kCells)];
  }
  double density_[kCells * kCells];
};

/// A rectangle or an ellipse, and once more at the opposite edge for what hangs over one.
void DrawShape(double size, const Clutter* clutter, sim::NoiseSource* random, cv::Mat* image) {
  constexpr int kFraction = 4;  // bits of a coordinate behind the point
  const double a = 0.5 * size, b = a * random->Uniform(0.35, 1.0);
  const double angle = random->Uniform(0.0, std::numbers::pi);
  const double x = random->Uniform(0.0, image->cols), y = random->Uniform(0.0, image->rows);
  if (clutter != nullptr && random->Uniform(0.0, 1.0) > clutter->At(x, y)) return;
  // Some stand out and some hardly.
  const double contrast = random->Uniform(0.0, 1.0) < 0.5 ? random->Uniform(-30.0, 30.0)
                                                          : random->Uniform(-100.0, 100.0);
  const double grey = 120.0 + contrast;
  const bool ellipse = random->Uniform(0.0, 1.0) < 0.25;
  const int corners = ellipse ? 16 : 4;
  std::vector<cv::Point2d> outline;
  for (int k = 0; k < corners; ++k) {
    const double t = 2.0 * std::numbers::pi * (k + 0.5) / corners;
    const double stretch = ellipse ? 1.0 : std::numbers::sqrt2;  // corners at (+-a, +-b)
    const double ex = stretch * a * std::cos(t), ey = stretch * b * std::sin(t);
    outline.emplace_back(ex * std::cos(angle) - ey * std::sin(angle),
                         ex * std::sin(angle) + ey * std::cos(angle));
  }
  const double reach = std::hypot(a, b) + 2.0;
  std::vector<cv::Point> points(outline.size());
  for (int i = -1; i <= 1; ++i) {
    for (int j = -1; j <= 1; ++j) {
      const double cx = x + i * image->cols, cy = y + j * image->rows;
      if (cx < -reach || cy < -reach || cx > image->cols + reach || cy > image->rows + reach) {
        continue;
      }
      for (std::size_t k = 0; k < outline.size(); ++k) {
        points[k] = cv::Point(cvRound((cx + outline[k].x) * (1 << kFraction)),
                              cvRound((cy + outline[k].y) * (1 << kFraction)));
      }
      cv::fillConvexPoly(*image, points, cv::Scalar(grey), cv::LINE_AA, kFraction);
    }
  }
}

}  // namespace

Texture::Texture(const std::vector<std::uint8_t>& pixels, int side, double texel_m)
    : side_(side),
      log2_side_(std::bit_width(static_cast<unsigned>(side)) - 1),
      per_m_(static_cast<float>(1.0 / texel_m)) {
  levels_.push_back(pixels);
  cv::Mat grey(side, side, CV_8UC1, levels_[0].data());
  while (grey.cols > 4) {
    // Texel k of a version lies at texel 2k of the one before.
    cv::Mat half, wrapped;
    constexpr int kBorder = 4;
    cv::copyMakeBorder(grey, wrapped, kBorder, kBorder, kBorder, kBorder, cv::BORDER_WRAP);
    cv::pyrDown(wrapped, half);
    grey = half(cv::Rect(kBorder / 2, kBorder / 2, grey.cols / 2, grey.rows / 2)).clone();
    levels_.push_back(PixelsOf(grey));
  }
}

Texture Texture::Random(std::uint64_t seed) {
  sim::NoiseSource random(seed, kTextureStream);
  // From large to small; each scale, an octave wide, covers a part of what lies below.
  cv::Mat shapes(kSide, kSide, CV_8UC1, cv::Scalar(kMeanGrey));
  const Clutter clutter(&random);
  for (double size_m = 1.4; size_m > 0.025; size_m *= 0.5) {
    const bool large = size_m > 0.3;
    const double size = size_m / kTexelM, covered = large ? 0.35 : 0.2;
    const int count = static_cast<int>(covered * kSide * kSide / (0.6 * size * size));
    for (int k = 0; k < count; ++k) {
      DrawShape(size * random.Uniform(0.7, 1.4), large ? nullptr : &clutter, &random, &shapes);
    }
  }
  cv::Mat wrapped, image;
  constexpr int kBorder = 8;
  cv::copyMakeBorder(shapes, wrapped, kBorder, kBorder, kBorder, kBorder, cv::BORDER_WRAP);
  cv::GaussianBlur(wrapped, wrapped, cv::Size(), 0.7);
  cv::add(wrapped(cv::Rect(kBorder, kBorder, kSide, kSide)), Noise(&random), image, cv::noArray(),
          CV_8U);
  return Texture(PixelsOf(image), kSide, kTexelM);
}

Result<Texture> Texture::FromFile(const std::string& path, double width_m) {
  auto image = vision::ReadImage(path);
  if (!image.ok()) return image.status();
  cv::Mat grey(image->height, image->width, CV_8UC1, image->pixels.data());
  const int square = std::min(grey.cols, grey.rows);
  grey = grey(cv::Rect((grey.cols - square) / 2, (grey.rows - square) / 2, square, square));
  const int half =
      std::clamp(static_cast<int>(std::bit_ceil(static_cast<unsigned>(square))), 8, kSide / 2);
  cv::Mat tile;
  cv::resize(grey, tile, cv::Size(half, half), 0, 0,
             half < square ? cv::INTER_AREA : cv::INTER_LINEAR);
  cv::copyMakeBorder(tile, tile, 0, half, 0, half, cv::BORDER_REFLECT);
  return Texture(PixelsOf(tile), 2 * half, width_m / half);
}

}  // namespace glissade::app
