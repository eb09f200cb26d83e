// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/vision/image.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdlib>

#include "io/temp_file.h"
#include "vision/painted_wall.h"

namespace glissade::vision {
namespace {

TEST(VisionImage, PngKeepsEveryPixelAndJpegNearlyAll) {
  const TempFiles files;
  const Image image = test::SeeWall(test::SmallCamera(), Pose());
  ASSERT_TRUE(WriteImage(image.view(), files.Path("a.png")).ok());
  ASSERT_TRUE(WriteImage(image.view(), files.Path("a.jpg")).ok());
  EXPECT_EQ(files.Count(), 2);
  const auto png = ReadImage(files.Path("a.png")), jpeg = ReadImage(files.Path("a.jpg"));
  ASSERT_TRUE(png.ok()) << png.status().message();
  ASSERT_TRUE(jpeg.ok()) << jpeg.status().message();
  EXPECT_EQ(png->width, 240);
  EXPECT_EQ(png->pixels, image.pixels);
  double difference = 0.0;
  for (std::size_t k = 0; k < image.pixels.size(); ++k)
    difference += std::abs(jpeg->pixels[k] - image.pixels[k]);
  EXPECT_LT(difference / static_cast<double>(image.pixels.size()), 2.0);
}

TEST(VisionImage, WhatIsCutOffIsNamed) {
  const TempFiles files;
  const Image image = test::SeeWall(test::SmallCamera(), Pose());
  for (const char* name : {"a.png", "a.jpg"}) {
    ASSERT_TRUE(WriteImage(image.view(), files.Path(name)).ok());
    const std::string whole = files.Read(name);
    for (const double part : {0.0, 0.001, 0.3, 0.97}) {
      const auto size = static_cast<std::size_t>(part * static_cast<double>(whole.size()));
      files.Write(name, whole.substr(0, size));
      const auto read = ReadImage(files.Path(name));
      ASSERT_FALSE(read.ok()) << name << " " << part;
      EXPECT_EQ(read.status().code(), StatusCode::kParseError);
      EXPECT_NE(read.status().message().find(name), std::string::npos);
    }
  }
  EXPECT_EQ(ReadImage(files.Path("none.png")).status().code(), StatusCode::kIoError);
  EXPECT_EQ(ReadImage(files.Write("b.png", "not an image at all")).status().code(),
            StatusCode::kParseError);
}

TEST(VisionImage, WritesNothingWhereItCannot) {
  const TempFiles files;
  EXPECT_EQ(WriteImage({}, files.Path("a.png")).code(), StatusCode::kInvalidArgument);
  const Image image = test::SeeWall(test::SmallCamera(), Pose());
  EXPECT_EQ(WriteImage(image.view(), files.Path("no/such/folder/a.png")).code(),
            StatusCode::kIoError);
  EXPECT_EQ(files.Count(), 0);
}

TEST(VisionImage, ThumbnailsAreSmaller) {
  const Image image = test::SeeWall(test::SmallCamera(), Pose());
  const TempFiles files;
  const auto jpeg = EncodeJpeg(image.view(), 3);
  ASSERT_TRUE(jpeg.ok());
  files.Write("t.jpg", std::string(jpeg->begin(), jpeg->end()));
  const auto read = ReadImage(files.Path("t.jpg"));
  ASSERT_TRUE(read.ok());
  EXPECT_EQ(read->width, 80);
  EXPECT_EQ(read->height, 60);
  EXPECT_FALSE(EncodeJpeg(image.view(), 500).ok());
  EXPECT_FALSE(EncodeJpeg({}, 1).ok());
}

}  // namespace
}  // namespace glissade::vision
