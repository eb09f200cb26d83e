// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The kernels of every instruction set of this machine, beside Eigen compiled as the library's own
// code is (baseline, without -march): what a caller would get without the kernels.
//
//   bench_kernels --benchmark_filter=cholesky

#include <benchmark/benchmark.h>

#include <Eigen/Dense>
#include <cstdlib>
#include <cstring>
#include <string>
#include <vector>

#include "kernels/kernels.h"

namespace glissade::kernels {
namespace {

/// 64-byte aligned doubles.
class Buffer {
 public:
  explicit Buffer(size_t size)
      : data_(static_cast<double*>(std::aligned_alloc(64, (size * sizeof(double) + 63) / 64 * 64))),
        size_(size) {
    std::memset(data_, 0, size * sizeof(double));
  }
  Buffer(const Buffer&) = delete;
  Buffer& operator=(const Buffer&) = delete;
  ~Buffer() { std::free(data_); }
  double* data() { return data_; }
  size_t size() const { return size_; }
  void CopyFrom(Buffer& other) { std::memcpy(data_, other.data_, size_ * sizeof(double)); }

 private:
  double* data_;
  size_t size_;
};

int Padded(int n) {
  return (n + 7) / 8 * 8;
}

size_t Size(int ld, int columns) {
  return static_cast<size_t>(ld) * static_cast<size_t>(columns);
}

Eigen::MatrixXd RandomSpd(int n) {
  std::srand(1);
  const Eigen::MatrixXd b = Eigen::MatrixXd::Random(n, n);
  return b * b.transpose() + Eigen::MatrixXd::Identity(n, n) * n;
}

void CopyToPadded(const Eigen::MatrixXd& m, Buffer& buffer, int ld) {
  Eigen::Map<Eigen::MatrixXd, 0, Eigen::OuterStride<>>(buffer.data(), m.rows(), m.cols(),
                                                       Eigen::OuterStride<>(ld)) = m;
}

void Flops(benchmark::State& state, double per_iteration) {
  state.counters["GFlop/s"] =
      benchmark::Counter(per_iteration * 1e-9, benchmark::Counter::kIsIterationInvariantRate);
}

/// Includes the copy of the matrix, on both sides.
void Factor(benchmark::State& state, const KernelTable* table, int n) {
  const int ld = Padded(n);
  Buffer source(Size(ld, n));
  Buffer a(Size(ld, n));
  const Eigen::MatrixXd spd = RandomSpd(n);
  CopyToPadded(spd, source, ld);
  Eigen::MatrixXd b = spd;
  for (auto _ : state) {
    if (table != nullptr) {
      a.CopyFrom(source);
      benchmark::DoNotOptimize(table->cholesky(n, a.data(), ld));
    } else {
      b = spd;
      Eigen::LLT<Eigen::Ref<Eigen::MatrixXd>> llt(b);
      benchmark::DoNotOptimize(llt.info());
    }
  }
  Flops(state, n / 3.0 * n * n);
}

void SolveOne(benchmark::State& state, const KernelTable* table, int n) {
  const int ld = Padded(n);
  Buffer l(Size(ld, n));
  const Eigen::LLT<Eigen::MatrixXd> llt(RandomSpd(n));
  CopyToPadded(llt.matrixLLT(), l, ld);
  const Eigen::VectorXd b = Eigen::VectorXd::Ones(n);
  Eigen::VectorXd x = b;
  for (auto _ : state) {
    x = b;
    if (table != nullptr) {
      table->cholesky_solve(n, l.data(), ld, x.data());
    } else {
      llt.solveInPlace(x);
    }
    benchmark::DoNotOptimize(x.data());
  }
  Flops(state, 2.0 * n * n);
}

void SolveMany(benchmark::State& state, const KernelTable* table, int n) {
  const int ld = Padded(n);
  Buffer l(Size(ld, n));
  Buffer b(Size(ld, n));
  const Eigen::LLT<Eigen::MatrixXd> llt(RandomSpd(n));
  CopyToPadded(llt.matrixLLT(), l, ld);
  Eigen::MatrixXd x;
  const Eigen::MatrixXd identity = Eigen::MatrixXd::Identity(n, n);
  for (auto _ : state) {
    if (table != nullptr) {
      CopyToPadded(identity, b, ld);
      table->forward_solve_many(n, l.data(), ld, n, b.data(), ld);
    } else {
      x = identity;
      llt.matrixL().solveInPlace(x);
    }
    benchmark::ClobberMemory();
  }
  Flops(state, 1.0 * n * n * n);
}

void Symv(benchmark::State& state, const KernelTable* table, int n) {
  const int ld = Padded(n);
  Buffer a(Size(ld, n));
  const Eigen::MatrixXd spd = RandomSpd(n);
  CopyToPadded(spd, a, ld);
  const Eigen::VectorXd x = Eigen::VectorXd::Ones(n);
  Eigen::VectorXd y(n);
  for (auto _ : state) {
    if (table != nullptr) {
      table->symv_lower(n, a.data(), ld, x.data(), y.data());
    } else {
      y.noalias() = spd.selfadjointView<Eigen::Lower>() * x;
    }
    benchmark::DoNotOptimize(y.data());
  }
  Flops(state, 2.0 * n * n);
}

void Syrk(benchmark::State& state, const KernelTable* table, int n, int depth) {
  const int ld = Padded(n);
  Buffer w(Size(ld, depth));
  Buffer s(Size(ld, n));
  const Eigen::MatrixXd panel = Eigen::MatrixXd::Random(n, depth);
  CopyToPadded(panel, w, ld);
  Eigen::MatrixXd sum = Eigen::MatrixXd::Zero(n, n);
  for (auto _ : state) {
    if (table != nullptr) {
      table->syrk_lower_sub(n, depth, w.data(), ld, s.data(), ld);
    } else {
      sum.selfadjointView<Eigen::Lower>().rankUpdate(panel, -1.0);
    }
    benchmark::ClobberMemory();
  }
  Flops(state, 1.0 * n * n * depth);
}

/// 64 landmarks, each seen by m of 49 cameras; every `stride`-th camera (1: neighbours). Eigen
/// subtracts landmark by landmark, the kernels block by block.
template <int kDim, int kDl>
void Schur(benchmark::State& state, const KernelTable* table, int m, int stride) {
  constexpr int kCameras = 49;
  constexpr int kLandmarks = 64;
  const int n = kCameras * kDim;
  const int ld = Padded(n);
  Buffer s(Size(ld, n));
  Eigen::Map<Eigen::MatrixXd> map(s.data(), ld, n);
  const auto camera = [&](int l, int a) {
    return (l * 17) % (kCameras - (m - 1) * stride) + a * stride;
  };
  std::vector<int32_t> slot;
  std::vector<uint16_t> landmark_of_slot;
  for (int l = 0; l < kLandmarks; ++l) {
    for (int a = 0; a < m; ++a) {
      slot.push_back((l * m + a) * kDim * kDl);
      landmark_of_slot.push_back(static_cast<uint16_t>(l));
    }
  }
  std::vector<SchurBlock> blocks;
  std::vector<SlotPair> pairs;
  for (int c = 0; c < kCameras; ++c) {
    for (int r = c; r < kCameras; ++r) {
      SchurBlock block{(int64_t{c} * ld + r) * kDim,
                       ld,
                       r == c ? r * kDim : -1,
                       static_cast<int32_t>(pairs.size()),
                       0,
                       c,
                       kDim,
                       kDim};
      for (int l = 0; l < kLandmarks; ++l) {
        for (int a = 0; a < m; ++a) {
          for (int b = 0; b <= a; ++b) {
            if (camera(l, a) == r && camera(l, b) == c)
              pairs.push_back({static_cast<uint16_t>(l * m + a), static_cast<uint16_t>(l * m + b)});
          }
        }
      }
      block.pair_end = static_cast<int32_t>(pairs.size());
      if (block.pair_end > block.pair_begin) blocks.push_back(block);
    }
  }
  Buffer z(slot.size() * kDim * kDl + 8), beta(Size(kLandmarks, kDl));
  for (std::size_t k = 0; k < z.size(); ++k)
    z.data()[k] = static_cast<double>(k % 13) / 13.0;
  Eigen::VectorXd b_s = Eigen::VectorXd::Zero(n);
  const SchurPanel panel{kDl,         kDim,        z.data(), slot.data(), landmark_of_slot.data(),
                         beta.data(), pairs.data()};
  using Block = Eigen::Matrix<double, kDim, kDl>;
  for (auto _ : state) {
    if (table != nullptr) {
      table->schur_blocks(&panel, static_cast<int64_t>(blocks.size()), blocks.data(), s.data(),
                          b_s.data());
    }
    for (int l = 0; l < kLandmarks && table == nullptr; ++l) {
      const Eigen::Map<const Eigen::Matrix<double, kDl, 1>> beta_l(beta.data() + l * kDl);
      for (int a = 0; a < m; ++a) {
        const Eigen::Map<const Block> za(z.data() + (l * m + a) * kDim * kDl);
        for (int b = 0; b <= a; ++b) {
          const Eigen::Map<const Block> zb(z.data() + (l * m + b) * kDim * kDl);
          map.block<kDim, kDim>(camera(l, a) * kDim, camera(l, b) * kDim).noalias() -=
              za * zb.transpose();
        }
        b_s.segment<kDim>(camera(l, a) * kDim).noalias() -= za * beta_l;
      }
    }
    benchmark::ClobberMemory();
  }
  Flops(state, kLandmarks * 1.0 * m * (m + 1) * kDim * kDim * kDl);
}

void InverseFactor(benchmark::State& state, const KernelTable* table) {
  const double h[9] = {4.0, 1.0, 0.5, 1.0, 3.0, 0.2, 0.5, 0.2, 2.0};
  double x[9];
  for (auto _ : state) {
    std::memcpy(x, h, sizeof(h));
    if (table != nullptr) {
      benchmark::DoNotOptimize(table->inverse_factor(3, x));
    } else {
      Eigen::Map<Eigen::Matrix3d> map(x);
      const Eigen::Matrix3d factor =
          map.selfadjointView<Eigen::Lower>().llt().matrixL().solve(Eigen::Matrix3d::Identity());
      map = factor;
    }
    benchmark::DoNotOptimize(x);
  }
}

template <typename Function>
void Register(const std::string& name, const Function& function) {
  const auto add = [&](const std::string& who, const KernelTable* table) {
    benchmark::RegisterBenchmark((name + "/" + who).c_str(), [=](benchmark::State& state) {
      function(state, table);
    })->MinTime(0.1);
  };
  add("eigen", nullptr);
  for (const Isa isa : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    if (const KernelTable* table = KernelsFor(isa)) add(table->name, table);
  }
}

void RegisterAll() {
  using benchmark::State;
  using Table = const KernelTable*;
  for (const int n : {30, 60, 90, 150, 192, 300, 441}) {
    const std::string size = std::to_string(n);
    Register("cholesky/" + size, [n](State& s, Table t) { Factor(s, t, n); });
    Register("cholesky_solve/" + size, [n](State& s, Table t) { SolveOne(s, t, n); });
    Register("forward_solve_many/" + size, [n](State& s, Table t) { SolveMany(s, t, n); });
    Register("symv_lower/" + size, [n](State& s, Table t) { Symv(s, t, n); });
  }
  for (const auto& [n, depth] : {std::pair{30, 25}, {60, 25}, {60, 250}, {165, 165}, {300, 100}}) {
    Register("syrk_lower_sub/" + std::to_string(n) + "x" + std::to_string(depth),
             [n = n, depth = depth](State& s, Table t) { Syrk(s, t, n, depth); });
  }
  for (const int stride : {1, 2, 5}) {
    const std::string tail = "/m6/stride" + std::to_string(stride);
    Register("schur_6x1" + tail, [=](State& s, Table t) { Schur<6, 1>(s, t, 6, stride); });
    Register("schur_6x3" + tail, [=](State& s, Table t) { Schur<6, 3>(s, t, 6, stride); });
    Register("schur_9x3" + tail, [=](State& s, Table t) { Schur<9, 3>(s, t, 6, stride); });
    Register("schur_15x1" + tail, [=](State& s, Table t) { Schur<15, 1>(s, t, 6, stride); });
  }
  Register("inverse_factor/3", InverseFactor);
}

}  // namespace
}  // namespace glissade::kernels

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 2;
  glissade::kernels::RegisterAll();
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
  return 0;
}
