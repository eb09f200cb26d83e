// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/run.h"

#include <cstring>
#include <ctime>
#include <sstream>

namespace glissade::bench {

namespace {

/// Most memory that the process has had, MB; as getrusage's ru_maxrss, but without what a process
/// has inherited from the one that it was forked from.
double PeakMemoryMb() {
  std::FILE* const status = std::fopen("/proc/self/status", "r");
  double kib = NAN;
  if (status == nullptr) return kib;
  char line[256];
  while (std::fgets(line, sizeof line, status) != nullptr) {
    if (std::strncmp(line, "VmHWM:", 6) == 0) std::sscanf(line + 6, "%lf", &kib);
  }
  std::fclose(status);
  return kib / 1024.0;
}

std::string OneLine(std::string_view text) {
  std::string line(text);
  for (char& c : line) {
    if (c == '\n') c = ' ';
  }
  return line;
}

}  // namespace

std::vector<double> Run::StepSeconds() const {
  std::vector<double> seconds;
  for (std::size_t k = 2; k < steps.size(); ++k) {
    if (steps[k].accepted) seconds.push_back(steps[k].seconds - steps[k - 1].seconds);
  }
  return seconds;
}

double Run::SecondsTo(double wanted) const {
  for (const bench::Step& step : steps) {
    if (step.accepted && step.cost <= wanted) return step.seconds;
  }
  return NAN;
}

int Run::CgIterations() const {
  int sum = 0;
  for (const bench::Step& step : steps)
    sum += step.cg;
  return sum;
}

double Recorder::Now() const {
  timespec t{};
  clock_gettime(cpu_clock_ ? CLOCK_PROCESS_CPUTIME_ID : CLOCK_MONOTONIC, &t);
  return static_cast<double>(t.tv_sec) + 1e-9 * static_cast<double>(t.tv_nsec);
}

void Recorder::SolveBegins() {
  const double now = Now();
  std::fprintf(to_, "setup %.9g\n", now - start_);
  std::fflush(to_);
  start_ = Now();
}

void Recorder::Step(double cost, bool accepted, int cg) {
  std::fprintf(to_, "step %.9g %.17g %d %d\n", Now() - start_, cost, accepted ? 1 : 0, cg);
  std::fflush(to_);
}

void Recorder::SolveEnds(double cost, std::string_view chosen) {
  std::fprintf(to_, "end %.9g %.17g %.9g\nchosen %s\n", Now() - start_, cost, PeakMemoryMb(),
               OneLine(chosen).c_str());
  std::fflush(to_);
}

void Recorder::Audited(double cost) {
  std::fprintf(to_, "audited %.17g\n", cost);
  std::fflush(to_);
}

void Recorder::Fails(std::string_view why) {
  std::fprintf(to_, "fails %s\n", OneLine(why).c_str());
  std::fflush(to_);
}

void ReadLine(const std::string& line, Run* run) {
  std::istringstream in(line);
  std::string what;
  in >> what >> std::ws;
  if (what == "setup") {
    in >> run->setup_s;
  } else if (what == "step") {
    Step step;
    if (in >> step.seconds >> step.cost >> step.accepted >> step.cg) run->steps.push_back(step);
  } else if (what == "end") {
    in >> run->solve_s >> run->cost >> run->peak_mb;
  } else if (what == "chosen") {
    std::getline(in, run->chosen);
  } else if (what == "audited") {
    in >> run->audited;
  } else if (what == "fails") {
    std::getline(in, run->end);
  }
}

}  // namespace glissade::bench
