// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/thread_pool.h"

#include <gtest/gtest.h>

#include <atomic>
#include <chrono>
#include <mutex>
#include <set>
#include <thread>
#include <vector>

namespace glissade {
namespace {

/// Every chunk exactly once? Plain ints: ThreadSanitizer sees it if two threads share a chunk, or
/// if Run returns before a chunk is done.
void ExpectEachChunkOnce(ThreadPool* pool, int num_chunks) {
  std::vector<int> runs(static_cast<std::size_t>(num_chunks), 0);
  pool->Run(num_chunks, [&](int chunk) { ++runs[static_cast<std::size_t>(chunk)]; });
  for (int chunk = 0; chunk < num_chunks; ++chunk) {
    ASSERT_EQ(runs[static_cast<std::size_t>(chunk)], 1) << "chunk " << chunk;
  }
}

TEST(ThreadPool, RunsEachChunkOnceForAnyNumberOfThreadsAndChunks) {
  for (const int threads : {1, 2, 3, 4, 7}) {
    ThreadPool pool(threads);
    EXPECT_EQ(pool.num_threads(), threads);
    for (int chunks = 0; chunks <= 20; ++chunks) {
      ASSERT_NO_FATAL_FAILURE(ExpectEachChunkOnce(&pool, chunks));
    }
  }
}

TEST(ThreadPool, ManyShortRoundsOneAfterTheOther) {
  // No pause between rounds: a worker that is late for one would take chunks of the next.
  ThreadPool pool(4);
  long sum = 0;
  std::vector<long> part(6);
  constexpr int kRounds = 4000;
  for (int round = 0; round < kRounds; ++round) {
    pool.Run(6, [&](int chunk) { part[static_cast<std::size_t>(chunk)] = round + chunk; });
    for (const long p : part)
      sum += p;
  }
  EXPECT_EQ(sum, 6L * kRounds * (kRounds - 1) / 2 + 15L * kRounds);
}

TEST(ThreadPool, WorkersThatWentToSleepWakeUp) {
  ThreadPool pool(3);
  for (int round = 0; round < 5; ++round) {
    std::this_thread::sleep_for(std::chrono::milliseconds(30));  // much more than they spin
    ASSERT_NO_FATAL_FAILURE(ExpectEachChunkOnce(&pool, 5));
  }
}

TEST(ThreadPool, UsesItsThreads) {
  // Each of the three chunks waits until all have begun: only three threads can get through.
  ThreadPool pool(3);
  std::atomic<int> begun{0};
  std::mutex mutex;
  std::set<std::thread::id> ids;
  pool.Run(3, [&](int) {
    {
      const std::lock_guard<std::mutex> lock(mutex);
      ids.insert(std::this_thread::get_id());
    }
    ++begun;
    while (begun.load() < 3)
      std::this_thread::yield();
  });
  EXPECT_EQ(ids.size(), 3u);
  EXPECT_TRUE(ids.count(std::this_thread::get_id())) << "the caller works too";
}

TEST(ThreadPool, OneThreadWorksInTheCallerAndInOrder) {
  ThreadPool pool(1);
  std::vector<int> order;
  const auto caller = std::this_thread::get_id();
  pool.Run(5, [&](int chunk) {
    EXPECT_EQ(std::this_thread::get_id(), caller);
    order.push_back(chunk);
  });
  EXPECT_EQ(order, (std::vector<int>{0, 1, 2, 3, 4}));
}

TEST(ThreadPool, ResizesUpAndDownBetweenRounds) {
  ThreadPool pool;
  EXPECT_EQ(pool.num_threads(), 1);
  for (int round = 0; round < 20; ++round) {
    for (const int threads : {2, 5, 5, 1, 3}) {
      pool.Resize(threads);
      ASSERT_EQ(pool.num_threads(), threads);
      ASSERT_NO_FATAL_FAILURE(ExpectEachChunkOnce(&pool, 8));
    }
  }
}

TEST(ThreadPool, FewerThanOneThreadIsOne) {
  ThreadPool pool(0);
  EXPECT_EQ(pool.num_threads(), 1);
  pool.Resize(-3);
  EXPECT_EQ(pool.num_threads(), 1);
  ExpectEachChunkOnce(&pool, 4);
}

TEST(ThreadPool, StopsWithoutEverHavingRun) {
  for (int k = 0; k < 50; ++k) {
    const ThreadPool pool(4);
    EXPECT_EQ(pool.num_threads(), 4);
  }
}

TEST(ThreadPool, PoolsAreIndependent) {
  ThreadPool a(2), b(3);
  std::atomic<int> inner{0};
  std::thread other([&] {
    for (int round = 0; round < 500; ++round)
      b.Run(6, [&](int) { ++inner; });
  });
  std::atomic<int> outer{0};
  for (int round = 0; round < 500; ++round)
    a.Run(4, [&](int) { ++outer; });
  other.join();
  EXPECT_EQ(inner.load(), 3000);
  EXPECT_EQ(outer.load(), 2000);
}

// An exception in a worker ended the process.
TEST(ThreadPool, TheExceptionOfTheLowestChunkComesOut) {
  for (const int threads : {1, 2, 4}) {
    ThreadPool pool(threads);
    for (int round = 0; round < 200; ++round) {
      std::atomic<int> ran{0};
      try {
        pool.Run(20, [&](int chunk) {
          ++ran;
          if (chunk == 5 + round % 3) std::this_thread::yield();
          if (chunk >= 5 + round % 3 && chunk % 2 == 1) throw chunk;
        });
        ADD_FAILURE() << "nothing came out";
      } catch (const int chunk) {
        EXPECT_EQ(chunk, round % 3 == 0 ? 5 : 7);
      }
      EXPECT_GE(ran.load(), 6) << "all before it run";
      ASSERT_NO_FATAL_FAILURE(ExpectEachChunkOnce(&pool, 20)) << "and the pool can be used on";
    }
  }
}

}  // namespace
}  // namespace glissade
