// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <atomic>
#include <cstddef>

/// \file
/// Counts allocations of the whole program by standing in front of malloc: operator new and Eigen's
/// own allocator end there too. It DEFINES malloc, so include it in one source file of a program.
/// Where that cannot be done (other C libraries, sanitizers) kCanCountAllocations is false.
namespace glissade::app {

inline std::atomic<long long> num_allocations{0};

}  // namespace glissade::app

#if defined(__GLIBC__) && !defined(__SANITIZE_ADDRESS__) && !defined(__SANITIZE_THREAD__)

namespace glissade::app {
inline constexpr bool kCanCountAllocations = true;
inline void CountAllocation() {
  num_allocations.fetch_add(1, std::memory_order_relaxed);
}
}  // namespace glissade::app

// The names of the C library's own functions.
// NOLINTBEGIN
extern "C" {
void* __libc_malloc(std::size_t size);
void* __libc_calloc(std::size_t n, std::size_t size);
void* __libc_realloc(void* p, std::size_t size);
void* __libc_memalign(std::size_t alignment, std::size_t size);

void* malloc(std::size_t size) noexcept {
  glissade::app::CountAllocation();
  return __libc_malloc(size);
}
void* calloc(std::size_t n, std::size_t size) noexcept {
  glissade::app::CountAllocation();
  return __libc_calloc(n, size);
}
void* realloc(void* p, std::size_t size) noexcept {
  glissade::app::CountAllocation();
  return __libc_realloc(p, size);
}
void* memalign(std::size_t alignment, std::size_t size) noexcept {
  glissade::app::CountAllocation();
  return __libc_memalign(alignment, size);
}
void* aligned_alloc(std::size_t alignment, std::size_t size) noexcept {
  glissade::app::CountAllocation();
  return __libc_memalign(alignment, size);
}
int posix_memalign(void** p, std::size_t alignment, std::size_t size) noexcept {
  glissade::app::CountAllocation();
  *p = __libc_memalign(alignment, size);
  return *p != nullptr || size == 0 ? 0 : 12;  // ENOMEM
}
}
// NOLINTEND

#else

namespace glissade::app {
inline constexpr bool kCanCountAllocations = false;
}

#endif
