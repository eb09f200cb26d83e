// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "regression/malloc_count.h"

#include <atomic>
#include <cerrno>
#include <cstdlib>
#include <limits>

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

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

}  // namespace glissade::test

// glibc's own functions under their second names. free() and malloc_usable_size() need no
// replacement: the blocks are glibc's.
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t n, std::size_t size);
void* __libc_realloc(void* block, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  return __libc_calloc(n, size);
}
void* realloc(void* block, std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  return __libc_realloc(block, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  if (!Allow()) return nullptr;
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** block, std::size_t alignment, std::size_t size) noexcept {
  *block = Allow() ? __libc_memalign(alignment, size) : nullptr;
  return *block != nullptr ? 0 : ENOMEM;
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
}  // namespace glissade::test

#endif
