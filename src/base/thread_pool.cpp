// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/thread_pool.h"

#include <atomic>
#include <condition_variable>
#include <exception>
#include <limits>
#include <mutex>
#include <thread>
#include <utility>
#include <vector>

namespace glissade {

namespace {
// An iteration of a window takes about 90 microseconds in several short parallel parts: a worker
// that went to sleep between them would spend longer waking up than working.
constexpr int kSpins = 4000;

inline void Pause() {
#if defined(__x86_64__) || defined(__i386__)
  __builtin_ia32_pause();
#endif
}
}  // namespace

struct ThreadPool::Shared {
  std::mutex mutex;
  std::condition_variable wake;
  std::vector<std::thread> threads;
  std::atomic<unsigned> round{0};  // a new value: there is work
  std::atomic<int> next{0};        // next chunk to take
  std::atomic<int> busy{0};        // workers that have not finished this round
  std::atomic<bool> stop{false};
  int num_chunks = 0;
  void (*call)(void*, int) = nullptr;
  void* f = nullptr;
  std::exception_ptr exception;  // of failed_chunk; both under the mutex
  int failed_chunk = std::numeric_limits<int>::max();

  // Chunks are taken in rising order. Whoever throws ends the taking; all lower chunks have been
  // taken by then and run to their end, so that the lowest that throws is always found.
  void TakeChunks() noexcept {
    for (int chunk = next.fetch_add(1); chunk < num_chunks; chunk = next.fetch_add(1)) {
      try {
        call(f, chunk);
      } catch (...) {
        next.store(num_chunks);
        const std::lock_guard<std::mutex> lock(mutex);
        if (chunk < failed_chunk) {
          failed_chunk = chunk;
          exception = std::current_exception();
        }
        return;
      }
    }
  }
};

ThreadPool::ThreadPool(int num_threads) {
  Resize(num_threads);
}

ThreadPool::~ThreadPool() {
  Resize(1);
}

void ThreadPool::Resize(int num_threads) noexcept {
  num_threads = num_threads < 1 ? 1 : num_threads;
  if (num_threads == wanted_) return;
  if (shared_ != nullptr) {
    {
      const std::lock_guard<std::mutex> lock(shared_->mutex);
      shared_->stop = true;
    }
    shared_->wake.notify_all();
    for (std::thread& thread : shared_->threads)
      thread.join();
    shared_.reset();
  }
  wanted_ = num_threads;
  num_threads_ = 1;
  if (num_threads == 1) return;
  try {
    shared_ = std::make_unique<Shared>();
    shared_->threads.reserve(static_cast<std::size_t>(num_threads - 1));
    for (; num_threads_ < num_threads; ++num_threads_) {
      shared_->threads.emplace_back([shared = shared_.get()] { Work(shared); });
    }
  } catch (const std::exception&) {
    // Refused (std::system_error) or out of memory: go on with those that were started.
  }
}

void ThreadPool::Work(Shared* shared) {
  unsigned seen = 0;
  for (;;) {
    int spins = 0;
    while (shared->round.load(std::memory_order_acquire) == seen &&
           !shared->stop.load(std::memory_order_relaxed) && spins < kSpins) {
      Pause();
      ++spins;
    }
    if (shared->round.load(std::memory_order_acquire) == seen) {
      std::unique_lock<std::mutex> lock(shared->mutex);
      shared->wake.wait(lock, [&] { return shared->stop || shared->round != seen; });
    }
    if (shared->stop) return;
    seen = shared->round.load(std::memory_order_acquire);
    shared->TakeChunks();
    shared->busy.fetch_sub(1, std::memory_order_release);
  }
}

void ThreadPool::RunOnThreads(int num_chunks, void (*call)(void*, int), void* f) {
  Shared& shared = *shared_;
  shared.num_chunks = num_chunks;
  shared.call = call;
  shared.f = f;
  shared.next.store(0);
  shared.busy.store(num_threads_ - 1);
  {
    // The lock pairs with the worker's check before it sleeps: no wake-up can be lost.
    const std::lock_guard<std::mutex> lock(shared.mutex);
    shared.round.fetch_add(1, std::memory_order_release);
  }
  shared.wake.notify_all();
  shared.TakeChunks();
  for (int spins = 0; shared.busy.load(std::memory_order_acquire) != 0; ++spins) {
    // Yield once it takes long: with fewer cores than threads the others need this one.
    spins < kSpins ? Pause() : std::this_thread::yield();
  }
  if (shared.exception == nullptr) return;
  shared.failed_chunk = std::numeric_limits<int>::max();
  std::rethrow_exception(std::exchange(shared.exception, nullptr));
}

}  // namespace glissade
