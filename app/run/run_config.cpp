// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "run/run_config.h"

#include <fmt/format.h>
#include <yaml-cpp/yaml.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <sstream>
#include <variant>
#include <vector>

namespace glissade::app {

namespace {

/// One key: where its value lives, what it may be, what it means.
struct Key {
  const char* section;
  const char* name;
  std::variant<int*, double*, bool*, std::string*> value;
  double low, high;  ///< of a number
  const char* help;
  std::vector<std::string> words = {};  ///< that a text may be
};

std::vector<Key> KeysOf(RunConfig* c) {
  vision::TrackerOptions& t = c->tracker;
  return {
      {"camera", "mono", &c->mono, 0, 0, "the first camera only"},
      {"camera", "sigma_px", &c->sigma_px, 0.01, 100, "of a feature, each coordinate (px)"},
      {"camera", "time_offset_s", &c->time_offset_s, -10, 10,
       "added to the stamps of frames to have them on the IMU's clock (s)"},
      {"tracker", "max_features", &t.max_features, 1, 100000, "in the first camera"},
      {"tracker", "cell_px", &t.cell_px, 8, 1000, "one new feature in each free cell (px)"},
      {"tracker", "min_corner", &t.min_corner, 1e-3, 1e6,
       "smallest mean squared gradient of a corner (grey/px)^2"},
      {"tracker", "min_relative_corner", &t.min_relative_corner, 0, 1,
       "and its part of the image's strongest corner"},
      {"tracker", "contrast_limit", &t.contrast_limit, 0, 100,
       "of adaptive histogram equalization; 0: none"},
      {"tracker", "window_px", &t.window_px, 5, 61, "of Lucas and Kanade's tracker (px, odd)"},
      {"tracker", "levels_predicted", &t.levels_predicted, 0, 8,
       "of its pyramid, where the gyroscope says where to look"},
      {"tracker", "levels_blind", &t.levels_blind, 0, 8, "and where nothing does"},
      {"tracker", "max_forward_backward_px", &t.max_forward_backward_px, 1e-3, 100,
       "tracked back, a feature is so near to where it was (px)"},
      {"tracker", "max_epipolar_px", &t.max_epipolar_px, 1e-2, 100,
       "from the epipolar line between frames (px)"},
      {"tracker", "max_stereo_epipolar_px", &t.max_stereo_epipolar_px, 1e-2, 100,
       "and between cameras (px)"},
      {"tracker", "min_depth_m", &t.min_depth_m, 1e-3, 1e3, "that stereo is searched to (m)"},
      {"tracker", "min_contrast", &t.min_contrast, 0, 127,
       "grey values with a smaller standard deviation show nothing"},
      {"tracker", "max_blind_s", &t.max_blind_s, 0, 1e3,
       "how long tracks outlive images that show nothing (s)"},
      {"imu", "use", &c->use_imu, 0, 0, "false: two cameras alone"},
      {"imu", "noise_scale", &c->noise_scale, 1e-3, 1e3,
       "times the calibration's noise densities: a data sheet's sensor lies on a table"},
      {"imu", "walk_scale", &c->walk_scale, 1e-3, 1e3, "times its random walks of the biases"},
      {"imu", "gyro_range", &c->gyro_range, 0, 1e3,
       "readings at it are trusted less (rad/s); 0: not known"},
      {"imu", "accel_range", &c->accel_range, 0, 1e4, "likewise (m/s^2)"},
      {"imu", "gravity", &c->gravity, 1, 100, "m/s^2"},
      {"window",
       "policy",
       &c->window.policy,
       0,
       0,
       "what leaves the window: okvis, vins, basalt or lag",
       {"okvis", "vins", "basalt", "lag"}},
      {"window", "frames", &c->window.frames, 1, 1000, "newest frames, with speed and biases"},
      {"window", "keyframes", &c->window.keyframes, 1, 1000, "besides"},
      {"window", "lag_s", &c->window.lag_s, 0.01, 1000, "of the policy lag (s)"},
      {"window",
       "first_estimates",
       &c->first_estimates,
       0,
       0,
       "what stays linearized where it first was: off, prior or full",
       {"off", "prior", "full"}},
      {"window", "iterations", &c->budget.max_iterations, 1, 1000, "linear solves of a frame"},
      {"window", "keyframe_tracked_share", &c->keyframes.min_tracked_share, 0, 1,
       "a keyframe where less of the last one's landmarks is seen"},
      {"window", "keyframe_parallax", &c->keyframes.max_parallax, 0, 10,
       "or where they have moved further (rad)"},
      {"window", "keyframe_interval_s", &c->keyframes.max_interval_s, 0.01, 1e4,
       "or after so long (s)"},
      {"window", "max_chi2", &c->max_chi2, 0.1, 1e6,
       "r'r in sigmas beyond which an observation is taken out"},
  };
}

struct Refusal {
  int line;
  std::string what;
};

int LineOf(const YAML::Node& node) {
  return node.Mark().line + 1;
}

template <class T>
T Value(const YAML::Node& node, const std::string& name, const char* kind) {
  T x{};
  if (!node.IsScalar() || !YAML::convert<T>::decode(node, x)) {
    throw Refusal{LineOf(node), fmt::format("{} must be {}", name, kind)};
  }
  return x;
}

void CheckRange(const Key& key, double x, const YAML::Node& node, const std::string& name) {
  if (std::isfinite(x) && x >= key.low && x <= key.high) return;
  throw Refusal{LineOf(node), fmt::format("{} must be from {:g} to {:g}", name, key.low, key.high)};
}

void Set(const Key& key, const YAML::Node& node) {
  const std::string name = fmt::format("{}: {}", key.section, key.name);
  if (int* const* i = std::get_if<int*>(&key.value)) {
    const int x = Value<int>(node, name, "a whole number");
    CheckRange(key, x, node, name);
    **i = x;
  } else if (double* const* d = std::get_if<double*>(&key.value)) {
    const double x = Value<double>(node, name, "a number");
    CheckRange(key, x, node, name);
    **d = x;
  } else if (bool* const* b = std::get_if<bool*>(&key.value)) {
    **b = Value<bool>(node, name, "true or false");
  } else {
    const auto word = Value<std::string>(node, name, "a word");
    if (std::find(key.words.begin(), key.words.end(), word) == key.words.end()) {
      throw Refusal{LineOf(node),
                    fmt::format("{} must be one of {}", name, fmt::join(key.words, ", "))};
    }
    *std::get<std::string*>(key.value) = word;
  }
}

void Apply(const YAML::Node& root, const std::vector<Key>& keys) {
  for (const auto& section : root) {
    const auto name = section.first.as<std::string>();
    const auto of_section = [&](const Key& key) { return name == key.section; };
    if (std::none_of(keys.begin(), keys.end(), of_section)) {
      throw Refusal{LineOf(section.first),
                    fmt::format("there is no section {}: camera, tracker, imu, window", name)};
    }
    if (section.second.IsNull()) continue;
    if (!section.second.IsMap()) {
      throw Refusal{LineOf(section.first), fmt::format("{} must hold keys with values", name)};
    }
    for (const auto& entry : section.second) {
      const auto key_name = entry.first.as<std::string>();
      const auto key = std::find_if(keys.begin(), keys.end(), [&](const Key& k) {
        return name == k.section && key_name == k.name;
      });
      if (key == keys.end()) {
        throw Refusal{LineOf(entry.first),
                      fmt::format("there is no key {} in {} (see --print-config)", key_name, name)};
      }
      Set(*key, entry.second);
    }
  }
}

std::string TextOf(const Key& key) {
  if (int* const* i = std::get_if<int*>(&key.value)) return std::to_string(**i);
  if (double* const* d = std::get_if<double*>(&key.value)) return fmt::format("{}", **d);
  if (bool* const* b = std::get_if<bool*>(&key.value)) return **b ? "true" : "false";
  return *std::get<std::string*>(key.value);
}

/// The pose as it is after a file has held it as a matrix: so that a replay of saved tracks begins
/// with the same bits.
Pose AsMatrix(Pose T) {
  for (int k = 0; k < 20; ++k) {
    Pose next(T.q().toRotationMatrix(), Vector3(T.p()));
    next.Normalize();
    if (next == T) break;
    T = next;
  }
  return T;
}

}  // namespace

RunConfig::RunConfig() {
  tracker.max_features = 150;
}

Status ReadConfig(const std::string& path, RunConfig* config) {
  std::ifstream in(path, std::ios::binary);
  if (!in) return {StatusCode::kIoError, path + ": cannot be opened"};
  std::stringstream text;
  text << in.rdbuf();
  if (!in || std::filesystem::is_directory(path)) {
    return {StatusCode::kIoError, path + ": cannot be read"};
  }
  RunConfig read = *config;
  const auto failed = [&](int line, const std::string& what) {
    return Status(StatusCode::kParseError, fmt::format("{}:{}: {}", path, line, what));
  };
  try {
    const YAML::Node root = YAML::Load(text.str());
    if (!root.IsMap() && !root.IsNull()) return failed(1, "expected sections with keys");
    if (root.IsMap()) Apply(root, KeysOf(&read));
  } catch (const Refusal& refusal) {
    return failed(refusal.line, refusal.what);
  } catch (const YAML::Exception& e) {
    return failed(e.mark.line + 1, e.msg);
  }
  if (Status s = read.tracker.Validate(); !s.ok()) return failed(1, "tracker: " + s.message());
  *config = read;
  return {};
}

std::string ConfigText(const RunConfig& config) {
  RunConfig copy = config;
  std::string text;
  std::string_view section;
  auto out = std::back_inserter(text);
  for (const Key& key : KeysOf(&copy)) {
    if (section != key.section) {
      fmt::format_to(out, "{}{}:\n", section.empty() ? "" : "\n", key.section);
      section = key.section;
    }
    fmt::format_to(out, "  {:<34}# {}\n", fmt::format("{}: {}", key.name, TextOf(key)), key.help);
  }
  return text;
}

Result<SlidingWindowOptions> WindowOptions(const vision::ImageRecording& recording,
                                           const RunConfig& config) {
  SlidingWindowOptions options;
  const auto refused = [](std::string why) {
    return Status(StatusCode::kInvalidArgument, std::move(why));
  };
  for (const vision::Camera& camera : recording.cameras) {
    options.cameras.push_back(vision::WithoutDistortion(camera, config.sigma_px));
    options.cameras.back().T_b_c = AsMatrix(camera.T_b_c);
  }
  if (config.use_imu && recording.imu_noise) {
    ImuNoise noise = *recording.imu_noise;
    noise.gyro_noise_density *= config.noise_scale;
    noise.accel_noise_density *= config.noise_scale;
    noise.gyro_random_walk *= config.walk_scale;
    noise.accel_random_walk *= config.walk_scale;
    options.imu_noise = noise;
  }
  if (options.cameras.size() < 2 && !options.imu_noise) {
    return refused("one camera and no IMU: nothing tells the scale");
  }
  if (config.gyro_range > 0.0) options.imu.gyro_range = config.gyro_range;
  if (config.accel_range > 0.0) options.imu.accel_range = config.accel_range;
  options.gravity = config.gravity;
  options.policy = MakePolicy(config.window);
  options.first_estimates = ParseFirstEstimates(config.first_estimates);
  options.keyframes = config.keyframes;
  options.max_chi2 = config.max_chi2;
  if (Status s = options.Validate(); !s.ok()) return s;
  return options;
}

}  // namespace glissade::app
