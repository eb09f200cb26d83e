// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The reduced system in its three forms: the same numbers wherever they are stored, and the same
// product where they are not.

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <cmath>
#include <memory>
#include <tuple>
#include <utility>

#include "common/sanitized.h"
#include "glissade/linear/normal_equations.h"
#include "glissade/vertices/vector.h"
#include "support/random_graph.h"

namespace glissade::test {
namespace {

class SchurStorageTest : public testing::TestWithParam<std::tuple<GraphKind, bool>> {
 protected:
  static constexpr DampingTerm kDamping{.lambda = 0.1};

  void Make(std::uint64_t seed, int num_threads = 1) {
    RandomGraphOptions options;
    options.num_poses = 3 + static_cast<int>(seed % 5) * 4;
    options.num_landmarks = 10 * options.num_poses;
    options.fixes = seed % 2 == 0;
    graph_ = MakeRandomGraph(std::get<0>(GetParam()), seed, options);
    threads_.Resize(num_threads);
    Status status = structure_.Analyze(&graph_, {.allow_duplicate_observations = true,
                                                 .group_landmarks = std::get<1>(GetParam())});
    ASSERT_TRUE(status.ok()) << status.message();
    double cost = 0.0;
    status = equations_.Linearize(structure_, &graph_, &threads_, &cost);
    ASSERT_TRUE(status.ok()) << status.message();
  }
  const SchurOperator& Eliminate(SchurForm form) {
    const Status status = equations_.Eliminate(structure_, graph_, kDamping, form, &threads_);
    EXPECT_TRUE(status.ok()) << status.message();
    return equations_.reduced();
  }
  /// All of S from the dense form.
  Eigen::MatrixXd Dense() {
    const SchurOperator& S = Eliminate(SchurForm::kDense);
    const auto n = static_cast<Eigen::Index>(S.layout().size());
    EXPECT_EQ(S.layout().blocks.size(), 1u);
    Eigen::MatrixXd out = Eigen::MatrixXd::Zero(n, n);
    const BlockView block = S.Block(0);
    for (Eigen::Index c = 0; c < n; ++c) {
      for (Eigen::Index r = c; r < n; ++r)
        out(r, c) = out(c, r) = block.data[r + c * block.stride];
    }
    return out;
  }
  static Eigen::VectorXd Direction(Eigen::Index n) {
    Eigen::VectorXd x(n);
    for (Eigen::Index k = 0; k < n; ++k)
      x[k] = std::sin(1.0 + 1.7 * static_cast<double>(k));
    return x;
  }
  static int NumSeeds() { return kSanitized ? 2 : 10; }

  Graph graph_;
  Structure structure_;
  NormalEquations equations_;
  ThreadPool threads_;
};

TEST_P(SchurStorageTest, FormsHoldTheSameNumbers) {
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    SCOPED_TRACE(seed);
    ASSERT_NO_FATAL_FAILURE(Make(static_cast<std::uint64_t>(seed)));
    const Eigen::MatrixXd dense = Dense();
    const std::vector<double> rhs = equations_.reduced_rhs();
    for (const SchurForm form : {SchurForm::kBlocks, SchurForm::kDiagonalBlocks}) {
      const SchurOperator& S = Eliminate(form);
      const SchurLayout& layout = S.layout();
      ASSERT_EQ(layout.size(), dense.rows());
      Eigen::MatrixXd left = dense;  // what no block covers
      int last_col = 0, last_row = -1;
      for (std::size_t k = 0; k < layout.blocks.size(); ++k) {
        const auto [row, col] = layout.blocks[k];
        EXPECT_TRUE(col > last_col || (col == last_col && row > last_row)) << "not by column";
        last_col = col;
        last_row = row;
        EXPECT_TRUE(form == SchurForm::kBlocks || row == col);
        const auto r0 = static_cast<Eigen::Index>(layout.offsets[static_cast<std::size_t>(row)]);
        const auto c0 = static_cast<Eigen::Index>(layout.offsets[static_cast<std::size_t>(col)]);
        const BlockView block = S.Block(k);
        for (int c = 0; c < layout.Dim(col); ++c) {
          for (int r = row == col ? c : 0; r < layout.Dim(row); ++r) {
            ASSERT_EQ(block.data[r + c * block.stride], dense(r0 + r, c0 + c));
            left(r0 + r, c0 + c) = left(c0 + c, r0 + r) = 0.0;
          }
        }
      }
      if (form == SchurForm::kBlocks) {
        EXPECT_TRUE(left.isZero(0.0));
      }
      EXPECT_EQ(equations_.reduced_rhs(), rhs);
    }
  }
}

TEST_P(SchurStorageTest, ProductsAgree) {
  for (int seed = 0; seed < NumSeeds(); ++seed) {
    SCOPED_TRACE(seed);
    ASSERT_NO_FATAL_FAILURE(Make(static_cast<std::uint64_t>(seed)));
    const Eigen::MatrixXd dense = Dense();
    // In the units of each variable's own curvature.
    const Eigen::VectorXd scale = dense.diagonal().cwiseSqrt();
    const Eigen::VectorXd x = Direction(dense.rows()).cwiseQuotient(scale);
    const Eigen::VectorXd expected = dense * x;
    for (const SchurForm form :
         {SchurForm::kDense, SchurForm::kBlocks, SchurForm::kDiagonalBlocks}) {
      Eigen::VectorXd y = Eigen::VectorXd::Constant(dense.rows(), NAN);
      Eliminate(form).Multiply(x.data(), y.data());
      EXPECT_LT((y - expected).cwiseQuotient(scale).norm(), 1e-11 * x.cwiseProduct(scale).norm())
          << "form " << static_cast<int>(form);
    }
  }
}

// An S that is not stored is applied by the equations: by those that there were before the move.
TEST_P(SchurStorageTest, ProductsComeAlongInAMove) {
  ASSERT_NO_FATAL_FAILURE(Make(3));
  const SchurOperator& S = Eliminate(SchurForm::kDiagonalBlocks);
  const Eigen::VectorXd x = Direction(static_cast<Eigen::Index>(S.layout().size()));
  Eigen::VectorXd before(x.size()), after(x.size());
  S.Multiply(x.data(), before.data());
  NormalEquations moved = std::move(equations_);
  equations_ = NormalEquations();
  moved.reduced().Multiply(x.data(), after.data());
  EXPECT_TRUE(after == before);
}

TEST_P(SchurStorageTest, SameBitsForAnyNumberOfThreads) {
  struct Result {
    Eigen::MatrixXd dense;
    std::vector<double> rhs;
    Eigen::VectorXd blocks, implicit;
  };
  const auto run = [&](int num_threads) {
    Result result;
    Make(4, num_threads);
    result.dense = Dense();
    result.rhs = equations_.reduced_rhs();
    const Eigen::VectorXd x = Direction(result.dense.rows());
    result.blocks.resize(x.size());
    result.implicit.resize(x.size());
    Eliminate(SchurForm::kBlocks).Multiply(x.data(), result.blocks.data());
    Eliminate(SchurForm::kDiagonalBlocks).Multiply(x.data(), result.implicit.data());
    return result;
  };
  const Result one = run(1);
  for (const int num_threads : {2, 3, 4}) {
    const Result many = run(num_threads);
    EXPECT_TRUE(many.dense == one.dense) << num_threads;
    EXPECT_EQ(many.rhs, one.rhs) << num_threads;
    EXPECT_TRUE(many.blocks == one.blocks) << num_threads;
    EXPECT_TRUE(many.implicit == one.implicit) << num_threads;
  }
}

/// A linear edge between scalars: r = x - y, weighted.
class Difference final : public DynamicEdge {
 public:
  explicit Difference(double weight) : H_{weight, -weight, -weight, weight}, weight_(weight) {}
  [[nodiscard]] Status CheckVertices(std::span<const VertexOps* const>) const override {
    return {};
  }
  [[nodiscard]] int ResidualDim() const override { return 1; }
  bool Evaluate(std::span<const VertexRef> v, double* r, double* const* J) const override {
    r[0] = std::sqrt(weight_) * (v[0].data[0] - v[1].data[0]);
    if (J != nullptr && J[0] != nullptr) J[0][0] = std::sqrt(weight_);
    if (J != nullptr && J[1] != nullptr) J[1][0] = -std::sqrt(weight_);
    return true;
  }
  [[nodiscard]] const double* ConstantHessian() const override { return H_; }
  bool LinearizeQuadratic(std::span<const VertexRef> v, double* gradient,
                          double* squared_norm) const override {
    const double d = v[0].data[0] - v[1].data[0];
    if (gradient != nullptr) {
      gradient[0] = weight_ * d;
      gradient[1] = -weight_ * d;
    }
    *squared_norm = weight_ * d * d;
    return true;
  }
  [[nodiscard]] std::unique_ptr<DynamicEdge> Clone() const override {
    return std::make_unique<Difference>(weight_);
  }

 private:
  double H_[4];
  double weight_;
};

// The constant H of a linear edge went through H_pp: cleared, added, summed over chunks and copied
// in every iteration, which made windows with a prior a third slower. It is not among what a
// linearization fills, and yet in S, in the diagonal and in H by its parts.
TEST(ConstantHessian, IsAddedToSAlone) {
  Graph graph;
  const AnyVertex x = graph.AddVertex(VertexVector<1>{}).value();
  const AnyVertex y = graph.AddVertex(VertexVector<1>{}).value();
  const AnyVertex z = graph.AddVertex(VertexVector<1>{}).value();
  const auto add = [&](double weight, AnyVertex a, AnyVertex b) {
    const AnyVertex vertices[] = {a, b};
    EXPECT_TRUE(graph.AddEdge(std::make_unique<Difference>(weight), vertices).ok());
  };
  add(2.0, x, y);
  add(3.0, z, y);  // against the order of the variables
  add(5.0, y, x);  // a pair that has one already
  for (const FirstEstimates mode : {FirstEstimates::kPriorOnly, FirstEstimates::kOff}) {
    graph.SetFirstEstimates(mode);
    Structure structure;
    NormalEquations equations;
    ThreadPool threads;
    double cost = 0.0;
    ASSERT_TRUE(structure.Analyze(&graph).ok());
    const bool apart = mode != FirstEstimates::kOff;
    EXPECT_EQ(structure.varying_blocks().size(), apart ? 3u : 5u);
    EXPECT_EQ(structure.h_blocks().size(), 5u);
    ASSERT_TRUE(equations.Linearize(structure, &graph, &threads, &cost).ok());
    EXPECT_EQ(equations.diagonal(), (std::vector<double>{7.0, 10.0, 3.0}));
    ASSERT_TRUE(
        equations.Eliminate(structure, graph, {.lambda = 0.0}, SchurForm::kDense, &threads).ok());
    const BlockView S = equations.reduced().Block(0);
    const double expected[3][3] = {{7.0, -7.0, 0.0}, {-7.0, 10.0, -3.0}, {0.0, -3.0, 3.0}};
    Eigen::Matrix3d whole = Eigen::Matrix3d::Zero();
    const Hessian H = equations.GetHessian(structure);
    for (std::size_t k = 0; k < H.num_pairs(); ++k)
      whole(H.Pair(k).row, H.Pair(k).col) = H.Pair(k).H(0, 0);
    for (int r = 0; r < 3; ++r) {
      EXPECT_EQ(H.Diagonal(r)(0, 0), expected[r][r]);
      for (int c = 0; c <= r; ++c) {
        EXPECT_NEAR(S.data[r + c * S.stride], expected[r][c], 1e-14) << r << ' ' << c;
        EXPECT_NEAR(whole(r, c), expected[r][c], 1e-14) << r << ' ' << c;
      }
    }
    EXPECT_NEAR(equations.QuadraticForm(structure, graph, {1.0, 0.0, 1.0}), 10.0, 1e-13);
  }
}

INSTANTIATE_TEST_SUITE_P(All, SchurStorageTest,
                         testing::Combine(testing::ValuesIn(kAllGraphKinds), testing::Bool()),
                         [](const auto& info) {
                           return ToString(std::get<0>(info.param)) +
                                  (std::get<1>(info.param) ? "Fused" : "");
                         });

}  // namespace
}  // namespace glissade::test
