// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "io/viotracks_calibration.h"

#include "io/byte_source.h"

#ifdef GLISSADE_HAVE_JSON
#include <algorithm>
#include <cmath>
#include <nlohmann/json.hpp>
#include <set>
#include <string_view>
#include <vector>

#include "io/text_reader.h"
#endif

namespace glissade::internal {

#ifdef GLISSADE_HAVE_JSON

namespace {

using Json = nlohmann::json;

constexpr std::size_t kMostBytes = std::size_t{1} << 18;

Result<std::string> ReadText(const std::string& path) {
  auto source = OpenByteSource(path);
  if (!source.ok()) return source.status();
  std::string text;
  std::string why;
  char buffer[4096];
  while (true) {
    const std::ptrdiff_t n = (*source)->Read(buffer, sizeof(buffer), &why);
    if (n < 0) return Status(StatusCode::kIoError, path + ": cannot be read: " + why);
    if (n == 0) return text;
    text.append(buffer, static_cast<std::size_t>(n));
    if (text.size() > kMostBytes)
      return Status(StatusCode::kParseError, path + ": over 256 kB: no calibration");
  }
}

/// What the library says after "[json.exception...] parse error at line 1, column 2: ".
std::string Reason(std::string_view what) {
  constexpr std::size_t kMost = 160;  // it quotes the file
  if (const auto at = what.find("] "); at != std::string_view::npos) what.remove_prefix(at + 2);
  if (const auto at = what.find(": "); what.starts_with("parse error") && at != what.npos)
    what.remove_prefix(at + 2);
  return std::string(what.substr(0, kMost)).append(what.size() > kMost ? "..." : "");
}

Result<Json> Parse(const std::string& path, const std::string& text) {
  constexpr int kMostLevels = 64;
  std::string refused;
  std::vector<std::set<std::string>> names;  // of the objects that are open
  const auto look = [&](int depth, Json::parse_event_t event, const Json& parsed) {
    if (depth >= kMostLevels && refused.empty()) refused = "expected fewer than 64 levels";
    if (event == Json::parse_event_t::object_start) names.emplace_back();
    if (event == Json::parse_event_t::object_end) names.pop_back();
    if (event == Json::parse_event_t::key) {
      const auto& name = parsed.get_ref<const std::string&>();
      if (!names.back().insert(name).second && refused.empty())
        refused = "expected '" + Printable(name) + "' only once in an object";
    }
    return refused.empty();
  };
  try {
    Json json = Json::parse(text, look);
    if (refused.empty()) return json;
    return Status(StatusCode::kParseError, path + ": " + refused);
  } catch (const Json::parse_error& error) {
    if (!refused.empty()) return Status(StatusCode::kParseError, path + ": " + refused);
    const auto at = text.begin() + static_cast<std::ptrdiff_t>(
                                       std::clamp<std::size_t>(error.byte, 1, text.size() + 1) - 1);
    const auto line = 1 + std::count(text.begin(), at, '\n');
    return Status(StatusCode::kParseError,
                  path + ":" + std::to_string(line) + ": " + Reason(error.what()));
  } catch (const Json::exception& error) {  // a number that no double can hold
    return Status(StatusCode::kParseError, path + ": " + Reason(error.what()));
  }
}

/// A value and where it is.
struct At {
  const Json* json;
  std::string pointer;
};

/// Takes numbers out of the tree; the first thing that is missing or wrong is kept.
class Calibration {
 public:
  explicit Calibration(std::string path) : path_(std::move(path)) {}

  [[nodiscard]] const Status& status() const { return status_; }
  [[nodiscard]] bool ok() const { return status_.ok(); }

  void Fail(const std::string& pointer, const std::string& message) {
    if (!ok()) return;
    const std::string where = pointer.empty() ? "" : pointer + ": ";
    status_ = Status(StatusCode::kParseError, path_ + ": " + where + message);
  }
  /// Fails unless it is of this kind: "object", "array", "number" or "string".
  bool Expect(const At& at, std::string_view kind) {
    if (at.json != nullptr && kind == at.json->type_name()) return true;
    Fail(at.pointer, "expected " + std::string(kind) + ", found " +
                         (at.json == nullptr ? "none" : at.json->type_name()));
    return false;
  }
  [[nodiscard]] static At Member(const At& object, const std::string& name) {
    const auto found = object.json->find(name);
    return {found == object.json->end() ? nullptr : &*found, object.pointer + "/" + name};
  }
  double Number(const At& object, const char* name) {
    const At value = Member(object, name);
    return Expect(value, "number") ? value.json->get<double>() : 0.0;
  }
  double Positive(const At& object, const char* name) {
    const double x = Number(object, name);
    if (ok() && !(x > 0.0)) Fail(object.pointer + "/" + name, "must be > 0");
    return x;
  }
  int Size(const At& object, const char* name) {
    const double x = Positive(object, name);
    if (x <= 1e6 && x == std::floor(x)) return static_cast<int>(x);
    Fail(object.pointer + "/" + name, "must be a whole number of pixels");
    return 0;
  }
  void Numbers(const At& object, const char* name, std::size_t n, double* to) {
    const At value = Member(object, name);
    if (!Expect(value, "array")) return;
    const auto number = [](const Json& item) { return item.is_number(); };
    if (value.json->size() != n || !std::all_of(value.json->begin(), value.json->end(), number)) {
      Fail(value.pointer, "must be " + std::to_string(n) + " numbers");
      return;
    }
    for (const Json& item : *value.json)
      *to++ = item.get<double>();
  }
  /// A rigid transform, 16 numbers row-major.
  Pose Transform(const At& object, const char* name) {
    double T[16] = {};
    Numbers(object, name, 16, T);
    if (!ok()) return {};
    Matrix3 R;
    R << T[0], T[1], T[2], T[4], T[5], T[6], T[8], T[9], T[10];
    const double off = (R * R.transpose() - Matrix3::Identity()).norm();
    const bool rigid = off < 1e-6 && R.row(0).cross(R.row(1)).dot(R.row(2)) > 0.0 && T[12] == 0.0 &&
                       T[13] == 0.0 && T[14] == 0.0 && T[15] == 1.0;
    if (rigid) return Pose(R, Vector3(T[3], T[7], T[11]));
    Fail(object.pointer + "/" + name, "is no rigid transform");
    return {};
  }

 private:
  std::string path_;
  Status status_;
};

ViotracksCamera ReadCamera(Calibration& in, const At& at) {
  ViotracksCamera c;
  if (!in.Expect(at, "object")) return c;
  c.fx = in.Positive(at, "fx");
  c.fy = in.Positive(at, "fy");
  c.cx = in.Number(at, "cx");
  c.cy = in.Number(at, "cy");
  c.width = in.Size(at, "width");
  c.height = in.Size(at, "height");
  c.sigma_px = in.Positive(at, "sigma_px");
  c.T_b_c = in.Transform(at, "T_B_C");
  return c;
}

Status Read(Calibration& in, const Json& json, Viotracks* data) {
  const At root{&json, ""};
  if (!in.Expect(root, "object")) return in.status();
  if (const At origin = in.Member(root, "origin"); origin.json != nullptr) {
    if (in.Expect(origin, "string")) data->origin = origin.json->get<std::string>();
  }
  in.Numbers(root, "gravity", 3, data->gravity.data());
  const At cameras = in.Member(root, "cameras");
  if (!in.ok() || !in.Expect(cameras, "array")) return in.status();
  for (std::size_t k = 0; k < cameras.json->size() && in.ok(); ++k) {
    data->cameras.push_back(
        ReadCamera(in, {&(*cameras.json)[k], cameras.pointer + "/" + std::to_string(k)}));
  }
  const At imu = in.Member(root, "imu");
  if (imu.json == nullptr || imu.json->is_null() || !in.Expect(imu, "object")) return in.status();
  ImuNoise& noise = data->imu_noise.emplace();
  data->imu_rate_hz = in.Positive(imu, "rate_hz");
  noise.gyro_noise_density = in.Positive(imu, "gyro_noise_density");
  noise.accel_noise_density = in.Positive(imu, "accel_noise_density");
  noise.gyro_random_walk = in.Positive(imu, "gyro_random_walk");
  noise.accel_random_walk = in.Positive(imu, "accel_random_walk");
  return in.status();
}

}  // namespace

Status ReadCalibration(const std::string& path, Viotracks* data) {
  const auto text = ReadText(path);
  if (!text.ok()) return text.status();
  const auto json = Parse(path, *text);
  if (!json.ok()) return json.status();
  Calibration in(path);
  return Read(in, json.value(), data);
}

#else

Status ReadCalibration(const std::string& path, Viotracks*) {
  const auto source = OpenByteSource(path);
  if (!source.ok()) return source.status();
  return {StatusCode::kIoError,
          path + ": cannot be read: this library was built without nlohmann-json"};
}

#endif

}  // namespace glissade::internal
