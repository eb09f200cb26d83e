// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/colmap.h"

#include <gtest/gtest.h>

#include <cstring>
#include <filesystem>
#include <limits>

#include "io/temp_file.h"
#include "support/colmap_scene.h"

namespace glissade {
namespace {

constexpr const char* kFiles[3] = {"cameras", "images", "points3D"};

/// As COLMAP writes it: comments first, and an empty line where an image has no features.
const char* const kCameras = R"(# Camera list with one line of data per camera:
#   CAMERA_ID, MODEL, WIDTH, HEIGHT, PARAMS[]
# Number of cameras: 2
1 SIMPLE_RADIAL 3072 2304 2559.81 1536 1152 -0.0204997
4 OPENCV 640 480 500 501 320 240 0.1 -0.2 +1e-3 2E-4
)";
const char* const kImages = R"(# Image list with two lines of data per image:
# IMAGE_ID, QW, QX, QY, QZ, TX, TY, TZ, CAMERA_ID, NAME
7 0.851773 0.0165051 0.503764 -0.142941 -0.737434 1.02973 3.74354 1 P1180141.JPG
2362.39 248.498 58396 1784.7 268.254 -1 1784.7 268.254 59027
2 1 0 0 0 0 0 0 4 sub/P1180142.JPG
1190.83 663.957 58396
9 1 0 0 0 1 2 3 1 empty.jpg

)";
const char* const kPoints = R"(# 3D point list
59027 1 2 3 0 128 255 -1 7 2
58396 1.67241 0.292931 0.609726 115 121 122 1.33927 7 0 2 0
)";

class Colmap : public testing::Test {
 protected:
  /// Writes the sample into a folder, one file of it replaced.
  std::string Folder(int replaced = -1, const std::string& content = "") const {
    const char* const texts[3] = {kCameras, kImages, kPoints};
    std::filesystem::create_directories(files_.Path("model"));
    for (int k = 0; k < 3; ++k) {
      static_cast<void>(files_.Write("model/" + std::string(kFiles[k]) + ".txt",
                                     k == replaced ? content : std::string(texts[k])));
    }
    return files_.Path("model");
  }
  std::string Bytes(const std::string& folder, int file, const char* ending) const {
    return files_.Read(folder + "/" + kFiles[file] + ending);
  }

  TempFiles files_;
};

/// As operator==, but every number in its bits.
bool SameBits(const ColmapModel& a, const ColmapModel& b) {
  if (!(a == b)) return false;
  const auto same = [](const void* x, const void* y, std::size_t size) {
    return std::memcmp(x, y, size) == 0;
  };
  for (std::size_t k = 0; k < a.cameras.size(); ++k) {
    const auto &x = a.cameras[k].parameters, &y = b.cameras[k].parameters;
    if (!same(x.data(), y.data(), sizeof(double) * x.size())) return false;
  }
  for (std::size_t k = 0; k < a.images.size(); ++k) {
    const ColmapImage &x = a.images[k], &y = b.images[k];
    if (!same(x.q, y.q, sizeof(x.q)) || !same(x.t, y.t, sizeof(x.t))) return false;
    if (!x.features.empty() &&
        !same(x.features.data(), y.features.data(), sizeof(ColmapFeature) * x.features.size())) {
      return false;
    }
  }
  for (std::size_t k = 0; k < a.points.size(); ++k) {
    const ColmapPoint &x = a.points[k], &y = b.points[k];
    if (!same(x.xyz, y.xyz, sizeof(x.xyz)) || !same(&x.error, &y.error, sizeof(double)))
      return false;
  }
  return true;
}

/// All camera models, and numbers that are hard to write.
ColmapModel HardModel() {
  test::ColmapSceneOptions options;
  options.cameras.clear();
  for (int k = 0; k < kNumColmapCameraModels; ++k)
    options.cameras.push_back(ColmapCameraModel{k});
  options.images = 13;
  ColmapModel model = test::MakeColmapScene(options, 3);
  model.cameras[10].parameters = {1.0 / 3,
                                  5e-324,
                                  -0.0,
                                  std::numeric_limits<double>::max(),
                                  std::numeric_limits<double>::min(),
                                  -std::numeric_limits<double>::denorm_min(),
                                  0.1,
                                  1e23,
                                  std::nextafter(1.0, 2.0),
                                  -1e-300,
                                  123456789.123456789,
                                  9007199254740993.0};
  model.cameras[0].width = std::numeric_limits<std::int64_t>::max();
  model.images[0].q[0] *= 1.5;  // as it is, also where it is not unit
  ColmapImage none{4294967294u,         {0, 0, 0, -1},     {-0.0, 1e-310, 3},
                   model.cameras[2].id, "no_features.png", {}};
  model.images.insert(model.images.begin() + 2, none);
  ColmapPoint lonely;  // without a track
  lonely.id = std::numeric_limits<std::int64_t>::max();
  model.points.insert(model.points.begin(), lonely);
  return model;
}

TEST_F(Colmap, ReadsText) {
  const auto model = ReadColmap(Folder());
  ASSERT_TRUE(model.ok()) << model.status().message();
  ASSERT_EQ(model->cameras.size(), 2u);
  EXPECT_EQ(
      model->cameras[0],
      (ColmapCamera{
          1, ColmapCameraModel::kSimpleRadial, 3072, 2304, {2559.81, 1536, 1152, -0.0204997}}));
  EXPECT_EQ(model->cameras[1].model, ColmapCameraModel::kOpenCv);
  EXPECT_EQ(model->cameras[1].parameters[6], 1e-3);
  ASSERT_EQ(model->images.size(), 3u);
  EXPECT_EQ(model->images[0].id, 7u);
  EXPECT_EQ(model->images[0].q[3], -0.142941);
  EXPECT_EQ(model->images[0].t[2], 3.74354);
  EXPECT_EQ(model->images[0].camera, 1u);
  EXPECT_EQ(model->images[0].name, "P1180141.JPG");
  ASSERT_EQ(model->images[0].features.size(), 3u);
  EXPECT_EQ(model->images[0].features[1], (ColmapFeature{1784.7, 268.254, -1}));
  EXPECT_EQ(model->images[1].name, "sub/P1180142.JPG");
  EXPECT_EQ(model->images[1].features[0].point, 58396);
  EXPECT_TRUE(model->images[2].features.empty());
  ASSERT_EQ(model->points.size(), 2u);
  EXPECT_EQ(model->points[0].rgb[2], 255);
  EXPECT_EQ(model->points[0].error, -1.0);
  EXPECT_EQ(model->points[1].xyz[1], 0.292931);
  EXPECT_EQ(model->points[1].track, (std::vector<ColmapTrackElement>{{7, 0}, {2, 0}}));
}

TEST_F(Colmap, ReadsBinaryByteByByte) {
  // Put together by hand from the description of the format.
  std::string cameras, images, points;
  const auto put = [](std::string& to, auto x) {
    to.append(reinterpret_cast<const char*>(&x), sizeof(x));
  };
  put(cameras, std::uint64_t{1});
  put(cameras, std::uint32_t{3});
  put(cameras, std::int32_t{1});
  put(cameras, std::uint64_t{640});
  put(cameras, std::uint64_t{480});
  for (const double x : {500.0, 501.0, 320.0, 240.0})
    put(cameras, x);
  put(images, std::uint64_t{1});
  put(images, std::uint32_t{8});
  for (const double x : {1.0, 0.0, 0.0, 0.0, 0.5, -0.5, 2.0})
    put(images, x);
  put(images, std::uint32_t{3});
  images.append("with space.png");
  images.push_back('\0');
  put(images, std::uint64_t{2});
  put(images, 10.5);
  put(images, 20.5);
  put(images, ~std::uint64_t{0});
  put(images, 11.5);
  put(images, 21.5);
  put(images, std::uint64_t{77});
  put(points, std::uint64_t{1});
  put(points, std::uint64_t{77});
  for (const double x : {1.0, 2.0, 3.0})
    put(points, x);
  points.append("\x01\x80\xff");
  put(points, 0.25);
  put(points, std::uint64_t{1});
  put(points, std::uint32_t{8});
  put(points, std::uint32_t{1});
  std::filesystem::create_directories(files_.Path("m"));
  static_cast<void>(files_.Write("m/cameras.bin", cameras));
  static_cast<void>(files_.Write("m/images.bin", images));
  static_cast<void>(files_.Write("m/points3D.bin", points));

  const auto model = ReadColmap(files_.Path("m"));
  ASSERT_TRUE(model.ok()) << model.status().message();
  ColmapModel expected;
  expected.cameras = {{3, ColmapCameraModel::kPinhole, 640, 480, {500, 501, 320, 240}}};
  expected.images = {{8,
                      {1, 0, 0, 0},
                      {0.5, -0.5, 2.0},
                      3,
                      "with space.png",
                      {{10.5, 20.5, -1}, {11.5, 21.5, 77}}}};
  expected.points = {{77, {1, 2, 3}, {1, 128, 255}, 0.25, {{8, 1}}}};
  EXPECT_TRUE(SameBits(model.value(), expected));
  // And the writer makes the same bytes of it.
  ASSERT_TRUE(WriteColmap(expected, files_.Path("n")).ok());
  EXPECT_EQ(Bytes("n", 0, ".bin"), cameras);
  EXPECT_EQ(Bytes("n", 1, ".bin"), images);
  EXPECT_EQ(Bytes("n", 2, ".bin"), points);
  // In text its name would be two.
  const Status text = WriteColmap(expected, files_.Path("t"), ColmapFormat::kText);
  EXPECT_EQ(text.code(), StatusCode::kInvalidArgument);
  EXPECT_FALSE(std::filesystem::exists(files_.Path("t")));
}

TEST_F(Colmap, RoundTripsKeepEveryBit) {
  const ColmapModel model = HardModel();
  ASSERT_TRUE(CheckColmap(model).ok()) << CheckColmap(model).message();
  ASSERT_TRUE(WriteColmap(model, files_.Path("text"), ColmapFormat::kText).ok());
  ASSERT_TRUE(WriteColmap(model, files_.Path("a/b/binary")).ok());
  EXPECT_EQ(FindColmapFormat(files_.Path("text")).value(), ColmapFormat::kText);
  EXPECT_EQ(FindColmapFormat(files_.Path("a/b/binary")).value(), ColmapFormat::kBinary);
  for (const char* folder : {"text", "a/b/binary"}) {
    const auto back = ReadColmap(files_.Path(folder));
    ASSERT_TRUE(back.ok()) << back.status().message();
    EXPECT_TRUE(SameBits(back.value(), model)) << folder;
  }
  // Nothing else is left in the folders.
  EXPECT_EQ(std::distance(std::filesystem::directory_iterator(files_.Path("text")), {}), 3);
}

TEST_F(Colmap, RigsAndFramesStay) {
  const std::string folder = Folder();
  static_cast<void>(files_.Write("model/rigs.txt", "rigs"));
  static_cast<void>(files_.Write("model/frames.txt", "frames"));
  const auto model = ReadColmap(folder);
  ASSERT_TRUE(model.ok()) << model.status().message();
  ASSERT_TRUE(WriteColmap(model.value(), folder, ColmapFormat::kText).ok());
  EXPECT_EQ(files_.Read("model/rigs.txt"), "rigs");
  EXPECT_EQ(files_.Read("model/frames.txt"), "frames");
  EXPECT_TRUE(SameBits(ReadColmap(folder).value(), model.value()));
}

TEST_F(Colmap, BinaryGoesBeforeText) {
  const std::string folder = Folder();
  const ColmapModel other = HardModel();
  ASSERT_TRUE(WriteColmap(other, folder).ok());
  EXPECT_TRUE(SameBits(ReadColmap(folder).value(), other));
  // Text would not be read back from there.
  const std::string before = Bytes("model", 0, ".txt");
  EXPECT_EQ(WriteColmap(other, folder, ColmapFormat::kText).code(), StatusCode::kInvalidArgument);
  EXPECT_EQ(Bytes("model", 0, ".txt"), before);
}

TEST_F(Colmap, FoldersWithoutAModel) {
  EXPECT_EQ(ReadColmap(files_.Path("nowhere")).status().code(), StatusCode::kIoError);
  std::filesystem::create_directories(files_.Path("model"));
  static_cast<void>(files_.Write("model/cameras.txt", kCameras));
  const Status status = ReadColmap(files_.Path("model")).status();
  EXPECT_EQ(status.code(), StatusCode::kIoError);
  EXPECT_NE(status.message().find("no COLMAP model"), std::string::npos) << status.message();
  static_cast<void>(files_.Write("file", "x"));
  EXPECT_EQ(WriteColmap(HardModel(), files_.Path("file")).code(), StatusCode::kIoError);
  std::filesystem::create_directories(files_.Path("c/cameras.bin"));
  EXPECT_EQ(WriteColmap(HardModel(), files_.Path("c")).code(), StatusCode::kIoError);
}

TEST_F(Colmap, WhatIsWrongInTextIsNamedWithFileAndLine) {
  const struct {
    int file, line;
    const char* replacement;
    const char* message;
  } cases[] = {
      {0, 4, "1 SIMPLE_RADIAL 3072 2304 2559.81 1536 1152",
       "cameras.txt:5: expected parameter 4 of camera 1 (SIMPLE_RADIAL, 4 parameters)"},
      {0, 4, "1 SIMPLE_RADIAL 3072 2304 2559.81 1536 1152 0 5",
       "cameras.txt:4: expected the end of the line of camera 1 (SIMPLE_RADIAL, 4 parameters), "
       "found '5'"},
      {0, 4, "1 SIMPLE_RADIALS 3072 2304 1 2 3 4",
       "cameras.txt:4: expected a camera model, found 'SIMPLE_RADIALS'"},
      {0, 4, "1 SIMPLE_RADIAL -1 2304 1 2 3 4",
       "cameras.txt:4: expected width of camera 1 (at least 0), found '-1'"},
      {0, 4, "1 SIMPLE_RADIAL 3072 2304 nan 2 3 4",
       "cameras.txt:4: expected parameter of camera 1 (a finite number), found 'nan'"},
      {0, 4, "4294967295 PINHOLE 3072 2304 1 2 3 4",
       "cameras.txt:4: expected id of a camera (at least 0), found '4294967295'"},
      {0, 4, "4 PINHOLE 3072 2304 1 2 3 4", "cameras.txt:5: a second camera 4"},
      {0, 5, "", "images.txt:5: image 2 is by camera 4, which there is not"},
      {1, 3, "7 0.8 0.0 0.5 -0.1 -0.7 1.02973 3.74354 1 P 1180141.JPG",
       "images.txt:3: expected the end of the line of image 7, found '1180141.JPG'"},
      {1, 3, "7 0.8 0.0 0.5 -0.1 -0.7 1.02973 3.74354 1",
       "images.txt:4: image 7 goes on in line 4: it has one"},
      {1, 3, "7 0 0 0 0 0 0 0 1 a", "images.txt:3: the quaternion of image 7 cannot be made unit"},
      {1, 3, "7 1 0 0 inf 0 0 0 1 a",
       "images.txt:3: expected quaternion of image 7 (a finite number), found 'inf'"},
      {1, 3, "2 1 0 0 0 0 0 0 1 a", "images.txt:5: a second image 2"},
      {1, 4, "2362.39 248.498 58396 1784.7 268.254 -2",
       "images.txt:4: expected point of a feature of image 7 (at least -1), found '-2'"},
      {1, 4, "2362.39 248.498 58396 1784.7 268.254",
       "images.txt:5: image 7 goes on in line 5: it has one"},
      {1, 4, "2362.39 248.498 58396 1784.7 268.254 58396 1784.7 268.254 59027",
       "images.txt:4: feature 1 of image 7 is point 58396, whose track does not have it"},
      {1, 4, "2362.39 248.498 58396 1784.7 268.254 123 1784.7 268.254 59027",
       "images.txt:4: feature 1 of image 7 is point 123, which there is not"},
      {2, 2, "59027 1 2 3 0 128 256 -1 7 2",
       "points3D.txt:2: expected color of point 59027 (0 to 255), found '256'"},
      {2, 2, "59027 1 2 3 0 128 255 -1 7", "points3D.txt:3: point 59027 goes on in line 3: it has"},
      {2, 2, "59027 1 2 3 0 128 255 -1 70 2",
       "points3D.txt:2: point 59027 is in image 70, which there is not"},
      {2, 2, "59027 1 2 3 0 128 255 -1 7 3",
       "points3D.txt:2: point 59027 is feature 3 of image 7, which has 3"},
      {2, 2, "59027 1 2 3 0 128 255 -1 7 1",
       "points3D.txt:2: point 59027 is feature 1 of image 7, which is point -1"},
      {2, 2, "59027 1 2 3 0 128 255 -1 7 2 7 2",
       "points3D.txt:2: point 59027 has feature 2 of image 7 twice"},
      {2, 2, "58396 1 2 3 0 128 255 -1 7 0", "points3D.txt:3: a second point 58396"},
      {2, 2, "59027 1 2 3 0 128 255 1e999 7 2", "points3D.txt:2: expected error of point 59027"},
      {2, 2, "-1 1 2 3 0 128 255 -1 7 2", "points3D.txt:2: expected id of a point"},
      {2, 2, "", "images.txt:4: feature 2 of image 7 is point 59027, which there is not"},
  };
  const char* const texts[3] = {kCameras, kImages, kPoints};
  for (const auto& c : cases) {
    std::string text = texts[c.file];
    std::size_t begin = 0;
    for (int k = 1; k < c.line; ++k)
      begin = text.find('\n', begin) + 1;
    text.replace(begin, text.find('\n', begin) - begin, c.replacement);
    const auto model = ReadColmap(Folder(c.file, text));
    ASSERT_FALSE(model.ok()) << c.message;
    EXPECT_EQ(model.status().code(), StatusCode::kParseError);
    EXPECT_NE(model.status().message().find(c.message), std::string::npos)
        << model.status().message() << "\nwanted: " << c.message;
    EXPECT_TRUE(model.value() == ColmapModel{});
  }
}

TEST_F(Colmap, WhatIsWrongInBinaryIsNamedWithFileAndByte) {
  const ColmapModel sample = ReadColmap(Folder()).value();
  ASSERT_TRUE(WriteColmap(sample, files_.Path("b")).ok());
  // Absurd counts are refused before anything is reserved for them.
  const struct {
    int file;
    std::size_t offset;
    std::uint64_t value;
    int size;
    const char* message;
  } cases[] = {
      {0, 0, std::uint64_t{1} << 60, 8, "cameras.bin:byte 0: 1152921504606846976 as number of"},
      {0, 0, 3, 8, "cameras.bin:byte 152: expected id of a camera, found the end of the file"},
      {0, 0, 1, 8, "cameras.bin:byte 64: expected the end of the file"},
      {0, 12, 11, 4, "cameras.bin:byte 12: camera model 11 is unknown"},
      {0, 12, 0xFFFFFFFFu, 4, "cameras.bin:byte 12: camera model -1 is unknown"},
      {0, 8, 0xFFFFFFFFu, 4, "cameras.bin:byte 8: id 4294967295 means no camera"},
      {0, 32, 0x7FF0000000000000u, 8, "cameras.bin:byte 32: parameter of a camera is not finite"},
      {1, 0, ~std::uint64_t{0}, 8, "images.bin:byte 0: 18446744073709551615 as number of images"},
      {1, 12, 0x7FF8000000000001u, 8, "images.bin:byte 12: quaternion of an image is not finite"},
      {1, 68, 3, 4, "images.bin:byte 8: image 7 is by camera 3, which there is not"},
      {1, 85, 1u << 30, 8, "images.bin:byte 85: 1073741824 as number of features, but"},
      {1, 109, 0x8000000000000000u, 8,
       "images.bin:byte 109: 9223372036854775808 is no id of a point"},
      {1, 109, 5, 8, "points3D.bin:byte 67: point 58396 is feature 0 of image 7, which is point 5"},
      {2, 51, 1u << 29, 8, "points3D.bin:byte 51: 536870912 as length of a track, but"},
      {2, 59, 8, 4, "points3D.bin:byte 8: point 59027 is in image 8, which there is not"},
  };
  for (const auto& c : cases) {
    std::filesystem::create_directories(files_.Path("m"));
    for (int k = 0; k < 3; ++k) {
      std::string bytes = Bytes("b", k, ".bin");
      for (int i = 0; k == c.file && i < c.size; ++i)
        bytes[c.offset + static_cast<std::size_t>(i)] = static_cast<char>(c.value >> (8 * i));
      static_cast<void>(files_.Write("m/" + std::string(kFiles[k]) + ".bin", bytes));
    }
    const auto model = ReadColmap(files_.Path("m"));
    ASSERT_FALSE(model.ok()) << c.message;
    EXPECT_EQ(model.status().code(), StatusCode::kParseError);
    EXPECT_NE(model.status().message().find(c.message), std::string::npos)
        << model.status().message() << "\nwanted: " << c.message;
  }
}

TEST_F(Colmap, AnyFileThatIsCutOrFlippedIsReadWholeOrRefused) {
  test::ColmapSceneOptions options;
  options.images = 3;
  options.points = 6;
  options.cameras = {ColmapCameraModel::kSimpleRadial, ColmapCameraModel::kOpenCv};
  const ColmapModel model = test::MakeColmapScene(options, 5);
  test::Random random(17);
  for (const ColmapFormat format : {ColmapFormat::kBinary, ColmapFormat::kText}) {
    const char* ending = format == ColmapFormat::kText ? ".txt" : ".bin";
    const std::string good = format == ColmapFormat::kText ? "text" : "binary";
    ASSERT_TRUE(WriteColmap(model, files_.Path(good), format).ok());
    int refused = 0, trials = 0;
    std::filesystem::remove_all(files_.Path("bad"));
    std::filesystem::copy(files_.Path(good), files_.Path("bad"));
    const auto try_bytes = [&](int file, const std::string& bytes) {
      static_cast<void>(files_.Write("bad/" + std::string(kFiles[file]) + ending, bytes));
      ++trials;
      const auto result = ReadColmap(files_.Path("bad"));
      if (result.ok()) {
        EXPECT_TRUE(CheckColmap(result.value()).ok());
        return;
      }
      ++refused;
      EXPECT_TRUE(result.value() == ColmapModel{});
      EXPECT_FALSE(result.status().message().empty());
    };
    for (int file = 0; file < 3; ++file) {
      const std::string bytes = Bytes(good, file, ending);
      for (std::size_t size = 0; size < bytes.size(); size += 1 + bytes.size() / 150) {
        try_bytes(file, bytes.substr(0, size));
        if (format == ColmapFormat::kBinary) {
          EXPECT_EQ(refused, trials) << kFiles[file] << " cut at " << size;
        }
      }
      refused = trials = 0;
      for (int trial = 0; trial < 200; ++trial) {
        std::string flipped = bytes;
        for (int flips = 0; flips <= trial % 3; ++flips) {
          const auto at =
              static_cast<std::size_t>(random.Uniform(0, static_cast<double>(bytes.size())));
          const auto bit = static_cast<unsigned>(random.Uniform(0, 8));
          flipped[at] = static_cast<char>(static_cast<unsigned char>(flipped[at]) ^ (1u << bit));
        }
        try_bytes(file, flipped);
      }
      EXPECT_GT(refused, 10) << kFiles[file] << ending;
      static_cast<void>(files_.Write("bad/" + std::string(kFiles[file]) + ending, bytes));
      refused = trials = 0;
    }
  }
}

TEST_F(Colmap, WritersRefuseWhatReadersWould) {
  const auto refuse = [&](const char* what, auto change) {
    ColmapModel model = HardModel();
    change(model);
    const Status status = WriteColmap(model, files_.Path("refused"));
    EXPECT_EQ(status.code(), StatusCode::kInvalidArgument) << what;
    EXPECT_NE(status.message().find(what), std::string::npos) << status.message();
    EXPECT_FALSE(std::filesystem::exists(files_.Path("refused")));
  };
  refuse("has 3 parameters, PINHOLE has 4",
         [](ColmapModel& m) { m.cameras[1].parameters.pop_back(); });
  refuse("unknown model", [](ColmapModel& m) { m.cameras[1].model = ColmapCameraModel{77}; });
  refuse("is not finite", [](ColmapModel& m) {
    m.images[1].features[0].x = std::numeric_limits<double>::quiet_NaN();
  });
  refuse("the error of point",
         [](ColmapModel& m) { m.points[2].error = std::numeric_limits<double>::infinity(); });
  refuse("character 0", [](ColmapModel& m) { m.images[0].name.push_back('\0'); });
  refuse("which there is not", [](ColmapModel& m) { m.images[0].camera = 7; });
  refuse("whose track does not have it", [](ColmapModel& m) { m.points[3].track.pop_back(); });
  refuse("above 2^63 - 1", [](ColmapModel& m) { m.cameras[0].width = ~std::uint64_t{0}; });
}

}  // namespace
}  // namespace glissade
