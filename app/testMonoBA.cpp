// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// The course's monocular bundle adjustment: three poses look at twenty points.
#include <fmt/format.h>

#include <nlohmann/json.hpp>
#include <string>

#include "common/course.h"
#include "common/options.h"
#include "common/output_file.h"
#include "common/program.h"
#include "common/solver_options.h"
#include "common/version.h"
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
  testMonoBA --method lm --verbose the library's own Levenberg-Marquardt, with its table

Exit code: 0; 130 after Ctrl-C; 2 where an option or the scene makes no sense.)";

struct Options {
  int fix = 0;
  double prior_weight = 0.0;
  app::SolverOptions solver;
  std::string scene;
  bool verbose = false;
  std::string json;

  Options() {
    solver.method = "course";
    solver.solve.max_iterations = 100;
  }
};

void AddOptions(app::Program& program, Options& o) {
  CLI::App& cli = program.cli();
  app::AddInteger(cli, "--fix", &o.fix, 0, 1000000, "Hold the first N poses at their truth");
  app::AddNumber(cli, "--prior-weight", &o.prior_weight, 0.0, 1e30,
                 "Priors on the first two poses, with information X (1/m^2, 1/rad^2)");
  app::AddMethod(cli, &o.solver, true);
  cli.add_flag("--course-stop", o.solver.solve.course_stop,
               "Stop where the course's code does: before a step with |dx|^2 <= 1e-6");
  app::AddLinearSolver(cli, &o.solver);
  app::AddIterations(cli, &o.solver);
  app::AddThreads(cli, &o.solver);
  cli.add_option("--scene", o.scene, "Solve the scene of FILE, not the built-in one")
      ->type_name("FILE");
  cli.add_flag("--verbose", o.verbose, "Print every step, too");
  program.AddJson(&o.json);
}

template <class M>
void PrintMatrix(const char* title, const M& m) {
  app::Print("\n{}\n", title);
  for (int i = 0; i < m.rows(); ++i) {
    for (int j = 0; j < m.cols(); ++j)
      app::Print("{:>10.6g}", m(i, j));
    app::Print("\n");
  }
}

void PrintSolve(const Problem& problem, const CourseHandles& handles, const SolveSummary& summary,
                const Options& o) {
  int order = 0;
  for (std::size_t k = 0; k < handles.poses.size(); ++k, order += VertexPose::kTangentDim)
    app::Print("{} order: {}\n", k, order);
  app::Print("\n ordered landmark vertices size : {}\n", handles.points.size());
  int k = 0;
  for (const IterationSummary& it : summary.iterations) {
    if (!it.accepted) continue;
    app::Print("iter: {} , chi= {:.6g} , Lambda= {:.6g}\n", k++, 2.0 * it.cost, it.lambda);
  }
  app::Print("solved in {:.6g} ms, of which {:.6g} ms for the normal equations\n",
             1e3 * summary.time.total_s,
             1e3 * (summary.time.linearize_s + summary.time.eliminate_s));
  app::Print("{}: sum of Chi2 {:.6g}\n", ToString(summary.termination), problem.Chi2().value());
  if (!o.verbose) return;
  app::Print("\n{}\n", IterationTableHeader());
  for (const IterationSummary& it : summary.iterations)
    app::Print("{}\n", ToString(it));
}

void PrintResult(const CourseScene& scene, const Problem& problem, const CourseHandles& handles) {
  app::Print("\nInverse depths of the points (1/m): truth, start, solution\n");
  for (std::size_t k = 0; k < scene.points.size(); ++k) {
    app::Print("point {} : gt {:.6g} , noise {:.6g} , opt {:.6g}\n", k,
               scene.TrueInverseDepth(scene.points[k]), scene.points[k].rho_init,
               problem.Get(handles.points[k]).rho);
  }
  app::Print("\nTranslations of the poses (m): solution, truth\n");
  for (std::size_t k = 0; k < scene.poses.size(); ++k) {
    const double* t = problem.Get(handles.poses[k]).Data();
    const double* gt = scene.poses[k].data;
    app::Print("translation {} : {:.6g} {:.6g} {:.6g} , gt {:.6g} {:.6g} {:.6g}\n", k, t[0], t[1],
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
                              const MarginalizeExample& example, const Options& o) {
  nlohmann::ordered_json json = app::JsonHeader(kName, o.scene);
  json["iterations"] = nlohmann::json::array();
  int k = 0;
  for (const IterationSummary& it : summary.iterations) {
    if (!it.accepted) continue;
    json["iterations"].push_back({{"iter", k++}, {"cost", it.cost}, {"lambda", it.lambda}});
  }
  json["final_cost"] = summary.final_cost;
  json["status"] = ToString(summary.termination);
  json["points"] = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.points.size(); ++i) {
    json["points"].push_back({{"gt_per_m", scene.TrueInverseDepth(scene.points[i])},
                              {"noise_per_m", scene.points[i].rho_init},
                              {"opt_per_m", problem.Get(handles.points[i]).rho}});
  }
  json["poses"] = nlohmann::json::array();
  for (std::size_t i = 0; i < scene.poses.size(); ++i) {
    const double* t = problem.Get(handles.poses[i]).Data();
    const double* gt = scene.poses[i].data;
    json["poses"].push_back({{"t_m", {t[0], t[1], t[2]}}, {"gt_m", {gt[0], gt[1], gt[2]}}});
  }
  json["marginalize"] = {{"before", RowsOf(example.before)},
                         {"moved", RowsOf(example.moved)},
                         {"after", RowsOf(example.after)}};
  return json;
}

app::Outcome Run(const Options& o) {
  const auto scene = app::LoadScene(o.scene);
  if (!scene.ok()) return app::BadInput(scene.status());
  if (o.fix > static_cast<int>(scene->poses.size())) {
    return app::BadInput(
        fmt::format("--fix: must be an integer from 0 to {}, not {}", scene->poses.size(), o.fix));
  }
  Problem problem;
  const auto handles =
      AddToGraph(*scene, problem, {.fix_poses = o.fix, .prior_weight = o.prior_weight});
  if (!handles.ok()) return app::BadInput(handles.status());
  const SolveSummary& summary = problem.Solve(o.solver.Chosen());
  if (!summary.ok()) return app::BadInput(summary.status);

  const MarginalizeExample example = TestMarginalize();
  PrintSolve(problem, *handles, summary, o);
  PrintResult(*scene, problem, *handles);
  PrintMatrix("Marginalization: information of a chain of three variables", example.before);
  PrintMatrix("... with variable 2 moved last", example.moved);
  PrintMatrix("... after marginalizing it: variables 1 and 3 are linked", example.after);
  if (!o.json.empty()) {
    const auto json = ToJson(*scene, problem, *handles, summary, example, o);
    if (Status s = app::WriteJson(o.json, json, 2); !s.ok()) return app::Failed(s);
  }
  return {};
}

}  // namespace

int main(int argc, char** argv) {
  return app::Program(kName, kDescription, kFooter).Main<Options>(argc, argv, AddOptions, Run);
}
