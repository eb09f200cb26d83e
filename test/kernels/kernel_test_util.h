// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// What all kernel tests share: the tables to test, buffers with guard values, random numbers, and
// matrices with a leading dimension that is not a multiple of anything.

#ifndef GLISSADE_TEST_KERNELS_KERNEL_TEST_UTIL_H_
#define GLISSADE_TEST_KERNELS_KERNEL_TEST_UTIL_H_

#include <gtest/gtest.h>
#include <stdint.h>

#include <cmath>
#include <cstring>
#include <string>
#include <vector>

#include "kernels/kernels.h"

namespace glissade::kernels {

/// Reference results are accumulated in it.
using Wide = long double;

/// The tables this machine can run, all tested one by one.
inline std::vector<const KernelTable*> AvailableTables() {
  std::vector<const KernelTable*> tables;
  for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    if (const KernelTable* table = KernelsFor(isa)) tables.push_back(table);
  }
  return tables;
}

/// A test case that runs once per table.
class KernelTest : public ::testing::TestWithParam<const KernelTable*> {
 protected:
  const KernelTable& k() const { return *GetParam(); }
};

inline std::string TableName(const ::testing::TestParamInfo<const KernelTable*>& info) {
  return info.param->name;
}

#define GLISSADE_INSTANTIATE_KERNEL_TEST(Suite) \
  INSTANTIATE_TEST_SUITE_P(Isa, Suite, ::testing::ValuesIn(AvailableTables()), TableName)

/// splitmix64; the same numbers everywhere.
class Random {
 public:
  explicit Random(uint64_t seed) : state_(seed) {}
  uint64_t Next() {
    uint64_t z = (state_ += 0x9e3779b97f4a7c15u);
    z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
    z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
    return z ^ (z >> 31);
  }
  /// Uniform in [-1, 1).
  double Uniform() { return static_cast<double>(Next() >> 11) * 0x1p-52 - 1.0; }
  int Below(int n) { return static_cast<int>(Next() % static_cast<uint64_t>(n)); }

 private:
  uint64_t state_;
};

/// Doubles between two zones of guard values. The start is aligned as a double only.
class Guarded {
 public:
  explicit Guarded(size_t size) : data_(size + 2 * kGuard, kValue), size_(size) {}
  Guarded(const Guarded& other) = default;
  double* data() { return data_.data() + kGuard; }
  const double* data() const { return data_.data() + kGuard; }
  size_t size() const { return size_; }
  double& operator[](size_t i) { return data()[i]; }
  double operator[](size_t i) const { return data()[i]; }
  void FillRandom(Random& random) {
    for (size_t i = 0; i < size_; ++i)
      data()[i] = random.Uniform();
  }
  bool GuardsIntact() const {
    for (size_t i = 0; i < kGuard; ++i) {
      if (data_[i] != kValue || data_[kGuard + size_ + i] != kValue) return false;
    }
    return true;
  }
  bool SameBits(const Guarded& other) const {
    return size_ == other.size_ &&
           std::memcmp(data_.data(), other.data_.data(), data_.size() * sizeof(double)) == 0;
  }

 private:
  static constexpr size_t kGuard = 19;  // odd, so that data() is not 16-byte aligned
  static constexpr double kValue = -7.25e77;
  std::vector<double> data_;
  size_t size_;
};

/// A column-major matrix in a guarded buffer, rows ld - n of each column being guards too (the last
/// column ends with its last row: nothing may be read or written behind it).
class GuardedMatrix {
 public:
  GuardedMatrix(int rows, int columns, int ld)
      : rows_(rows), columns_(columns), ld_(ld), buffer_(SizeOf(rows, columns, ld)) {
    for (size_t i = 0; i < buffer_.size(); ++i)
      buffer_[i] = kPadding;
  }
  double* data() { return buffer_.data(); }
  const double* data() const { return buffer_.data(); }
  int ld() const { return ld_; }
  int rows() const { return rows_; }
  int columns() const { return columns_; }
  double& operator()(int r, int c) { return buffer_[Offset(r, c)]; }
  double operator()(int r, int c) const { return buffer_[Offset(r, c)]; }
  void FillRandom(Random& random) {
    for (int c = 0; c < columns_; ++c) {
      for (int r = 0; r < rows_; ++r)
        (*this)(r, c) = random.Uniform();
    }
  }
  void FillUpper(double value) {
    for (int c = 0; c < columns_; ++c) {
      for (int r = 0; r < c && r < rows_; ++r)
        (*this)(r, c) = value;
    }
  }
  bool UpperIs(double value) const {
    for (int c = 0; c < columns_; ++c) {
      for (int r = 0; r < c && r < rows_; ++r) {
        if (std::memcmp(&buffer_.data()[Offset(r, c)], &value, sizeof(double)) != 0) return false;
      }
    }
    return true;
  }
  bool GuardsIntact() const {
    for (int c = 0; c + 1 < columns_; ++c) {
      for (int r = rows_; r < ld_; ++r) {
        if ((*this)(r, c) != kPadding) return false;
      }
    }
    return buffer_.GuardsIntact();
  }
  bool SameBits(const GuardedMatrix& other) const { return buffer_.SameBits(other.buffer_); }

 private:
  static constexpr double kPadding = 3.5e66;
  static size_t SizeOf(int rows, int columns, int ld) {
    return rows == 0 || columns == 0 ? 0
                                     : static_cast<size_t>(ld) * static_cast<size_t>(columns - 1) +
                                           static_cast<size_t>(rows);
  }
  size_t Offset(int r, int c) const {
    return static_cast<size_t>(ld_) * static_cast<size_t>(c) + static_cast<size_t>(r);
  }
  int rows_;
  int columns_;
  int ld_;
  Guarded buffer_;
};

/// The sizes dense kernels are tested on: every small one, and those around block sizes.
inline std::vector<int> TestSizes() {
  std::vector<int> sizes;
  for (int n = 1; n <= 70; ++n)
    sizes.push_back(n);
  for (const int n : {96, 97, 127, 128, 150, 191, 192, 193, 256, 300, 441})
    sizes.push_back(n);
  return sizes;
}

/// Leading dimensions for n rows: the tight one, an odd one, a padded one.
inline std::vector<int> TestLeadingDimensions(int n) {
  return {n, n + 3, (n + 15) / 8 * 8};
}

/// A random symmetric positive definite matrix of condition ~ n, lower triangle; the strictly upper
/// triangle is `upper`.
inline GuardedMatrix RandomSpd(int n, int ld, double upper, Random& random) {
  GuardedMatrix a(n, n, ld);
  std::vector<double> b(static_cast<size_t>(n) * static_cast<size_t>(n));
  for (double& x : b)
    x = random.Uniform();
  const auto at = [&](int r, int c) {
    return b[static_cast<size_t>(r) + static_cast<size_t>(c) * static_cast<size_t>(n)];
  };
  // A narrow B B' keeps this cheap for the large sizes; the diagonal makes it definite.
  const int k = n < 40 ? n : 40;
  for (int c = 0; c < n; ++c) {
    for (int r = c; r < n; ++r) {
      double s = r == c ? 0.3 : 0.0;
      for (int i = 0; i < k; ++i)
        s += at(r, i) * at(c, i);
      a(r, c) = s;
    }
  }
  a.FillUpper(upper);
  return a;
}

inline size_t I(int i) {
  return static_cast<size_t>(i);
}

inline Guarded Numbers(int count, Random& random) {
  Guarded x(I(count));
  x.FillRandom(random);
  return x;
}

}  // namespace glissade::kernels

#endif  // GLISSADE_TEST_KERNELS_KERNEL_TEST_UTIL_H_
