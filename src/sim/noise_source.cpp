// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/sim/noise_source.h"

#include <bit>
#include <cmath>

namespace glissade::sim {

namespace {

std::uint64_t SplitMix(std::uint64_t* state) {
  *state += 0x9e3779b97f4a7c15u;
  std::uint64_t z = *state;
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

}  // namespace

NoiseSource::NoiseSource(std::uint64_t seed, std::uint64_t stream) {
  std::uint64_t mixed = seed;
  mixed = SplitMix(&mixed) ^ stream;
  for (std::uint64_t& word : state_)
    word = SplitMix(&mixed);
}

std::uint64_t NoiseSource::Next() {
  const std::uint64_t result = std::rotl(state_[0] + state_[3], 23) + state_[0];
  const std::uint64_t t = state_[1] << 17;
  state_[2] ^= state_[0];
  state_[3] ^= state_[1];
  state_[1] ^= state_[2];
  state_[0] ^= state_[3];
  state_[2] ^= t;
  state_[3] = std::rotl(state_[3], 45);
  return result;
}

double NoiseSource::Uniform(double low, double high) {
  return low + (high - low) * (static_cast<double>(Next() >> 11) * 0x1p-53);
}

double NoiseSource::Normal(double sigma) {
  if (has_saved_) {
    has_saved_ = false;
    return sigma * saved_;
  }
  double u = 0.0, v = 0.0, r2 = 0.0;
  do {
    u = Uniform(-1.0, 1.0);
    v = Uniform(-1.0, 1.0);
    r2 = u * u + v * v;
  } while (!(r2 < 1.0) || r2 == 0.0);
  const double scale = std::sqrt(-2.0 * std::log(r2) / r2);
  saved_ = v * scale;
  has_saved_ = true;
  return sigma * u * scale;
}

}  // namespace glissade::sim
