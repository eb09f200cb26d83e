// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <new>

#include "glissade/base/status.h"

namespace glissade::internal {

/// f(), which returns a Status or a Result; std::bad_alloc on the way becomes kOutOfMemory, with a
/// message so short that it needs no memory itself. All else that f throws comes out.
template <class F>
auto OrOutOfMemory(F&& f) -> decltype(f()) {
  try {
    return f();
  } catch (const std::bad_alloc&) {
    return Status(StatusCode::kOutOfMemory, "out of memory");
  }
}

}  // namespace glissade::internal
