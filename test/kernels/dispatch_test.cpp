// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include "kernels/dispatch.h"

#include <cstdlib>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

TEST(DispatchTest, UnsetTakesTheBest) {
  for (const Isa best : {Isa::kBaseline, Isa::kAvx2, Isa::kAvx512}) {
    for (const char* request : {static_cast<const char*>(nullptr), ""}) {
      const IsaSelection selection = SelectIsa(best, request);
      EXPECT_EQ(selection.isa, best);
      EXPECT_STREQ(selection.note, "");
    }
  }
}

TEST(DispatchTest, RequestsWithinReachAreHonouredSilently) {
  EXPECT_EQ(SelectIsa(Isa::kAvx512, "baseline").isa, Isa::kBaseline);
  EXPECT_EQ(SelectIsa(Isa::kAvx512, "avx2").isa, Isa::kAvx2);
  EXPECT_EQ(SelectIsa(Isa::kAvx512, "avx512").isa, Isa::kAvx512);
  EXPECT_EQ(SelectIsa(Isa::kBaseline, "baseline").isa, Isa::kBaseline);
  EXPECT_STREQ(SelectIsa(Isa::kAvx2, "avx2").note, "");
}

TEST(DispatchTest, RequestsOutOfReachFallBackWithANote) {
  EXPECT_EQ(SelectIsa(Isa::kAvx2, "avx512").isa, Isa::kAvx2);
  EXPECT_STRNE(SelectIsa(Isa::kAvx2, "avx512").note, "");
  EXPECT_EQ(SelectIsa(Isa::kBaseline, "avx512").isa, Isa::kBaseline);
  EXPECT_STRNE(SelectIsa(Isa::kBaseline, "avx512").note, "");
  EXPECT_EQ(SelectIsa(Isa::kAvx512, "AVX2").isa, Isa::kAvx512);
  EXPECT_STRNE(SelectIsa(Isa::kAvx512, "AVX2").note, "");
}

TEST(DispatchTest, TablesAreComplete) {
  ASSERT_NE(KernelsFor(Isa::kBaseline), nullptr);
  for (const KernelTable* table : AvailableTables()) {
    EXPECT_EQ(KernelsFor(table->isa), table);
    // Every member after the header is a function pointer.
    const char* begin = reinterpret_cast<const char*>(&table->cholesky);
    const char* end = reinterpret_cast<const char*>(table) + sizeof(*table);
    for (const char* p = begin; p < end; p += sizeof(void*)) {
      void* pointer;
      std::memcpy(&pointer, p, sizeof(pointer));
      EXPECT_NE(pointer, nullptr) << table->name << " member " << (p - begin) / 8;
    }
  }
}

TEST(DispatchTest, TheEnvironmentIsObeyed) {
  const KernelTable& table = Kernels();
  EXPECT_EQ(&Kernels(), &table);
  const char* forced = std::getenv("GLISSADE_ISA");
  if (forced == nullptr) {
    EXPECT_EQ(&table, AvailableTables().back());
    EXPECT_STREQ(IsaSelectionNote(), "");
  } else if (*IsaSelectionNote() == '\0' && *forced != '\0') {
    EXPECT_STREQ(table.name, forced);
  }
}

}  // namespace
}  // namespace glissade::kernels
