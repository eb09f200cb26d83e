// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <nanobind/nanobind.h>

#include <atomic>
#include <thread>
#include <utility>

#include "glissade/problem/problem.h"
#include "unlocked.h"

namespace glissade::python {

namespace nb = nanobind;

/// The Problem of Python: one that other threads cannot touch while it is worked on without the
/// interpreter's lock.
class PyProblem {
 public:
  PyProblem() = default;
  explicit PyProblem(Problem problem) : problem_(std::move(problem)) {}

  /// For what changes nothing. Refused (RuntimeError) while another thread works on the problem; in
  /// a callback of a solve it is the thread that does.
  Problem& read();
  /// For what changes something. Refused while anything works on the problem.
  Problem& write();

  /// Works on the problem without the interpreter's lock.
  template <class F>
  auto Work(F&& f) {
    Problem& problem = write();
    const Busy busy(this);
    const Unlocked unlocked;
    return f(problem);
  }
  /// Asks for what edges say, which may be written in Python: while they are asked the problem
  /// cannot be changed, nor used by another thread. With the interpreter's lock.
  template <class F>
  auto Ask(F&& f) {
    if (busy_) return f(read());  // in a callback, or an edge
    const Busy busy(this);
    return f(problem_);
  }

  /// For a call that was refused: Python has its exception, a later solve need not repeat it.
  void Seen(const Status& status);
  template <class T>
  T Seen(Result<T> result) {
    Seen(result.status());
    return std::move(result).value();
  }

 private:
  struct Busy {
    explicit Busy(PyProblem* p) : problem(p) {
      problem->worker_ = std::this_thread::get_id();
      problem->busy_ = true;
    }
    ~Busy() { problem->busy_ = false; }
    Busy(const Busy&) = delete;
    Busy& operator=(const Busy&) = delete;
    PyProblem* problem;
  };

  Problem problem_;
  // Both are read and written with the interpreter's lock, but for the end of work.
  std::atomic<bool> busy_ = false;
  std::thread::id worker_;
};

/// What a callback returns: nothing or True to go on, False to stop.
bool SaysStop(nb::handle answer);

void BindProblem(nb::module_& m);
void BindVertices(nb::class_<PyProblem>& problem);
void BindEdges(nb::class_<PyProblem>& problem);
void BindEdgeKinds(nb::module_& m, nb::class_<PyProblem>& problem);
/// Before all that has a loss or options for an argument; after gauges.
void BindSolveOptions(nb::module_& m);
void BindSolve(nb::module_& m, nb::class_<PyProblem>& problem);
void BindGauge(nb::module_& m);
void BindStudy(nb::module_& m, nb::class_<PyProblem>& problem);
void BindMarginal(nb::module_& m, nb::class_<PyProblem>& problem);
void BindFiles(nb::module_& m, nb::class_<PyProblem>& problem);
void BindImu(nb::module_& m);
void BindImuEdges(nb::class_<PyProblem>& problem);
void BindTrajectories(nb::module_& m);
void BindWindow(nb::module_& m);

}  // namespace glissade::python
