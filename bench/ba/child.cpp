// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "ba/child.h"

#include <poll.h>
#include <signal.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cerrno>
#include <chrono>
#include <cstring>
#include <exception>
#include <new>

namespace glissade::bench {

namespace {

constexpr int kOutOfMemory = 99;  // exit codes of the child
constexpr int kException = 98;

[[noreturn]] void Work(const std::function<void(std::FILE*)>& work, const ChildLimits& limits,
                       int pipe) {
  if (limits.memory_mb > 0.0) {
    const auto bytes = static_cast<rlim_t>(limits.memory_mb * 1048576.0);
    const rlimit limit{bytes, bytes};
    setrlimit(RLIMIT_AS, &limit);
  }
  std::FILE* const out = fdopen(pipe, "w");
  if (out == nullptr) _exit(kException);
  try {
    work(out);
  } catch (const std::bad_alloc&) {
    _exit(kOutOfMemory);
  } catch (const std::exception& e) {
    std::fprintf(stderr, "bench_ba: %s\n", e.what());
    _exit(kException);
  }
  std::fclose(out);
  _exit(0);  // the parent's atexit functions and buffers are not ours
}

/// Hands on the whole lines of `text`, keeps what is left.
void HandOver(std::string* text, const std::function<void(const std::string&)>& on_line) {
  std::size_t begin = 0;
  for (std::size_t end; (end = text->find('\n', begin)) != std::string::npos; begin = end + 1) {
    on_line(text->substr(begin, end - begin));
  }
  text->erase(0, begin);
}

/// Reads until the child closes its end; false where the time is over before.
bool ReadAll(int pipe, double seconds, const std::function<void(const std::string&)>& on_line) {
  using Clock = std::chrono::steady_clock;
  const Clock::time_point start = Clock::now();
  std::string text;
  for (;;) {
    int wait_ms = -1;
    if (seconds > 0.0) {
      const double left = seconds - std::chrono::duration<double>(Clock::now() - start).count();
      if (left <= 0.0) return false;
      wait_ms = static_cast<int>(1e3 * (left < 1e6 ? left : 1e6)) + 1;
    }
    pollfd ready{pipe, POLLIN, 0};
    const int polled = poll(&ready, 1, wait_ms);
    if (polled < 0 && errno != EINTR) return true;
    if (polled <= 0) continue;
    char buffer[4096];
    const ssize_t n = read(pipe, buffer, sizeof buffer);
    if (n < 0 && errno == EINTR) continue;
    if (n <= 0) return true;
    text.append(buffer, static_cast<std::size_t>(n));
    HandOver(&text, on_line);
  }
}

std::string HowItEnded(int status) {
  if (WIFSIGNALED(status)) {
    const int signal = WTERMSIG(status);
    // The kernel kills with 9 what it has no memory for.
    return std::string("signal ")
        .append(std::to_string(signal))
        .append(" (")
        .append(strsignal(signal))
        .append(")");
  }
  const int code = WEXITSTATUS(status);
  if (code == 0) return "done";
  if (code == kOutOfMemory) return "out of memory";
  return std::string("exit code ").append(std::to_string(code));
}

}  // namespace

std::string RunInChild(const std::function<void(std::FILE*)>& work, const ChildLimits& limits,
                       const std::function<void(const std::string&)>& on_line) {
  int ends[2];
  if (pipe(ends) != 0) return std::string("no pipe: ").append(std::strerror(errno));
  std::fflush(nullptr);
  const pid_t child = fork();
  if (child < 0) {
    close(ends[0]);
    close(ends[1]);
    return std::string("no process: ").append(std::strerror(errno));
  }
  if (child == 0) {
    close(ends[0]);
    Work(work, limits, ends[1]);
  }
  close(ends[1]);
  const bool in_time = ReadAll(ends[0], limits.seconds, on_line);
  close(ends[0]);
  if (!in_time) kill(child, SIGKILL);
  int status = 0;
  while (waitpid(child, &status, 0) < 0 && errno == EINTR) {
  }
  return in_time ? HowItEnded(status) : "time limit";
}

}  // namespace glissade::bench
