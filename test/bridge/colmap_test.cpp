// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <gtest/gtest.h>

#include <cmath>
#include <string>

#include "glissade/bridge/ceres.h"
#include "glissade/io/colmap_graph.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "support/colmap_scene.h"

// COLMAP models, against Ceres.

namespace glissade::test {
namespace {

struct Case {
  const char* name;
  std::vector<ColmapCameraModel> cameras;
  ColmapGraphOptions options;
};

std::vector<Case> Cases() {
  using enum ColmapCameraModel;
  ColmapGraphOptions all, fixed_first, robust;
  all.free_principal_point = true;
  fixed_first.fix_first_image = true;
  robust.loss = Huber{1.0};
  return {{"OneForAll", {kSimpleRadial}, {}},
          {"OneForAllWithPrincipalPoint", {kOpenCv}, all},
          {"SimplePinhole", {kSimplePinhole}, fixed_first},
          {"Fisheye", {kOpenCvFisheye}, robust},
          {"Several", {kRadial, kPinhole, kOpenCvFisheye, kSimpleRadial}, fixed_first}};
}

class ColmapTest : public testing::TestWithParam<Case> {
 protected:
  ColmapTest() {
    ColmapSceneOptions options;
    options.cameras = GetParam().cameras;
    options.images = 12;
    options.points = 120;
    start_ = PerturbColmapScene(MakeColmapScene(options, 21), 22);
  }
  void SetUp() override {
    auto handles = AddToGraph(start_, problem_, GetParam().options);
    ASSERT_TRUE(handles.ok()) << handles.status().message();
    handles_ = handles.value();
  }

  ColmapModel start_;
  Problem problem_;
  ColmapHandles handles_;
};

TEST_P(ColmapTest, StartCostGradientAndHessian) {
  ASSERT_TRUE(problem_.MakeHessian().ok());
  const bridge::CeresProblem exported = bridge::Export(problem_);
  const auto ceres = bridge::Linearize(exported, problem_.FreeVertices());
  ASSERT_TRUE(ceres.ok()) << ceres.status().message();
  const double cost = problem_.Cost().value();
  EXPECT_NEAR(cost, ceres->cost, 1e-12 * cost);
  const Eigen::VectorXd b = problem_.Rhs();
  ASSERT_EQ(b.size(), ceres->gradient.size());
  EXPECT_LT((b + ceres->gradient).norm(), 1e-11 * b.norm());
  const Eigen::MatrixXd H = ceres->Hessian();
  EXPECT_LT((problem_.Hessian() - H).norm(), 1e-12 * H.norm());
}

TEST_P(ColmapTest, SameOptimum) {
  Problem theirs = problem_.Clone();
  SolveOptions options;
  options.max_iterations = 200;
  options.cost_tolerance = 1e-14;
  const SolveSummary& summary = problem_.Solve(options);
  ASSERT_TRUE(summary.converged()) << summary.BriefReport();
  ceres::Solver::Options ceres_options;
  ceres_options.linear_solver_type = ceres::DENSE_SCHUR;
  ceres_options.max_num_iterations = 200;
  ceres_options.function_tolerance = 1e-14;
  ceres_options.parameter_tolerance = 1e-14;
  ceres_options.gradient_tolerance = 1e-14;
  const ceres::Solver::Summary ceres_summary = bridge::SolveWithCeres(&theirs, ceres_options);
  ASSERT_TRUE(ceres_summary.IsSolutionUsable());
  EXPECT_NEAR(summary.final_cost, ceres_summary.final_cost, 1e-9 * ceres_summary.final_cost)
      << summary.BriefReport() << "\n"
      << ceres_summary.BriefReport();
  // Uniform noise of 1.7 x 0.3 px: what is left is that, at most.
  EXPECT_LT(summary.final_cost, 0.02 * summary.initial_cost);

  ColmapModel ours_model = start_, theirs_model = start_;
  ASSERT_TRUE(UpdateFromGraph(problem_, handles_, &ours_model).ok());
  ASSERT_TRUE(UpdateFromGraph(theirs, handles_, &theirs_model).ok());
  for (std::size_t k = 0; k < start_.cameras.size(); ++k) {
    const auto &a = ours_model.cameras[k].parameters, &b = theirs_model.cameras[k].parameters;
    for (std::size_t i = 0; i < a.size(); ++i)
      EXPECT_NEAR(a[i], b[i], 1e-4 * (1e-2 + std::abs(b[i]))) << k << " " << i;
  }
  for (std::size_t k = 0; k < start_.points.size(); ++k)
    EXPECT_NEAR(ours_model.points[k].error, theirs_model.points[k].error, 1e-4);
}

INSTANTIATE_TEST_SUITE_P(Models, ColmapTest, testing::ValuesIn(Cases()),
                         [](const auto& param) { return std::string(param.param.name); });

}  // namespace
}  // namespace glissade::test
