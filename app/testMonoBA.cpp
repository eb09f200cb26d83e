// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The course's monocular bundle adjustment: three poses look at twenty points.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "common/cli.h"
#include "common/course.h"
#include "common/output_file.h"
#include "glissade/problem/problem.h"

namespace {

using namespace glissade;

constexpr const char* kName = "testMonoBA";

constexpr const char* kDescription =
    R"(Monocular bundle adjustment, the smallest example that shows everything: three poses
that see twenty points, whose inverse depths (in the first pose) start up to 1.5 m wrong.
The poses start at the truth, but nothing holds them: an image sequence of one camera
says nothing about where it was taken, in which direction, and at which scale. These are
the 7 degrees of freedom of the gauge, and the solution drifts along them.)";

constexpr const char* kFooter =
    R"(What is printed:
  K order: N                 first column of pose K in the normal equations
  iter: K , chi= , Lambda=   sum of squared residuals and damping after K accepted steps
  point K                    inverse depth: truth, start, solution (1/m)
  translation K              position: solution and truth (m)
  marginalization            a chain of three variables before variable 2 is moved last, after the
                             move, and after it is marginalized: the zero between variables 1 and 3
                             is gone

Examples:
  testMonoBA                       nothing held: pose 0 leaves its place, chi is what it is
  testMonoBA --fix 2               two poses held: position, direction and scale are known
  testMonoBA --prior-weight 1e4    priors instead
  testMonoBA --course-stop         ends when the course's code does, one step early
  testMonoBA --lm default --verbose
                                   the library's own Levenberg-Marquardt, with its table

Exit code: 0, or 2 where an option or the scene makes no sense.)";

struct Options {
  int fix = 0;
  double prior_weight = 0.0;
  int iterations = 100;
  std::string linear_solver = "dense";
  std::string lm = "course";
  bool course_stop = false;
  std::string scene;
  bool verbose = false;
  std::string json;
};

void AddOptions(CLI::App& app, Options& o) {
  app.add_option("--fix", o.fix, "Hold the first N poses at their truth")->type_name("N");
  app.add_option("--prior-weight", o.prior_weight,
                 "Priors on the first two poses, with information W (1/m^2, 1/rad^2)")
      ->type_name("W");
  app.add_option("--lm", o.lm,
                 "'course' (default): lambda I on the pose block, lambda0 = 1e-5 max diag(H). "
                 "'default': the library's own")
      ->type_name("WHICH");
  app.add_flag("--course-stop", o.course_stop,
               "Stop where the course's code does: before a step with |dx|^2 <= 1e-6");
  app.add_option("--iterations", o.iterations, "At most N steps (default 100)")->type_name("N");
  app.add_option("--linear-solver", o.linear_solver, "'dense' (default) or 'pcg'")
      ->type_name("WHICH");
  app.add_option("--scene", o.scene, "Solve the scene of FILE, not the built-in one")
      ->type_name("FILE");
  app.add_flag("--verbose", o.verbose, "Print the table of all steps, rejected ones too");
  app.add_option("--json", o.json, "Write the result to FILE")->type_name("FILE");
}

Status MakeSolveOptions(const Options& o, SolveOptions* solve) {
  if (o.lm == "course") {
    *solve = app::CourseLm();
  } else if (o.lm != "default") {
    return {StatusCode::kInvalidArgument, "--lm: must be course or default, not " + o.lm};
  }
  solve->course_stop = o.course_stop;
  solve->max_iterations = o.iterations;
  return app::FirstError({app::SetLinearSolver(o.linear_solver, solve),
                          app::CheckRange("--iterations", o.iterations, 0, 1000000),
                          app::CheckAtLeast("--prior-weight", o.prior_weight, 0.0)});
}

template <class M>
void PrintMatrix(const char* title, const M& m) {
  fmt::print("\n{}\n", title);
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j)
      fmt::print("{:>10.6g}", m(i, j));
    fmt::print("\n");
  }
}

void PrintSolve(const Problem& problem, const CourseHandles& handles, const SolveSummary& summary,
                const Options& o) {
  int order = 0;
  for (std::size_t k = 0; k < handles.poses.size(); ++k, order += VertexPose::kTangentDim)
    fmt::print("{} order: {}\n", k, order);
  fmt::print("\n ordered landmark vertices size : {}\n", handles.points.size());
  int k = 0;
  for (const IterationSummary& it : summary.iterations) {
    if (!it.accepted) continue;
    fmt::print("iter: {} , chi= {:.6g} , Lambda= {:.6g}\n", k++, 2.0 * it.cost, it.lambda);
  }
  fmt::print("solved in {:.6g} ms, of which {:.6g} ms for the normal equations\n",
             1e3 * summary.time.total_s,
             1e3 * (summary.time.linearize_s + summary.time.eliminate_s));
  fmt::print("{}: sum of Chi2 {:.6g}\n", ToString(summary.termination), problem.Chi2().value());
  if (!o.verbose) return;
  fmt::print("\n{}\n", IterationTableHeader());
  for (const IterationSummary& it : summary.iterations)
    fmt::print("{}\n", ToString(it));
}

void PrintResult(const CourseScene& scene, const Problem& problem, const CourseHandles& handles) {
  fmt::print("\nInverse depths of the points (1/m): truth, start, solution\n");
  for (std::size_t k = 0; k < scene.points.size(); ++k) {
    fmt::print("point {} : gt {:.6g} , noise {:.6g} , opt {:.6g}\n", k,
               scene.TrueInverseDepth(scene.points[k]), scene.points[k].rho_init,
               problem.Get(handles.points[k]).rho);
  }
  fmt::print("\nTranslations of the poses (m): solution, truth\n");
  for (std::size_t k = 0; k < scene.poses.size(); ++k) {
    const double* t = problem.Get(handles.poses[k]).Data();
    const double* gt = scene.poses[k].data;
    fmt::print("translation {} : {:.6g} {:.6g} {:.6g} , gt {:.6g} {:.6g} {:.6g}\n", k, t[0], t[1],
               t[2], gt[0], gt[1], gt[2]);
  }
}

template <class M>
nlohmann::json RowsOf(const M& m) {
  auto rows = nlohmann::json::array();
  for (int i = 0; i < m.rows(); ++i) {
    auto row = nlohmann::json::array();
    for (int j = 0; j < m.cols(); ++j)
      row.push_back(m(i, j));
    rows.push_back(row);
  }
  return rows;
}

nlohmann::ordered_json ToJson(const CourseScene& scene, const Problem& problem,
                              const CourseHandles& handles, const SolveSummary& summary,
                              const MarginalizeExample& example) {
  nlohmann::ordered_json json;
  json["iterations"] = nlohmann::json::array();
  int k = 0;
  for (const IterationSummary& it : summary.iterations) {
    if (!it.accepted) continue;
    json["iterations"].push_back({{"iter", k++}, {"chi", 2.0 * it.cost}, {"lambda", it.lambda}});
  }
  json["converged_chi"] = problem.Chi2().value();
  json["status"] = ToString(summary.termination);
  json["points"] = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    json["points"].push_back({{"gt", scene.TrueInverseDepth(scene.points[i])},
                              {"noise", scene.points[i].rho_init},
                              {"opt", problem.Get(handles.points[i]).rho}});
  }
  json["poses"] = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.poses.size(); ++i) {
    const double* t = problem.Get(handles.poses[i]).Data();
    const double* gt = scene.poses[i].data;
    json["poses"].push_back({{"t", {t[0], t[1], t[2]}}, {"gt", {gt[0], gt[1], gt[2]}}});
  }
  json["marginalize"] = {{"before", RowsOf(example.before)},
                         {"moved", RowsOf(example.moved)},
                         {"after", RowsOf(example.after)}};
  return json;
}

int Run(const Options& o) {
  SolveOptions solve;
  if (Status s =
          app::FirstError({MakeSolveOptions(o, &solve), app::CheckWritable("--json", o.json)});
      !s.ok()) {
    return app::Refuse(kName, s.message());
  }
  const auto scene = app::LoadScene(o.scene);
  if (!scene.ok()) return app::Refuse(kName, scene.status().message());
  if (Status s = app::CheckRange("--fix", o.fix, 0, static_cast<int>(scene->poses.size()));
      !s.ok()) {
    return app::Refuse(kName, s.message());
  }

  Problem problem;
  const auto handles =
      AddToGraph(*scene, problem, {.fix_poses = o.fix, .prior_weight = o.prior_weight});
  if (!handles.ok()) return app::Refuse(kName, handles.status().message());
  const SolveSummary& summary = problem.Solve(solve);
  if (!summary.ok()) return app::Refuse(kName, summary.status.message());

  const MarginalizeExample example = TestMarginalize();
  PrintSolve(problem, *handles, summary, o);
  PrintResult(*scene, problem, *handles);
  PrintMatrix("Marginalization: information of a chain of three variables", example.before);
  PrintMatrix("... with variable 2 moved last", example.moved);
  PrintMatrix("... after marginalizing it: variables 1 and 3 are linked", example.after);
  if (!o.json.empty()) {
    const std::string text = ToJson(*scene, problem, *handles, summary, example).dump(2) + "\n";
    if (Status s = app::WriteFile(o.json, text); !s.ok()) {
      return app::Refuse(kName, s.message(), app::kExitFailed);
    }
  }
  return app::kExitOk;
}

}  // namespace

int main(int argc, char** argv) {
  CLI::App cli(kDescription, kName);
  cli.footer(kFooter);
  Options options;
  AddOptions(cli, options);
  if (const auto exit_code = app::Parse(cli, argc, argv)) return *exit_code;
  return Run(options);
}
