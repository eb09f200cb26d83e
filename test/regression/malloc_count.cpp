// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "regression/malloc_count.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <limits>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

#include <malloc.h>

namespace {

constexpr std::int64_t kNever = std::numeric_limits<std::int64_t>::max();
std::atomic<std::int64_t> count{0};
std::atomic<std::int64_t> fail_from{kNever}, fail_to{kNever};

/// Counts an allocation; false: it is to fail.
bool Allow() {
  const std::int64_t number = count++;
  return number < fail_from.load(std::memory_order_relaxed) ||
         number >= fail_to.load(std::memory_order_relaxed);
}

std::atomic<std::int64_t> bytes{0}, peak{0};

/// Counts the bytes of a block.
void* Counted(void* block) {
  const auto size = static_cast<std::int64_t>(malloc_usable_size(block));
  const std::int64_t now = bytes += size;
  std::int64_t highest = peak.load();
  while (now > highest && !peak.compare_exchange_weak(highest, now)) {
  }
  return block;
}

}  // namespace

namespace glissade::test {

std::int64_t MallocCount() {
  return count.load();
}

FailingMalloc::FailingMalloc(std::int64_t number, bool on) : number_(count.load() + number) {
  fail_to = on ? kNever : number_ + 1;
  fail_from = number_;
}
FailingMalloc::~FailingMalloc() {
  fail_from = fail_to = kNever;
}
bool FailingMalloc::failed() const {
  return count.load() > number_;
}

std::int64_t HeapBytes() {
  return bytes.load();
}
std::int64_t PeakHeapBytes() {
  return peak.load();
}
void ResetPeakHeap() {
  peak = bytes.load();
}
}  // namespace glissade::test

// glibc's own functions under their second names: the blocks are glibc's.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t n, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);
void __libc_free(void* block);

void* malloc(std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  return Counted(__libc_malloc(size));
}
void* calloc(std::size_t n, std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  return Counted(__libc_calloc(n, size));
}
void* realloc(void* block, std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  const auto before = static_cast<std::int64_t>(malloc_usable_size(block));
  void* const moved = __libc_realloc(block, size);
  if (moved == nullptr && size > 0) return nullptr;  // the block stays
  bytes -= before;
  return Counted(moved);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  return Counted(__libc_memalign(alignment, size));
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  *block = Allow() ? Counted(__libc_memalign(alignment, size)) : nullptr;
  return *block != nullptr ? 0 : ENOMEM;
}
void free(void* block) noexcept {
  bytes -= static_cast<std::int64_t>(malloc_usable_size(block));
  __libc_free(block);
}
}

#else

namespace glissade::test {
std::int64_t MallocCount() {
  return -1;
}
FailingMalloc::FailingMalloc(std::int64_t number, bool) : number_(number) {}
FailingMalloc::~FailingMalloc() = default;
bool FailingMalloc::failed() const {
  return number_ < 0;
}
std::int64_t HeapBytes() {
  return -1;
}
std::int64_t PeakHeapBytes() {
  return -1;
}
void ResetPeakHeap() {}
}  // namespace glissade::test

#endif
