// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <memory>
#include <utility>

namespace glissade {

/// Runs a fixed list of chunks on a few threads. Which thread runs a chunk is left to chance; what
/// a chunk does must not depend on it. Owned by one solver, used by one caller at a time.
class ThreadPool {
 public:
  explicit ThreadPool(int num_threads = 1);
  ~ThreadPool();
  ThreadPool(const ThreadPool&) = delete;
  ThreadPool& operator=(const ThreadPool&) = delete;

  /// Starts or stops threads so that num_threads (the caller included) share the work. Where the
  /// system refuses a thread, those there are do it, and num_threads() tells how many; the next
  /// attempt is made when another number is asked for.
  void Resize(int num_threads) noexcept;
  /// Threads that share the work, the caller included.
  [[nodiscard]] int num_threads() const { return num_threads_; }

  /// Calls f(chunk) for each chunk in [0, num_chunks); returns when all are done. Where f throws,
  /// chunks that nobody has taken yet are left out, and once all threads are done the exception of
  /// the lowest chunk that threw comes out here: the same one for any number of threads.
  template <class F>
  void Run(int num_chunks, F&& f) {
    if (num_threads_ == 1 || num_chunks == 1) {
      for (int chunk = 0; chunk < num_chunks; ++chunk)
        f(chunk);
      return;
    }
    RunOnThreads(
        num_chunks, [](void* self, int chunk) { (*static_cast<F*>(self))(chunk); }, &f);
  }

 private:
  struct Shared;
  void RunOnThreads(int num_chunks, void (*call)(void*, int), void* f);
  static void Work(Shared* shared);

  int num_threads_ = 1;
  int wanted_ = 1;
  std::unique_ptr<Shared> shared_;
};

}  // namespace glissade
