// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The course's monocular BA run, two ways. With a correct linear solver its LM gives what ours
// gives; with the course's defective PCG plugged in it gives, digit by digit, what was published.
// Together they show that scene, H, b, elimination, damping and update are the course's, and what
// was wrong in it.
#include <gtest/gtest.h>

#include "regression/course_support.h"

namespace glissade {
namespace {

using test::CourseOptions;
using test::CourseRun;
using test::TextbookPcg;
using Digits = std::vector<std::string>;

Digits First(Digits digits, std::size_t n) {
  digits.resize(std::min(n, digits.size()));
  return digits;
}

TEST(CourseRun, ConvergedNothingFixed) {
  const CourseRun run({}, CourseOptions(false));
  EXPECT_TRUE(run.summary.converged()) << run.summary.BriefReport();
  EXPECT_EQ(First(run.Chi(), 4), (Digits{"5.35099", "0.0290846", "0.000100231", "9.85708e-05"}));
  EXPECT_EQ(First(run.Lambda(), 3), (Digits{"0.00597396", "0.00199132", "0.000663774"}));
  EXPECT_EQ(run.Chi().back(), "9.85708e-05");
  EXPECT_EQ(run.Point(0), "0.220958");
  EXPECT_EQ(run.Point(1), "0.234806");
  EXPECT_EQ(run.Point(19), "0.146673");
  EXPECT_EQ(run.Pose(2), (Digits{"-4.00178", "6.92753", "0.866931"}));
}

TEST(CourseRun, ConvergedTwoPosesFixed) {
  const CourseRun run({.fix_poses = 2}, CourseOptions(false));
  EXPECT_TRUE(run.summary.converged()) << run.summary.BriefReport();
  EXPECT_EQ(First(run.Chi(), 4), (Digits{"5.35099", "0.0282523", "0.000115056", "0.000113378"}));
  EXPECT_EQ(First(run.Lambda(), 3), (Digits{"0.00597396", "0.00199132", "0.000663774"}));
  EXPECT_EQ(run.Chi().back(), "0.000113378");
  EXPECT_EQ(run.Point(0), "0.220906");
  EXPECT_EQ(run.Point(1), "0.234339");
  EXPECT_EQ(run.Point(19), "0.146457");
  EXPECT_EQ(run.Pose(2), (Digits{"-3.99873", "6.92865", "0.859415"}));
}

TEST(CourseRun, CourseStop) {
  const CourseRun free({}, CourseOptions(true));
  EXPECT_EQ(free.Chi(), (Digits{"5.35099", "0.0290846", "0.000100231"}));
  EXPECT_EQ(free.Point(0), "0.220965");
  EXPECT_EQ(free.Point(1), "0.234874");
  EXPECT_EQ(free.Point(19), "0.146759");
  EXPECT_EQ(free.Pose(2), (Digits{"-4.00168", "6.92762", "0.866999"}));

  const CourseRun fixed({.fix_poses = 2}, CourseOptions(true));
  EXPECT_EQ(fixed.Chi(), (Digits{"5.35099", "0.0282523", "0.000115056"}));
  EXPECT_EQ(fixed.Point(0), "0.220908");
  EXPECT_EQ(fixed.Point(1), "0.234388");
  EXPECT_EQ(fixed.Point(19), "0.146536");
  EXPECT_EQ(fixed.Pose(2), (Digits{"-3.99859", "6.92912", "0.859659"}));
}

TEST(CourseRun, PublishedNothingFixed) {
  TextbookPcg pcg(true);
  SolveOptions options = CourseOptions(true);
  options.linear_solver = &pcg;
  const CourseRun run({}, options);
  EXPECT_EQ(run.Chi(), (Digits{"5.35099", "0.0289048", "0.000109162"}));
  EXPECT_EQ(run.Lambda(), (Digits{"0.00597396", "0.00199132", "0.000663774"}));
  EXPECT_EQ(run.Point(0), "0.220992");
  EXPECT_EQ(run.Point(1), "0.234854");
  EXPECT_EQ(run.Pose(2), (Digits{"-4.00232", "6.92678", "0.867244"}));
  // Drift along the null space, where rounding decides: four digits.
  const double drift[3] = {-0.000478, 0.00115904, 0.000366507};
  for (int i = 0; i < 3; ++i) {
    EXPECT_NEAR(run.problem.Get(run.handles.poses[0]).Data()[i], drift[i],
                1e-4 * std::abs(drift[i]) + 5e-9);
  }
}

TEST(CourseRun, PublishedTwoPosesFixed) {
  TextbookPcg pcg(true);
  SolveOptions options = CourseOptions(true);
  options.linear_solver = &pcg;
  const CourseRun run({.fix_poses = 2}, options);
  EXPECT_EQ(run.Chi(), (Digits{"5.35099", "0.0282599", "0.000117497"}));
  EXPECT_EQ(run.Lambda(), (Digits{"0.00597396", "0.00199132", "0.000663774"}));
  EXPECT_EQ(run.Point(0), "0.220909");
  EXPECT_EQ(run.Point(1), "0.234374");
  EXPECT_EQ(run.Point(19), "0.146533");
  EXPECT_EQ(run.Pose(2), (Digits{"-3.99917", "6.92852", "0.859878"}));
}

TEST(CourseRun, EveryCorrectSolverAgrees) {
  for (int fix : {0, 2}) {
    const CourseRun dense({.fix_poses = fix}, CourseOptions(true));
    for (auto preconditioner : {Preconditioner::kJacobi, Preconditioner::kBlockJacobi}) {
      SolveOptions options = CourseOptions(true);
      options.linear_solver_type = LinearSolverType::kPcg;
      options.pcg.preconditioner = preconditioner;
      const CourseRun ours({.fix_poses = fix}, options);
      EXPECT_EQ(ours.Chi(), dense.Chi());
      EXPECT_EQ(ours.Lambda(), dense.Lambda());
      EXPECT_EQ(ours.Pose(2), dense.Pose(2));
      EXPECT_NEAR(ours.summary.final_cost, dense.summary.final_cost,
                  1e-8 * dense.summary.final_cost);
    }
    // So does the course's own PCG once its first step is applied.
    TextbookPcg pcg(false);
    SolveOptions options = CourseOptions(true);
    options.linear_solver = &pcg;
    const CourseRun mended({.fix_poses = fix}, options);
    EXPECT_EQ(First(mended.Chi(), 2), First(dense.Chi(), 2));
    EXPECT_NEAR(mended.summary.final_cost, dense.summary.final_cost,
                1e-4 * dense.summary.final_cost);
  }
}

TEST(CourseRun, OurLmReachesTheSameOptimum) {
  for (int fix : {0, 2}) {
    const CourseRun course({.fix_poses = fix}, CourseOptions(false));
    const CourseRun ours({.fix_poses = fix}, test::ConvergedOptions());
    EXPECT_TRUE(ours.summary.converged());
    EXPECT_NEAR(ours.summary.final_cost, course.summary.final_cost,
                1e-10 * course.summary.final_cost);
  }
}

}  // namespace
}  // namespace glissade
