// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include <nanobind/stl/optional.h>
#include <nanobind/stl/string.h>
#include <nanobind/stl/vector.h>

#include <cstdint>
#include <optional>
#include <string>

#include "arrays.h"
#include "errors.h"
#include "glissade/losses/cauchy.h"
#include "glissade/losses/huber.h"
#include "glissade/losses/tukey.h"
#include "handles.h"
#include "problem.h"

namespace glissade::python {

namespace {

void BindOptions(nb::module_& m) {
  nb::enum_<Method>(m, "Method", "How a step is found.")
      .value("LEVENBERG_MARQUARDT", Method::kLevenbergMarquardt)
      .value("DOGLEG", Method::kDogleg);
  nb::enum_<Damping>(m, "Damping", "What lambda multiplies in (H + lambda D) dx = b.")
      .value("DIAGONAL", Damping::kDiagonal)
      .value("IDENTITY", Damping::kIdentity)
      .value("POSE_BLOCK", Damping::kPoseBlock);
  nb::enum_<LinearSolverType>(m, "LinearSolver", "How the reduced system is solved.")
      .value("AUTO", LinearSolverType::kAuto, "whichever has least to do")
      .value("DENSE_CHOLESKY", LinearSolverType::kDenseCholesky)
      .value("SPARSE_CHOLESKY", LinearSolverType::kSparseCholesky)
      .value("PCG", LinearSolverType::kPcg, "conjugate gradients on its blocks")
      .value("IMPLICIT_PCG", LinearSolverType::kImplicitPcg, "without forming it");
  nb::enum_<Preconditioner>(m, "Preconditioner", "Of conjugate gradients.")
      .value("JACOBI", Preconditioner::kJacobi)
      .value("BLOCK_JACOBI", Preconditioner::kBlockJacobi)
      .value("CLUSTER_JACOBI", Preconditioner::kClusterJacobi)
      .value("POWER_SERIES", Preconditioner::kPowerSeries);
  nb::enum_<FirstEstimates>(m, "FirstEstimates",
                            "Where vertices under a marginal prior are linearized.")
      .value("OFF", FirstEstimates::kOff)
      .value("PRIOR_ONLY", FirstEstimates::kPriorOnly)
      .value("FULL", FirstEstimates::kFull);

  nb::class_<Loss>(m, "Loss", "A robust loss rho(s) of the squared whitened residual s.")
      .def(nb::init<>(), "rho(s) = s.")
      .def(
          "__call__",
          [](const Loss& loss, double s) {
            double rho[3];
            loss.Evaluate(s, rho);
            return rho[0];
          },
          nb::arg("s"), "rho(s).")
      .def("__repr__", [](const Loss& loss) {
        return loss.trivial() ? std::string("Loss()")
                              : std::string(loss.type()->name).append("(...)");
      });
  const auto checked = [](const Loss& loss) {
    Check(loss.Validate());
    return loss;
  };
  m.def(
      "Huber", [checked](double width) { return checked(Huber{width}); }, nb::arg("width") = 1.0,
      "Huber's loss; width in sigmas.");
  m.def(
      "Cauchy", [checked](double width) { return checked(Cauchy{width}); }, nb::arg("width") = 1.0,
      "Cauchy's loss; width in sigmas.");
  m.def(
      "Tukey", [checked](double width) { return checked(Tukey{width}); }, nb::arg("width") = 4.685,
      "Tukey's biweight; width in sigmas.");

  nb::class_<PcgOptions>(m, "PcgOptions", "Of the conjugate gradient solvers.")
      .def(nb::init<>())
      .def_rw("preconditioner", &PcgOptions::preconditioner)
      .def_rw("tolerance", &PcgOptions::tolerance, "stop at |r| <= tolerance |b|")
      .def_rw("forcing", &PcgOptions::forcing, "inexact Newton steps; 0: tolerance alone")
      .def_rw("max_iterations", &PcgOptions::max_iterations, "0: 2 n");
  nb::class_<SolveOptions>(m, "SolveOptions",
                           "Options of Problem.solve(), which takes each of them as an argument, "
                           "too. A tolerance of 0 switches its rule off.")
      .def(nb::init<>())
      .def_rw("max_iterations", &SolveOptions::max_iterations,
              "linear solves, rejected steps included")
      .def_rw("max_time_s", &SolveOptions::max_time_s)
      .def_rw("cost_tolerance", &SolveOptions::cost_tolerance,
              "|cost decrease| <= tolerance * cost")
      .def_rw("gradient_tolerance", &SolveOptions::gradient_tolerance,
              "max |g_i| / sqrt(H_ii) <= tolerance * the same at the start")
      .def_rw("step_tolerance", &SolveOptions::step_tolerance,
              "relative to the residuals: see C++ SolveOptions")
      .def_rw("course_stop", &SolveOptions::course_stop)
      .def_rw("method", &SolveOptions::method)
      .def_rw("min_relative_decrease", &SolveOptions::min_relative_decrease)
      .def_rw("damping", &SolveOptions::damping)
      .def_rw("initial_lambda", &SolveOptions::initial_lambda)
      .def_rw("min_lambda", &SolveOptions::min_lambda)
      .def_rw("max_lambda", &SolveOptions::max_lambda)
      .def_rw("min_diagonal", &SolveOptions::min_diagonal)
      .def_rw("max_diagonal", &SolveOptions::max_diagonal)
      .def_rw("initial_radius", &SolveOptions::initial_radius)
      .def_rw("linear_solver", &SolveOptions::linear_solver_type)
      .def_rw("pcg", &SolveOptions::pcg)
      .def_rw("memory_limit", &SolveOptions::memory_limit, "bytes; 0: none")
      .def_rw("num_threads", &SolveOptions::num_threads, "does not change a bit of the result")
      .def_rw("gauge", &SolveOptions::gauge)
      .def_rw("allow_duplicate_observations", &SolveOptions::allow_duplicate_observations)
      .def_rw("verbose", &SolveOptions::verbose, "a line per iteration to stderr")
      .def(
          "__eq__", [](nb::handle self, nb::handle other) { return self.is(other); },
          nb::sig("def __eq__(self, other: object, /) -> bool"));
}

/// How a summary shows itself is written in Python.
nb::object InPython(const char* function, nb::handle self) {
  return nb::module_::import_("glissade._summary").attr(function)(self);
}

void BindSummary(nb::module_& m) {
  nb::enum_<Termination>(m, "Termination", "Why a solve ended.")
      .value("CONVERGED_COST", Termination::kConvergedCost)
      .value("CONVERGED_GRADIENT", Termination::kConvergedGradient)
      .value("CONVERGED_STEP", Termination::kConvergedStep)
      .value("CONVERGED_FIRST_ESTIMATES", Termination::kConvergedFirstEstimates)
      .value("MAX_ITERATIONS", Termination::kMaxIterations)
      .value("MAX_TIME", Termination::kMaxTime)
      .value("CANCELLED", Termination::kCancelled)
      .value("NO_PROGRESS", Termination::kNoProgress)
      .value("FAILED", Termination::kFailed);
  nb::class_<IterationSummary>(m, "IterationSummary", "One linear solve; iteration 0 is the start.")
      .def_ro("iteration", &IterationSummary::iteration)
      .def_ro("accepted", &IterationSummary::accepted)
      .def_ro("cost", &IterationSummary::cost)
      .def_ro("cost_change", &IterationSummary::cost_change)
      .def_ro("gradient_max", &IterationSummary::gradient_max)
      .def_ro("step_norm", &IterationSummary::step_norm)
      .def_ro("gain_ratio", &IterationSummary::gain_ratio)
      .def_ro("damping", &IterationSummary::lambda, "lambda, to be used next")
      .def_ro("linear_iterations", &IterationSummary::linear_iterations)
      .def_ro("time_s", &IterationSummary::time_s)
      .def_ro("total_time_s", &IterationSummary::total_time_s)
      .def("__repr__", [](const IterationSummary& it) { return ToString(it); });
  nb::class_<SolveSummary>(m, "SolveSummary", "What a solve did. print() shows the iterations.")
      .def_ro("termination", &SolveSummary::termination)
      .def_prop_ro("converged", &SolveSummary::converged)
      .def_ro("initial_cost", &SolveSummary::initial_cost)
      .def_ro("final_cost", &SolveSummary::final_cost)
      .def_ro("accepted_steps", &SolveSummary::accepted_steps)
      .def_ro("rejected_steps", &SolveSummary::rejected_steps)
      .def_ro("num_poses", &SolveSummary::num_poses, "free vertices in the reduced system")
      .def_ro("num_landmarks", &SolveSummary::num_landmarks, "free eliminated vertices")
      .def_ro("num_edges", &SolveSummary::num_edges)
      .def_ro("num_threads", &SolveSummary::num_threads)
      .def_ro("iterations", &SolveSummary::iterations)
      .def_prop_ro("linear_solver",
                   [](const SolveSummary& s) { return std::string(s.reduced.name); })
      .def_prop_ro("linear_solver_reason",
                   [](const SolveSummary& s) { return std::string(s.reduced.reason); })
      .def_prop_ro(
          "times",
          [](const SolveSummary& s) {
            nb::dict d;
            d["analyze_s"] = s.time.analyze_s;
            d["linearize_s"] = s.time.linearize_s;
            d["eliminate_s"] = s.time.eliminate_s;
            d["solve_s"] = s.time.solve_s;
            d["cost_s"] = s.time.cost_s;
            d["total_s"] = s.time.total_s;
            return d;
          },
          nb::sig("def times(self) -> dict[str, float]"), "Seconds by what was done.")
      .def("brief_report", &SolveSummary::BriefReport, "One line.")
      .def(
          "table",
          [](const SolveSummary& s) {
            std::string text = IterationTableHeader();
            for (const IterationSummary& it : s.iterations)
              text.append("\n").append(ToString(it));
            return text;
          },
          "A line for each iteration.")
      .def(
          "to_dict", [](nb::handle self) { return InPython("to_dict", self); },
          nb::sig("def to_dict(self) -> dict[str, typing.Any]"),
          "All of it as plain numbers, texts and lists.")
      .def(
          "__str__", [](nb::handle self) { return InPython("text", self); },
          nb::sig("def __str__(self) -> str"))
      .def("__repr__",
           [](const SolveSummary& s) {
             return std::string("<SolveSummary: ").append(s.BriefReport()).append(">");
           })
      .def(
          "_repr_html_", [](nb::handle self) { return InPython("as_html", self); },
          nb::sig("def _repr_html_(self) -> str"));
}

}  // namespace

bool SaysStop(nb::handle answer) {
  if (answer.is_none()) return false;
  const int truth = PyObject_IsTrue(answer.ptr());
  if (truth < 0) throw nb::python_error();
  return truth == 0;
}

namespace {

/// Calls back into Python from a solve: signals, progress, the user's function.
class Caller {
 public:
  Caller(nb::object user, std::optional<bool> progress) : user_(std::move(user)) {
    if (progress == false) return;
    progress_ = nb::module_::import_("glissade._progress").attr("make")(progress.has_value());
  }

  /// With the interpreter's lock not held.
  CallbackAction operator()(const IterationSummary& it) {
    if (InterpreterEnds()) return CallbackAction::kStop;
    // A short solve does not ask for the lock: whoever waits for it may hold it for long.
    constexpr double kSignalsAfter = 0.05;
    const bool waits = !user_.is_none() || it.total_time_s > kSignalsAfter;
    if (!waits) return CallbackAction::kContinue;
    const nb::gil_scoped_acquire acquire;
    if (PyErr_CheckSignals() != 0) throw nb::python_error();
    if (!progress_.is_none()) progress_.attr("update")(nb::cast(it));
    if (user_.is_none()) return CallbackAction::kContinue;
    return SaysStop(user_(nb::cast(it))) ? CallbackAction::kStop : CallbackAction::kContinue;
  }
  void Close() {
    if (!progress_.is_none()) progress_.attr("close")();
  }

 private:
  nb::object user_;
  nb::object progress_ = nb::none();
};

SolveSummary Solve(PyProblem& p, const std::optional<SolveOptions>& given,
                   std::optional<bool> progress, nb::object callback, const nb::kwargs& changes) {
  nb::object options = nb::cast(given ? *given : SolveOptions());
  for (const auto& [name, value] : changes) {
    const auto text = nb::cast<std::string>(name);
    if (text.starts_with("_") || !nb::hasattr(options, name)) {
      throw nb::type_error(std::string("solve() has no option '").append(text).append("'").c_str());
    }
    try {
      nb::setattr(options, name, value);
    } catch (nb::python_error& error) {
      if (!error.matches(PyExc_TypeError)) throw;
      const std::string text = std::string("solve(): option '")
                                   .append(nb::cast<std::string>(name))
                                   .append("' cannot be ")
                                   .append(nb::repr(value).c_str());
      throw nb::type_error(text.c_str());
    }
  }
  auto& chosen = nb::cast<SolveOptions&>(options);
  if (!callback.is_none() && !PyCallable_Check(callback.ptr())) {
    throw nb::type_error("callback must be callable");
  }
  Caller caller(std::move(callback), progress);
  chosen.callback = [&caller](const IterationSummary& it) { return caller(it); };
  SolveSummary summary;
  try {
    summary = p.Work([&](Problem& problem) { return problem.Solve(chosen); });
  } catch (...) {
    caller.Close();
    throw;
  }
  caller.Close();
  chosen.callback = nullptr;
  if (!summary.ok()) p.Seen(summary.status);
  return summary;
}

}  // namespace

void BindSolve(nb::module_& m, nb::class_<PyProblem>& problem) {
  BindSummary(m);
  problem
      .def("solve", &Solve, nb::arg("options") = nb::none(), nb::kw_only(),
           nb::arg("progress") = nb::none(), nb::arg("callback") = nb::none(), nb::arg("changes"),
           nb::sig("def solve(self, options: SolveOptions | None = None, *, progress: bool | None "
                   "= None, callback: collections.abc.Callable[[IterationSummary], bool | None] | "
                   "None = None, **changes: object) -> SolveSummary"),
           "Minimizes the cost from the present values and leaves the best ones found.\n\nchanges: "
           "options by name, as in SolveOptions: solve(max_iterations=5). progress: a line with "
           "cost and rate once the solve takes longer than a second (None: where stderr is a "
           "terminal, and in notebooks). callback: called after every iteration, may read the "
           "problem, stops the solve by returning False.\nCtrl-C stops with KeyboardInterrupt and "
           "the best values so far. A failed solve raises Error, with the values as they were.")
      .def(
          "estimate_memory",
          [](PyProblem& p, const std::optional<SolveOptions>& options) {
            const MemoryEstimate e =
                Unwrap(p.write().EstimateMemory(options ? *options : SolveOptions()));
            return e.total();
          },
          nb::arg("options") = nb::none(), "Bytes that graph and solve will take together.");
}

void BindSolveOptions(nb::module_& m) {
  BindOptions(m);
}

}  // namespace glissade::python
