// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "vision/sensor_yaml.h"

#include <yaml-cpp/yaml.h>

#include <cmath>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include "glissade/base/out_of_memory.h"

namespace glissade::vision::internal {

namespace {

/// Thrown inside this file alone: yaml-cpp throws as well, and both end in one place.
struct Failure {
  int line;
  std::string what;
};

int LineOf(const YAML::Node& node) {
  return node.IsDefined() ? node.Mark().line + 1 : 0;
}

YAML::Node Child(const YAML::Node& map, const char* key) {
  const YAML::Node child = map[key];
  if (!child.IsDefined()) throw Failure{LineOf(map), std::string("there is no ") + key};
  return child;
}

double NumberOf(const YAML::Node& node, const char* what) {
  double x = 0.0;
  if (!node.IsScalar() || !YAML::convert<double>::decode(node, x) || !std::isfinite(x)) {
    throw Failure{LineOf(node), std::string(what) + " must be a number"};
  }
  return x;
}

std::vector<double> Numbers(const YAML::Node& map, const char* key, std::size_t count) {
  const YAML::Node list = Child(map, key);
  std::vector<double> out;
  if (!list.IsSequence()) {
    throw Failure{LineOf(list), std::string(key) + " must be a list of numbers"};
  }
  for (const YAML::Node& item : list)
    out.push_back(NumberOf(item, key));
  if (count > 0 && out.size() != count) {
    throw Failure{LineOf(list),
                  std::string(key) + " must be a list of " + std::to_string(count) + " numbers"};
  }
  return out;
}

std::string Word(const YAML::Node& map, const char* key) {
  const YAML::Node node = Child(map, key);
  if (!node.IsScalar()) throw Failure{LineOf(node), std::string(key) + " must be a word"};
  return node.Scalar();
}

/// 16 numbers row by row.
Pose PoseOf(const std::vector<double>& T, int line, const char* key) {
  Matrix3 R;
  for (int r = 0; r < 3; ++r)
    for (int c = 0; c < 3; ++c)
      R(r, c) = T[static_cast<std::size_t>(4 * r + c)];
  const bool rotation = (R.transpose() * R - Matrix3::Identity()).cwiseAbs().maxCoeff() < 1e-3 &&
                        R.determinant() > 0.0;
  if (!rotation || T[12] != 0.0 || T[13] != 0.0 || T[14] != 0.0 || T[15] != 1.0) {
    throw Failure{line, std::string(key) + " is no rigid motion"};
  }
  Pose pose(R, Vector3(T[3], T[7], T[11]));
  pose.Normalize();
  return pose;
}

Pose ReadT_BS(const YAML::Node& root) {
  const YAML::Node T = Child(root, "T_BS");
  return PoseOf(Numbers(T, "data", 16), LineOf(T), "T_BS");
}

/// The words of EuRoC, Kalibr and TUM-VI for the same things.
void SetLens(const YAML::Node& root, const char* coefficients_key, Camera* camera) {
  const std::vector<double> f = Numbers(root, "intrinsics", 4);
  const CameraPinhole pinhole{f[0], f[1], f[2], f[3]};
  if (const std::string model = Word(root, "camera_model"); model != "pinhole") {
    throw Failure{LineOf(root["camera_model"]),
                  "camera_model " + model + " is not known here: pinhole is"};
  }
  const std::string model = Word(root, "distortion_model");
  if (model == "none") {
    camera->lens = pinhole;
    return;
  }
  const std::vector<double> d = Numbers(root, coefficients_key, 0);
  const auto need = [&](std::size_t least, std::size_t most) {
    if (d.size() >= least && d.size() <= most) return;
    throw Failure{LineOf(root[coefficients_key]),
                  model + " distortion has not " + std::to_string(d.size()) + " coefficients"};
  };
  if (model == "radial-tangential" || model == "radtan" || model == "plumb_bob") {
    need(4, 5);
    camera->lens = CameraRadtan{pinhole, d[0], d[1], d[2], d[3], d.size() > 4 ? d[4] : 0.0};
  } else if (model == "equidistant" || model == "kannala-brandt") {
    need(4, 4);
    camera->lens = CameraKannalaBrandt{pinhole, d[0], d[1], d[2], d[3]};
  } else {
    throw Failure{LineOf(root["distortion_model"]),
                  "distortion_model " + model +
                      " is not known here: radial-tangential, equidistant and none are"};
  }
}

void SetSize(const YAML::Node& root, Camera* camera) {
  const std::vector<double> size = Numbers(root, "resolution", 2);
  for (const double x : size) {
    if (x >= 1.0 && x <= 65536.0 && x == std::floor(x)) continue;
    throw Failure{LineOf(root["resolution"]), "resolution must be a width and a height in pixels"};
  }
  camera->width = static_cast<int>(size[0]);
  camera->height = static_cast<int>(size[1]);
}

/// OpenCV writes "%YAML:1.0", which is no directive of YAML.
Result<std::string> TextOf(const std::string& path) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return Status(StatusCode::kIoError, path + ": cannot be opened");
  std::stringstream text;
  text << in.rdbuf();
  std::string out = text.str();
  if (out.starts_with("%YAML:")) out[0] = '#';
  return out;
}

template <class T, class Read>
Result<T> ReadYaml(const std::string& path, Read&& read) {
  return glissade::internal::OrOutOfMemory([&]() -> Result<T> {
    const auto text = TextOf(path);
    if (!text.ok()) return text.status();
    const auto failed = [&](int line, const std::string& what) {
      return Status(
          StatusCode::kParseError,
          std::string(path).append(":").append(std::to_string(line)).append(": ").append(what));
    };
    int line = 1;
    try {
      const YAML::Node root = YAML::Load(*text);
      if (!root.IsMap()) return failed(1, "expected keys with values");
      T out;
      read(root, &out);
      return out;
    } catch (const Failure& f) {
      return failed(f.line, f.what);
    } catch (const YAML::Exception& e) {
      line = e.mark.line + 1;
      return failed(line, e.msg);
    }
  });
}

void CheckCamera(const YAML::Node& root, const Camera& camera) {
  if (const Status s = camera.Validate(); !s.ok()) throw Failure{LineOf(root), s.message()};
}

}  // namespace

Result<Camera> ReadCameraYaml(const std::string& path) {
  return ReadYaml<Camera>(path, [](const YAML::Node& root, Camera* camera) {
    SetLens(root, "distortion_coefficients", camera);
    SetSize(root, camera);
    camera->T_b_c = ReadT_BS(root);
    CheckCamera(root, *camera);
  });
}

Result<ImuCalibration> ReadImuYaml(const std::string& path) {
  return ReadYaml<ImuCalibration>(path, [](const YAML::Node& file, ImuCalibration* imu) {
    const YAML::Node root = file["imu0"].IsDefined() ? file["imu0"] : file;
    if (root["T_BS"].IsDefined()) {
      const Pose T_b_s = ReadT_BS(root);
      if (T_b_s.p().norm() > 1e-9 || std::abs(T_b_s.q().w()) < 1.0 - 1e-9) {
        throw Failure{LineOf(root["T_BS"]), "the IMU must be the body: T_BS the identity"};
      }
    }
    imu->noise.gyro_noise_density =
        NumberOf(Child(root, "gyroscope_noise_density"), "gyroscope_noise_density");
    imu->noise.gyro_random_walk =
        NumberOf(Child(root, "gyroscope_random_walk"), "gyroscope_random_walk");
    imu->noise.accel_noise_density =
        NumberOf(Child(root, "accelerometer_noise_density"), "accelerometer_noise_density");
    imu->noise.accel_random_walk =
        NumberOf(Child(root, "accelerometer_random_walk"), "accelerometer_random_walk");
    const char* rate = root["rate_hz"].IsDefined() ? "rate_hz" : "update_rate";
    imu->rate_hz = NumberOf(Child(root, rate), rate);
    if (const Status s = imu->noise.Validate(); !s.ok()) throw Failure{LineOf(root), s.message()};
    if (!(imu->rate_hz > 0.0)) throw Failure{LineOf(root[rate]), "the rate must be > 0"};
  });
}

Result<Camera> ReadKalibrCamera(const std::string& path, int k) {
  return ReadYaml<Camera>(path, [k](const YAML::Node& file, Camera* camera) {
    const YAML::Node root = Child(file, ("cam" + std::to_string(k)).c_str());
    SetLens(root, "distortion_coeffs", camera);
    SetSize(root, camera);
    const YAML::Node T = Child(root, "T_cam_imu");
    std::vector<double> numbers;
    for (const YAML::Node& row : T)
      for (const YAML::Node& x : row)
        numbers.push_back(NumberOf(x, "T_cam_imu"));
    if (numbers.size() != 16) throw Failure{LineOf(T), "T_cam_imu must be 4 rows of 4 numbers"};
    camera->T_b_c = PoseOf(numbers, LineOf(T), "T_cam_imu").Inverse();
    CheckCamera(root, *camera);
  });
}

}  // namespace glissade::vision::internal
