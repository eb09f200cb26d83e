// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/viotracks.h"

#include <gtest/gtest.h>

#include <filesystem>
#include <string>

#include "common/data_dir.h"
#include "io/temp_file.h"

namespace glissade {
namespace {

constexpr const char* kCalibration = R"({
 "format": "VIOTRACKS 1",
 "origin": "a \"test\" \u00e9",
 "gravity": [0, 0, -9.81],
 "cameras": [
  {"fx": 400, "fy": 410.5, "cx": 320, "cy": 240, "width": 640, "height": 480, "sigma_px": 0.5,
   "T_B_C": [0, -1, 0, 0.1,  1, 0, 0, 0.2,  0, 0, 1, 0.3,  0, 0, 0, 1]}
 ],
 "imu": {"rate_hz": 200, "gyro_noise_density": 1e-4, "accel_noise_density": 2e-3,
         "gyro_random_walk": 1e-5, "accel_random_walk": 3e-3}
}
)";
constexpr const char* kFrames = "#frame_id,timestamp_ns\n3,1000\n5,2000\n";
constexpr const char* kTracks = "#c\n3,7,0,1.5,2.5\n5,7,0,-1.5,2e1\n";
constexpr const char* kImu = "1000,0.1,0.2,0.3,1,2,3\r\n 2000 , 0.1,0.2,0.3,1,2,-3";
constexpr const char* kTruth =
    "1000,1,2,3, 0.5,0.5,0.5,0.5, 4,5,6, 0.1,0.2,0.3, 0.7,0.8,0.9\n2000,1,2,3,1,0,0,0,0,0,0,0,0,0,"
    "0,0,0\n";

/// A folder with all files, one of them replaced.
class Folder {
 public:
  explicit Folder(const std::string& name = "", const std::string& content = "") {
    for (const auto& [file, text] :
         {std::pair{"calibration.json", kCalibration}, std::pair{"frames.csv", kFrames},
          std::pair{"tracks.csv", kTracks}, std::pair{"imu.csv", kImu},
          std::pair{"groundtruth.csv", kTruth}}) {
      files_.Write(file, file == name ? content : text);
    }
  }
  [[nodiscard]] std::string path() const { return files_.Path(""); }
  void Remove(const std::string& name) { std::filesystem::remove(files_.Path(name)); }
  TempFiles& files() { return files_; }

 private:
  TempFiles files_;
};

void ExpectRefused(const std::string& name, const std::string& content, const std::string& says) {
  const Folder folder(name, content);
  const auto data = ReadViotracks(folder.path());
  ASSERT_FALSE(data.ok()) << content;
  EXPECT_EQ(data.status().code(), StatusCode::kParseError) << data.status().message();
  EXPECT_NE(data.status().message().find(name), std::string::npos) << data.status().message();
  EXPECT_NE(data.status().message().find(says), std::string::npos) << data.status().message();
}

std::string Replaced(std::string text, const std::string& from, const std::string& to) {
  const std::size_t at = text.find(from);
  EXPECT_NE(at, std::string::npos) << from;
  return text.replace(at, from.size(), to);
}

TEST(Viotracks, ReadsAFolder) {
  const Folder folder;
  const auto data = ReadViotracks(folder.path());
  ASSERT_TRUE(data.ok()) << data.status().message();
  EXPECT_EQ(data->origin, "a \"test\" \xc3\xa9");
  EXPECT_EQ(data->gravity, Vector3(0, 0, -9.81));
  ASSERT_EQ(data->cameras.size(), 1u);
  EXPECT_EQ(data->cameras[0].fy, 410.5);
  EXPECT_EQ(data->cameras[0].width, 640);
  const Vector3 x = data->cameras[0].T_b_c * Vector3(1, 0, 0);
  EXPECT_LT((x - Vector3(0.1, 1.2, 0.3)).norm(), 1e-15);
  ASSERT_TRUE(data->imu_noise.has_value());
  EXPECT_EQ(data->imu_noise->accel_random_walk, 3e-3);
  EXPECT_EQ(data->imu_rate_hz, 200.0);
  ASSERT_EQ(data->imu.size(), 2u);
  EXPECT_EQ(data->imu[1].stamp_ns, 2000);
  EXPECT_EQ(data->imu[1].accel, Vector3(1, 2, -3));
  ASSERT_EQ(data->frames.size(), 2u);
  EXPECT_EQ(data->frames[1].id, 5);
  ASSERT_EQ(data->tracks.size(), 2u);
  EXPECT_EQ(data->tracks[1].frame, 1);
  EXPECT_EQ(data->tracks[1].v, 20.0);
  ASSERT_EQ(data->ground_truth.size(), 2u);
  const GroundTruthState& truth = data->ground_truth[0];
  EXPECT_EQ(truth.T_w_b.data[6], 0.5);
  EXPECT_EQ(truth.speed_bias->bg(), Vector3(0.1, 0.2, 0.3));
  EXPECT_EQ(truth.speed_bias->ba(), Vector3(0.7, 0.8, 0.9));
  EXPECT_EQ(data->ground_truth[1].T_w_b.q().w(), 1.0);  // w first
}

TEST(Viotracks, CompressedAndWithoutWhatMayBeAbsent) {
  Folder folder(
      "calibration.json",
      Replaced(kCalibration,
               std::string(kCalibration).substr(std::string(kCalibration).find(",\n \"imu\"")),
               "\n}"));
  for (const char* name : {"imu.csv", "groundtruth.csv", "frames.csv", "tracks.csv"})
    folder.Remove(name);
  (void)folder.files().WriteCompressed("frames.csv.gz", kFrames);
  (void)folder.files().WriteCompressed("tracks.csv.gz", kTracks);
  folder.files().Write("groundtruth.csv", "5,1,2,3,0.6,0.8,0,0\n");
  const auto data = ReadViotracks(folder.path());
  ASSERT_TRUE(data.ok()) << data.status().message();
  EXPECT_FALSE(data->imu_noise.has_value());
  EXPECT_TRUE(data->imu.empty());
  EXPECT_EQ(data->frames.size(), 2u);
  EXPECT_FALSE(data->ground_truth[0].speed_bias.has_value());
}

TEST(Viotracks, RefusesWhatIsMissing) {
  EXPECT_EQ(ReadViotracks("/no/such/folder").status().code(), StatusCode::kIoError);
  for (const char* name : {"frames.csv", "tracks.csv", "imu.csv"}) {
    Folder folder;
    folder.Remove(name);
    const auto data = ReadViotracks(folder.path());
    EXPECT_EQ(data.status().code(), StatusCode::kIoError) << name;
    EXPECT_NE(data.status().message().find(name), std::string::npos);
  }
}

TEST(Viotracks, RefusesBadTablesWithTheLine) {
  ExpectRefused("frames.csv", "1,10\n2,10\n", ":2: ");
  ExpectRefused("frames.csv", "# a\n\n2,10\n1,20\n", ":4: ");
  ExpectRefused("frames.csv", "1,10,3\n", "2 fields, found 3");
  ExpectRefused("frames.csv", "1\n", ":1: ");
  ExpectRefused("frames.csv", "-1,10\n", "-1");
  ExpectRefused("frames.csv", "1,1e3\n", "1e3");
  ExpectRefused("tracks.csv", "4,7,0,1,2\n", "no frame 4");
  ExpectRefused("tracks.csv", "3,7,1,1,2\n", "camera");
  ExpectRefused("tracks.csv", "3,7,0,1,nan\n", "nan");
  ExpectRefused("tracks.csv", "3,7,0,1,2\n3,7,0,inf,2\n", ":2: ");
  ExpectRefused("imu.csv", "1,2,3\n", "7 fields");
  ExpectRefused("imu.csv", "1,2,3,4,5,6,seven\n", "seven");
  ExpectRefused("imu.csv", "1,2,3,4,5,6,\n", "finite number");
  ExpectRefused("groundtruth.csv", "1,0,0,0,1,0,0\n", "8 or 17");
  ExpectRefused("groundtruth.csv", "1,0,0,0,2,0,0,0\n", "norm");
  ExpectRefused("groundtruth.csv", "2,0,0,0,1,0,0,0\n1,0,0,0,1,0,0,0\n", ":2: ");
  ExpectRefused("tracks.csv", std::string(200000, '1'), "not a table");
}

TEST(Viotracks, RefusesBadCalibrationsByName) {
  const auto spoiled = [](const char* from, const char* to, const char* says) {
    ExpectRefused("calibration.json", Replaced(kCalibration, from, to), says);
  };
  spoiled("\"fx\": 400", "\"fx\": -400", "json: /cameras/0/fx: must be > 0");
  spoiled("\"fx\": 400, ", "", "/cameras/0/fx: expected number, found none");
  spoiled("\"fx\": 400", "\"fx\": \"400\"", "/cameras/0/fx: expected number, found string");
  spoiled("\"fx\": 400", "\"fx\": 1e999", "number overflow parsing '1e999'");
  spoiled("\"fx\": 400", "\"fx\": nan", ":6: syntax error while parsing value - invalid literal");
  spoiled("\"fx\": 400", "\"fx\": 400, \"fx\": 400", "expected 'fx' only once");
  spoiled("\"width\": 640", "\"width\": 640.5", "/cameras/0/width: must be a whole number");
  spoiled("[0, 0, -9.81]", "[0, 0]", "/gravity: must be 3 numbers");
  spoiled("0, -1, 0, 0.1", "0, 1, 0, 0.1", "rigid");  // a mirror
  spoiled("0, -1, 0, 0.1", "0, -1.1, 0, 0.1", "rigid");
  spoiled("0.3,  0, 0, 0, 1", "0.3,  0, 0, 0, 2", "rigid");
  spoiled("\"imu\": {", "\"imu\": [", "unexpected ':'");
  spoiled("\"gyro_random_walk\": 1e-5", "\"gyro_random_walk\": 0",
          "/imu/gyro_random_walk: must be > 0");
  spoiled("\"cameras\": [", "\"cameras\": 3, \"x\": [", "/cameras: expected array, found number");
  ExpectRefused("calibration.json", "", ":1: syntax error while parsing value - unexpected end");
  ExpectRefused("calibration.json", "[1, 2]", "json: expected object, found array");
  ExpectRefused("calibration.json", "{} x", ":1: syntax error");
  ExpectRefused("calibration.json", "{\n\"a\": \"", ":2: syntax error");
  ExpectRefused("calibration.json", "{\"a\": \"\n\"}", ":1: syntax error");
  ExpectRefused("calibration.json", "{\"a\": \"\\u12\"}", "must be followed by 4 hex digits");
  ExpectRefused("calibration.json", "{\"a\": \"\xff\"}", "ill-formed UTF-8");
  ExpectRefused("calibration.json", "{\"a\": tru}", "invalid literal");
  ExpectRefused("calibration.json", "{\"origin\": 3}", "/origin: expected string, found number");
  ExpectRefused("calibration.json", std::string(100000, '['), "64 levels");
  ExpectRefused("calibration.json", std::string(300000, ' '), "256 kB");
}

TEST(Viotracks, TruncatedAnywhereIsAStatusOrShorter) {
  const std::string text = kCalibration;
  for (std::size_t n = 0; n + 2 < text.size(); n += 7) {
    const Folder folder("calibration.json", text.substr(0, n));
    EXPECT_FALSE(ReadViotracks(folder.path()).ok()) << n;
  }
}

TEST(Euroc, StampsAndTruth) {
  const TempFiles files;
  const auto path = files.Write("data.csv", "#timestamp [ns],filename\n10,10.png\n20,20.png\r\n");
  EXPECT_EQ(ReadEurocStamps(path).value(), (std::vector<std::int64_t>{10, 20}));
  EXPECT_FALSE(ReadEurocStamps(files.Write("b.csv", "20\n10\n")).ok());
  EXPECT_FALSE(ReadEurocStamps(files.Path("none.csv")).ok());
  EXPECT_TRUE(ReadEurocImu(files.Write("c.csv", "")).value().empty());
}

TEST(Viotracks, PublishedRecordings) {
  const struct {
    const char* name;
    std::size_t cameras, frames, imu;
    bool has_imu;
  } runs[] = {{"euroc_v101_semi", 2, 1448, 28945, true},
              {"euroc_mh05_semi", 2, 1111, 22209, true},
              {"malaga_parking6L", 1, 170, 0, true},
              {"kitti_0930_0020", 2, 1000, 0, false}};
  for (const auto& run : runs) {
    const auto folder = test::DataDir() / "vio" / run.name;
    if (!std::filesystem::exists(folder)) GTEST_SKIP() << folder << " is not there";
    const auto read = ReadViotracks(folder.string());
    ASSERT_TRUE(read.ok()) << read.status().message();
    EXPECT_EQ(read->cameras.size(), run.cameras);
    EXPECT_EQ(read->frames.size(), run.frames);
    EXPECT_EQ(read->imu_noise.has_value(), run.has_imu);
    if (run.imu > 0) {
      EXPECT_EQ(read->imu.size(), run.imu);
    }
    EXPECT_GT(read->tracks.size(), 10 * run.frames);
    EXPECT_FALSE(read->ground_truth.empty());
  }
}

}  // namespace
}  // namespace glissade
