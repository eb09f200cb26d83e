// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/io/colmap_graph.h"

#include <gtest/gtest.h>

#include <cmath>
#include <filesystem>

#include "common/data_dir.h"
#include "common/sanitized.h"
#include "glissade/io/colmap_bal.h"
#include "glissade/losses/huber.h"
#include "glissade/problem/problem.h"
#include "io/temp_file.h"
#include "support/colmap_scene.h"

// Bundle adjustment of a COLMAP model, from files to files.

namespace glissade {
namespace {

using test::ColmapSceneOptions;
using test::MakeColmapScene;
using test::PerturbColmapScene;
using enum ColmapCameraModel;

/// By the formulas of the documentation.
double MeanErrorByFormula(const ColmapModel& model, const ColmapPoint& point) {
  double sum = 0.0;
  for (const ColmapTrackElement& element : point.track) {
    for (const ColmapImage& image : model.images) {
      if (image.id != element.image) continue;
      for (const ColmapCamera& camera : model.cameras) {
        if (camera.id != image.camera) continue;
        Quaternion q(image.q[0], image.q[1], image.q[2], image.q[3]);
        q.normalize();
        const Vector3 p_c = q * Vector3(point.xyz) + Vector3(image.t);
        const ColmapFeature& feature = image.features[element.feature];
        sum += (test::ProjectColmapByFormula(camera, p_c) - Vector2(feature.x, feature.y)).norm();
      }
    }
  }
  return sum / static_cast<double>(point.track.size());
}

double MeanError(const ColmapModel& model) {
  double sum = 0.0;
  for (const ColmapPoint& point : model.points)
    sum += MeanErrorByFormula(model, point);
  return sum / static_cast<double>(model.points.size());
}

/// Angle between the viewing directions of two images, which no gauge changes.
double AngleBetween(const ColmapImage& a, const ColmapImage& b) {
  const Quaternion qa(a.q[0], a.q[1], a.q[2], a.q[3]), qb(b.q[0], b.q[1], b.q[2], b.q[3]);
  return so3::Log(Quaternion((qa * qb.conjugate()).normalized())).norm();
}

class ColmapGraph : public testing::TestWithParam<std::vector<ColmapCameraModel>> {};

TEST_P(ColmapGraph, FromFilesToFiles) {
  ColmapSceneOptions scene;
  scene.cameras = GetParam();
  scene.images = 12;
  scene.points = 150;
  const ColmapModel truth = MakeColmapScene(scene, 7);
  TempFiles files;
  ASSERT_TRUE(WriteColmap(PerturbColmapScene(truth, 8), files.Path("in")).ok());

  ColmapModel model = ReadColmap(files.Path("in")).value();
  const double before = MeanError(model);
  Problem problem;
  const auto handles = AddToGraph(model, problem);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(problem.NumVertices<VertexPose>(), scene.images);
  EXPECT_EQ(problem.NumVertices<VertexPointXYZ>(), static_cast<int>(model.points.size()));
  EXPECT_EQ(problem.NumVertices<VertexVector<5>>() + problem.NumVertices<VertexVector<8>>(),
            static_cast<int>(scene.cameras.size()));
  EXPECT_EQ(problem.NumEdges(), handles->num_observations);
  const SolveSummary& summary = problem.Solve({.max_iterations = 100});
  ASSERT_TRUE(summary.converged()) << summary.BriefReport();
  const ColmapModel start = model;
  ASSERT_TRUE(UpdateFromGraph(problem, handles.value(), &model).ok());
  ASSERT_TRUE(WriteColmap(model, files.Path("out"), ColmapFormat::kText).ok());

  const ColmapModel out = ReadColmap(files.Path("out")).value();
  EXPECT_TRUE(out == model);
  EXPECT_GT(before, 5.0);
  // Uniform noise of +-0.51 px in u and v: the distance from its middle is 0.39 px on average.
  EXPECT_LT(MeanError(out), 0.4);
  double squares = 0.0;
  for (const ColmapPoint& point : out.points) {
    EXPECT_NEAR(point.error, MeanErrorByFormula(out, point), 1e-9);
    squares += point.error;
  }
  EXPECT_GT(squares, 0.0);
  for (std::size_t k = 0; k < out.cameras.size(); ++k) {
    const ColmapCamera &camera = out.cameras[k], &true_camera = truth.cameras[k];
    const bool two =
        camera.model == kPinhole || camera.model == kOpenCv || camera.model == kOpenCvFisheye;
    for (std::size_t i = 0; i < (two ? 2u : 1u); ++i) {
      EXPECT_NEAR(camera.parameters[i], true_camera.parameters[i], 3.0);
      EXPECT_NE(camera.parameters[i], start.cameras[k].parameters[i]);
    }
    const std::size_t c = two ? 2 : 1;
    EXPECT_EQ(camera.parameters[c], true_camera.parameters[c]) << "held";
    EXPECT_EQ(camera.parameters[c + 1], true_camera.parameters[c + 1]) << "held";
  }
  for (std::size_t k = 1; k < out.images.size(); ++k) {
    EXPECT_NEAR(AngleBetween(out.images[k], out.images[0]),
                AngleBetween(truth.images[k], truth.images[0]), 3e-3);
    EXPECT_EQ(out.images[k].features, truth.images[k].features);
    EXPECT_EQ(out.images[k].name, truth.images[k].name);
  }
}

INSTANTIATE_TEST_SUITE_P(
    Cameras, ColmapGraph,
    testing::Values(std::vector{kSimplePinhole}, std::vector{kPinhole}, std::vector{kSimpleRadial},
                    std::vector{kRadial}, std::vector{kOpenCv}, std::vector{kOpenCvFisheye},
                    std::vector{kRadial, kSimplePinhole, kOpenCv, kOpenCvFisheye}));

TEST(ColmapToGraph, BackWithoutASolveIsTheSameModel) {
  const ColmapModel model = MakeColmapScene({.cameras = {kOpenCv, kSimpleRadial}}, 3);
  Problem problem;
  const auto handles = AddToGraph(model, problem);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  ColmapModel back = model;
  ASSERT_TRUE(UpdateFromGraph(problem, handles.value(), &back).ok());
  EXPECT_EQ(back.cameras, model.cameras);
  for (std::size_t k = 0; k < model.images.size(); ++k) {
    for (int i = 0; i < 4; ++i)
      EXPECT_NEAR(back.images[k].q[i], model.images[k].q[i], 1e-15);
    for (int i = 0; i < 3; ++i)
      EXPECT_NEAR(back.images[k].t[i], model.images[k].t[i], 1e-14);
  }
  // The cost is half the sum of squared distances.
  double squares = 0.0;
  problem.ForEachEdge<EdgeReprojectionRadial>(
      [&](auto edge, const auto&) { squares += problem.Chi2(edge).value(); });
  problem.ForEachEdge<EdgeReprojectionRadtan>(
      [&](auto edge, const auto&) { squares += problem.Chi2(edge).value(); });
  EXPECT_NEAR(problem.Cost().value(), 0.5 * squares, 1e-12 * squares);
  for (const ColmapPoint& point : back.points)
    EXPECT_NEAR(point.error, MeanErrorByFormula(model, point), 1e-10);
}

TEST(ColmapToGraph, ABalProblemIsTheSameProblem) {
  const auto path = test::DataDir() / "bal" / "ladybug-problem-49-7776-pre.txt.gz";
  if (!std::filesystem::exists(path)) GTEST_SKIP() << "no file " << path;
  const auto bal = ReadBal(path.string());
  ASSERT_TRUE(bal.ok()) << bal.status().message();
  Problem expected, problem;
  ASSERT_TRUE(AddToGraph(bal.value(), expected).ok());
  const ColmapModel model = ColmapFromBal(bal.value()).value();
  ASSERT_TRUE(CheckColmap(model).ok()) << CheckColmap(model).message();
  const auto handles = AddToGraph(model, problem);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(handles->num_observations, static_cast<std::int64_t>(bal->observations.size()));
  const double cost = expected.Cost().value();
  EXPECT_NEAR(problem.Cost().value(), cost, 1e-11 * cost);
  if (test::kSanitized) return;
  // Rotations have another chart, so that steps differ, but not where they end.
  SolveOptions options;
  options.max_iterations = 100;
  const SolveSummary& theirs = expected.Solve(options);
  const SolveSummary& ours = problem.Solve(options);
  ASSERT_TRUE(theirs.ok() && ours.ok());
  EXPECT_NEAR(ours.final_cost, theirs.final_cost, 2e-3 * theirs.final_cost)
      << ours.BriefReport() << "\n"
      << theirs.BriefReport();
}

TEST(ColmapToGraph, ABalProblemThatNamesWhatThereIsNotIsRefused) {
  BalProblem bal;
  EXPECT_FALSE(ColmapFromBal(bal).ok());
  bal.cameras.resize(1);
  bal.points.resize(2);
  bal.observations = {{0, 0, 1.0, 2.0}, {0, 1, -1.0, 5.0}};
  EXPECT_TRUE(ColmapFromBal(bal).ok());
  bal.observations[1].point = 2;
  EXPECT_EQ(ColmapFromBal(bal).status().code(), StatusCode::kInvalidArgument);
  bal.observations[1] = {-1, 0, 1.0, 2.0};
  EXPECT_EQ(ColmapFromBal(bal).status().code(), StatusCode::kInvalidArgument);
  bal.observations[1] = {0, 0, std::nan(""), 2.0};
  EXPECT_FALSE(ColmapFromBal(bal).ok());
}

TEST(ColmapToGraph, OptionsSayWhatIsEstimated) {
  const ColmapModel model = MakeColmapScene({.cameras = {kRadial, kPinhole, kOpenCv}}, 4);
  const auto held = [&](const ColmapGraphOptions& options, std::size_t camera) {
    Problem problem;
    const auto handles = AddToGraph(model, problem, options);
    EXPECT_TRUE(handles.ok()) << handles.status().message();
    const AnyVertex vertex = handles->cameras[camera];
    return problem.GetFixed(vertex) == Fix::kWhole ? ~0u : problem.FixedNumbers(vertex);
  };
  EXPECT_EQ(held({}, 0), 0b00110u);
  EXPECT_EQ(held({}, 1), 0b11111100u);
  EXPECT_EQ(held({}, 2), 0b00001100u);
  EXPECT_EQ(held({.free_principal_point = true}, 0), 0u);
  EXPECT_EQ(held({.free_principal_point = true}, 1), 0b11110000u);
  EXPECT_EQ(held({.free_focal_length = false}, 0), 0b00111u);
  EXPECT_EQ(held({.free_focal_length = false}, 1), ~0u);
  EXPECT_EQ(held({.free_distortion = false}, 2), 0b11111100u);
  EXPECT_EQ(held({.free_focal_length = false, .free_distortion = false}, 2), ~0u);

  Problem problem;
  const auto handles = AddToGraph(model, problem, {.fix_first_image = true});
  EXPECT_EQ(problem.GetFixed(handles->images[0]), Fix::kWhole);
  EXPECT_EQ(problem.GetFixed(handles->images[1]), Fix::kFree);
}

TEST(ColmapToGraph, GaugesDoNotChangeTheOptimum) {
  const ColmapModel start =
      PerturbColmapScene(MakeColmapScene({.cameras = {kSimpleRadial, kPinhole}}, 11), 12);
  double free_cost = 0.0;
  for (const int gauge : {0, 1, 2}) {
    Problem problem;
    const auto handles = AddToGraph(start, problem, {.fix_first_image = gauge == 2});
    ASSERT_TRUE(handles.ok()) << handles.status().message();
    SolveOptions options;
    options.max_iterations = 200;
    options.cost_tolerance = 1e-13;
    if (gauge == 1) options.gauge = Gauge::Fixed{handles->images[0]};
    const Pose before = problem.Get(handles->images[0]).pose;
    const SolveSummary& summary = problem.Solve(options);
    ASSERT_TRUE(summary.converged()) << summary.BriefReport();
    if (gauge == 0) free_cost = summary.final_cost;
    EXPECT_NEAR(summary.final_cost, free_cost, 1e-8 * free_cost) << gauge;
    EXPECT_EQ(problem.Get(handles->images[0]).pose == before, gauge != 0);
  }
}

TEST(ColmapToGraph, WhatIsSeenTooRarelyIsLeftOutAndSaid) {
  ColmapModel model = MakeColmapScene({.images = 4, .points = 20}, 5);
  const std::size_t before = model.points.size();
  std::int64_t rare = 0;
  for (const ColmapPoint& point : model.points)
    rare += point.track.size() < 2 ? 1 : 0;
  // A point in one image, twice in another one, and an image that sees the first of them alone.
  ColmapImage lonely = model.images[0];
  lonely.id = 9000;
  lonely.features = {{1, 2, 77}, {3, 4, 78}, {5, 6, 78}};
  model.images.push_back(lonely);
  model.points.push_back({77, {0, 0, 0}, {}, 0.5, {{9000, 0}}});
  model.points.push_back({78, {0, 0, 0}, {}, 0.5, {{9000, 1}, {9000, 2}}});
  // A point that is three times in its first image.
  for (ColmapPoint& point : model.points) {
    if (point.track.size() < 2) continue;
    for (ColmapImage& image : model.images) {
      if (image.id != point.track[0].image) continue;
      for (int k = 0; k < 2; ++k) {
        point.track.push_back({image.id, static_cast<std::uint32_t>(image.features.size())});
        image.features.push_back({500, 400, point.id});
      }
    }
    break;
  }
  Problem problem;
  const auto handles = AddToGraph(model, problem);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_EQ(handles->num_points_left_out, rare + 2);
  EXPECT_EQ(handles->num_images_left_out, 1);
  EXPECT_EQ(handles->num_features_left_out, 2);
  EXPECT_FALSE(problem.Contains(handles->images.back()));
  EXPECT_FALSE(problem.Contains(handles->points[before]));
  ASSERT_TRUE(problem.Solve({.max_iterations = 3}).ok());
  ColmapModel out = model;
  ASSERT_TRUE(UpdateFromGraph(problem, handles.value(), &out).ok());
  EXPECT_EQ(out.images.back(), model.images.back());
  EXPECT_EQ(out.points.back(), model.points.back());
}

TEST(ColmapToGraph, Refusals) {
  const ColmapModel good = MakeColmapScene({.cameras = {kSimpleRadial, kOpenCv}}, 6);
  const auto refuse = [&](const char* what, auto change, ColmapGraphOptions options = {}) {
    ColmapModel model = good;
    change(model);
    Problem problem;
    const auto handles = AddToGraph(model, problem, options);
    ASSERT_FALSE(handles.ok()) << what;
    EXPECT_NE(handles.status().message().find(what), std::string::npos)
        << handles.status().message();
    EXPECT_EQ(problem.NumVertices(), 0);
    EXPECT_TRUE(problem.first_refusal().ok());
  };
  for (const ColmapCameraModel unsupported :
       {kFullOpenCv, kFov, kSimpleRadialFisheye, kRadialFisheye, kThinPrismFisheye}) {
    refuse(std::string(ColmapModelName(unsupported)).c_str(), [&](ColmapModel& model) {
      model.cameras[1] = test::MakeColmapCamera(model.cameras[1].id, unsupported);
    });
  }
  refuse("focal length of camera", [](ColmapModel& m) { m.cameras[0].parameters[0] = -1.0; });
  refuse("no point that two images see", [](ColmapModel& m) {
    m.points.clear();
    for (ColmapImage& image : m.images)
      image.features.clear();
  });
  refuse("which there is not", [](ColmapModel& m) { m.points.clear(); });
  refuse("Huber", [](ColmapModel&) {}, {.loss = Huber{-1.0}});
  // A camera that cannot be solved for does not matter where nothing is seen by it.
  ColmapModel idle = good;
  idle.cameras.push_back(test::MakeColmapCamera(7, kFov));
  Problem problem;
  const auto handles = AddToGraph(idle, problem);
  ASSERT_TRUE(handles.ok()) << handles.status().message();
  EXPECT_FALSE(handles->cameras[2]);

  // Handles of another graph or model; a model that was broken since.
  ColmapModel broken = idle;
  broken.points[3].track[0].image = 12345;
  EXPECT_FALSE(UpdateFromGraph(problem, handles.value(), &broken).ok());
  ColmapModel other = MakeColmapScene({.images = 5}, 6), same = idle;
  EXPECT_EQ(UpdateFromGraph(problem, handles.value(), &other).code(), StatusCode::kInvalidArgument);
  Problem elsewhere;
  EXPECT_EQ(UpdateFromGraph(elsewhere, handles.value(), &same).code(), StatusCode::kUnknownHandle);
  ASSERT_TRUE(problem.RemoveVertex(handles->points[3]).ok());
  EXPECT_EQ(UpdateFromGraph(problem, handles.value(), &same).code(), StatusCode::kUnknownHandle);
  EXPECT_TRUE(same == idle);
}

}  // namespace
}  // namespace glissade
