// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

// The choice of a kernel table as a pure function, so that it can be tested for every CPU.

#ifndef GLISSADE_KERNELS_DISPATCH_H_
#define GLISSADE_KERNELS_DISPATCH_H_

#include "kernels/kernels.h"

namespace glissade::kernels {

struct IsaSelection {
  Isa isa;
  const char* note;  ///< static text, empty when the request was honoured or absent
};

/// The instruction set to use on a CPU (and build) that supports all up to `best`.
/// `requested` is the value of GLISSADE_ISA, null or empty when unset. A request above `best` gives
/// `best`; an unknown one is ignored; both leave a note.
IsaSelection SelectIsa(Isa best, const char* requested);

}  // namespace glissade::kernels

#endif  // GLISSADE_KERNELS_DISPATCH_H_
