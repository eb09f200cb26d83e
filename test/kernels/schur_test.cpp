// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause

#include <limits>

#include "kernel_test_util.h"

namespace glissade::kernels {
namespace {

/// How S is stored.
enum class Storage { kSquare, kColumns, kDiagonal };

/// A batch of landmarks on vertices of these dimensions, `slots[l]` (ascending) seeing landmark l.
struct Batch {
  std::vector<int> dims;
  std::vector<std::vector<int>> slots;
  int dl = 1;
};

/// About `seen` of n vertices for each of `count` landmarks.
Batch RandomBatch(std::vector<int> dims, int count, int seen, int dl, Random& random) {
  Batch batch{std::move(dims), {}, dl};
  const int n = static_cast<int>(batch.dims.size());
  for (int l = 0; l < count; ++l) {
    std::vector<int>& vertices = batch.slots.emplace_back();
    for (int v = 0; v < n; ++v) {
      if (random.Below(n) < seen) vertices.push_back(v);
    }
  }
  return batch;
}

class SchurTest : public KernelTest {
 protected:
  void Check(const Batch& batch, Random& random) {
    for (const Storage storage : {Storage::kSquare, Storage::kColumns, Storage::kDiagonal})
      Check(batch, storage, random);
  }

  void Check(const Batch& batch, Storage storage, Random& random) {
    const int dl = batch.dl;
    const size_t n = batch.dims.size();
    std::vector<int32_t> row(n + 1, 0);
    bool uniform = true;
    for (size_t v = 0; v < n; ++v) {
      row[v + 1] = row[v] + batch.dims[v];
      uniform = uniform && batch.dims[v] == batch.dims[0];
    }
    const int rows = row[n];

    // Places of blocks, by column and row.
    std::vector<int64_t> place(n * n, -1);
    std::vector<int32_t> stride(n);
    int64_t size = 0;
    for (size_t c = 0; c < n; ++c) {
      stride[c] = storage == Storage::kDiagonal ? batch.dims[c] + 1 : rows + 3;
      for (size_t a = c; a < n && (storage != Storage::kDiagonal || a == c); ++a)
        place[c * n + a] = size + (storage == Storage::kDiagonal ? 0
                                   : storage == Storage::kSquare ? row[a]
                                                                 : row[a] - row[c] + 1);
      size += int64_t{stride[c]} * batch.dims[c];
    }

    // Landmarks one by one: Z and beta, their steps and products.
    Guarded s(static_cast<size_t>(size)), b(static_cast<size_t>(rows)),
        x(static_cast<size_t>(rows));
    for (Guarded* g : {&s, &b, &x})
      g->FillRandom(random);
    Guarded s_expected = s, b_expected = b, product = x, product_expected = x;
    std::vector<int32_t> begin;
    std::vector<uint16_t> landmark_of_slot;
    std::vector<std::pair<int, int>> slot_of;  // vertex, landmark
    int z_size = 0;
    for (size_t l = 0; l < batch.slots.size(); ++l) {
      for (const int v : batch.slots[l]) {
        begin.push_back(z_size);
        landmark_of_slot.push_back(static_cast<uint16_t>(l));
        slot_of.emplace_back(v, static_cast<int>(l));
        z_size += batch.dims[static_cast<size_t>(v)] * dl;
      }
    }
    Guarded z(static_cast<size_t>(z_size + 8)), beta(batch.slots.size() * static_cast<size_t>(dl));
    double* next_z = z.data();
    double* next_beta = beta.data();
    for (const std::vector<int>& slots : batch.slots) {
      std::vector<int32_t> slot_row, slot_dim;
      int touched = 0;
      for (const int v : slots) {
        slot_row.push_back(row[static_cast<size_t>(v)]);
        slot_dim.push_back(batch.dims[static_cast<size_t>(v)]);
        touched += slot_dim.back();
      }
      Guarded w(static_cast<size_t>(touched * dl)), factor(static_cast<size_t>(dl * dl)),
          b_l(static_cast<size_t>(dl));
      for (Guarded* g : {&w, &factor, &b_l})
        g->FillRandom(random);
      for (int r = 0; r < dl; ++r) {
        for (int c = r + 1; c < dl; ++c)
          factor[static_cast<size_t>(r * dl + c)] = 0.0;
      }
      const SchurLandmark landmark{static_cast<int32_t>(slots.size()),
                                   dl,
                                   slot_row.data(),
                                   slot_dim.data(),
                                   w.data(),
                                   factor.data(),
                                   b_l.data()};
      k().schur_panel(&landmark, next_z, next_beta);
      EXPECT_TRUE(w.GuardsIntact());
      Expect(landmark, place, stride, slots, n, &s_expected, &b_expected);
      CheckProducts(landmark, x, &product, &product_expected);
      next_z += touched * dl;
      next_beta += dl;
    }
    for (size_t i = 0; i < product.size(); ++i)
      ASSERT_NEAR(product[i], product_expected[i], 1e-12) << i << " dl " << dl;
    EXPECT_TRUE(z.GuardsIntact() && beta.GuardsIntact() && product.GuardsIntact());

    // Blocks by column.
    std::vector<SchurBlock> blocks;
    std::vector<SlotPair> pairs;
    for (size_t c = 0; c < n; ++c) {
      for (size_t a = c; a < n; ++a) {
        if (place[c * n + a] < 0) continue;
        SchurBlock block{place[c * n + a],
                         stride[c],
                         a == c ? row[a] : -1,
                         static_cast<int32_t>(pairs.size()),
                         0,
                         static_cast<int32_t>(c),
                         static_cast<uint16_t>(batch.dims[a]),
                         static_cast<uint16_t>(batch.dims[c])};
        for (size_t i = 0; i < slot_of.size(); ++i) {
          for (size_t j = 0; j < slot_of.size(); ++j) {
            if (slot_of[i].second != slot_of[j].second) continue;
            if (slot_of[i].first != static_cast<int>(a) || slot_of[j].first != static_cast<int>(c))
              continue;
            pairs.push_back({static_cast<uint16_t>(i), static_cast<uint16_t>(j)});
          }
        }
        block.pair_end = static_cast<int32_t>(pairs.size());
        if (block.pair_end > block.pair_begin) blocks.push_back(block);
      }
    }

    // All at once; in two parts, the second one first; and as if dimensions differed.
    SchurPanel panel{dl,           uniform ? batch.dims[0] : 0, z.data(),
                     begin.data(), landmark_of_slot.data(),     beta.data(),
                     pairs.data()};
    const auto count = static_cast<int64_t>(blocks.size());
    Guarded s_whole = s, b_whole = b;
    k().schur_blocks(&panel, count, blocks.data(), s_whole.data(), b_whole.data());
    const auto check = [&](const Guarded& s_found, const Guarded& b_found) {
      for (size_t i = 0; i < s.size(); ++i) {
        if (s_expected[i] == s[i]) {
          ASSERT_EQ(s_found[i], s[i]) << "written at " << i;
        }
        ASSERT_NEAR(s_found[i], s_expected[i], 1e-13 * double(batch.slots.size()))
            << i << " dl " << dl << " dim " << panel.dim;
      }
      for (size_t i = 0; i < b.size(); ++i)
        ASSERT_NEAR(b_found[i], b_expected[i], 1e-13 * double(batch.slots.size()));
      EXPECT_TRUE(s_found.GuardsIntact() && b_found.GuardsIntact());
    };
    check(s_whole, b_whole);
    Guarded s_parts = s, b_parts = b;
    const int64_t cut = random.Below(static_cast<int>(count) + 1);
    k().schur_blocks(&panel, count - cut, blocks.data() + cut, s_parts.data(), b_parts.data());
    k().schur_blocks(&panel, cut, blocks.data(), s_parts.data(), b_parts.data());
    EXPECT_TRUE(s_parts.SameBits(s_whole) && b_parts.SameBits(b_whole));
    panel.dim = 0;
    Guarded s_mixed = s, b_mixed = b;
    k().schur_blocks(&panel, count, blocks.data(), s_mixed.data(), b_mixed.data());
    check(s_mixed, b_mixed);
  }

  /// What one landmark subtracts, in long double: H_ll^-1 = C'C.
  static void Expect(const SchurLandmark& l, const std::vector<int64_t>& place,
                     const std::vector<int32_t>& stride, const std::vector<int>& slots, size_t n,
                     Guarded* s, Guarded* b) {
    const int dl = l.dl;
    std::vector<Wide> z, beta(static_cast<size_t>(dl));
    for (int k = 0; k < dl; ++k) {
      for (int i = 0; i <= k; ++i)
        beta[static_cast<size_t>(k)] += Wide{l.factor[k * dl + i]} * l.b[i];
    }
    int touched = 0;
    for (int a = 0; a < l.blocks; ++a)
      touched += l.dim[a];
    for (int r = 0; r < touched; ++r) {
      for (int k = 0; k < dl; ++k) {
        Wide sum = 0.0;
        for (int i = 0; i <= k; ++i)
          sum += Wide{l.w[r * dl + i]} * l.factor[k * dl + i];
        z.push_back(sum);
      }
    }
    int at_c = 0;
    for (size_t c = 0; c < slots.size(); ++c) {
      int at_a = at_c;
      for (size_t a = c; a < slots.size(); ++a) {
        const size_t vc = static_cast<size_t>(slots[c]), va = static_cast<size_t>(slots[a]);
        const int64_t to = place[vc * n + va];
        for (int r = 0; to >= 0 && r < l.dim[a]; ++r) {
          for (int i = 0; i < l.dim[c]; ++i) {
            Wide sum = 0.0;
            for (int k = 0; k < dl; ++k) {
              sum += z[static_cast<size_t>((at_a + r) * dl + k)] *
                     z[static_cast<size_t>((at_c + i) * dl + k)];
            }
            double& entry = (*s)[static_cast<size_t>(to + r + int64_t{i} * stride[vc])];
            entry = static_cast<double>(entry - sum);
          }
        }
        at_a += l.dim[a];
      }
      for (int i = 0; i < l.dim[c]; ++i) {
        Wide sum = 0.0;
        for (int k = 0; k < dl; ++k)
          sum += z[static_cast<size_t>((at_c + i) * dl + k)] * beta[static_cast<size_t>(k)];
        double& entry = (*b)[static_cast<size_t>(l.row[c] + i)];
        entry = static_cast<double>(entry - sum);
      }
      at_c += l.dim[c];
    }
  }

  /// The same without S: the landmark's own step, and its part of a product.
  void CheckProducts(const SchurLandmark& l, const Guarded& x, Guarded* product,
                     Guarded* product_expected) {
    const size_t dl = static_cast<size_t>(l.dl);
    std::vector<Wide> Wx(dl);
    int at = 0;
    for (int a = 0; a < l.blocks; ++a) {
      for (int r = 0; r < l.dim[a]; ++r, ++at) {
        for (size_t i = 0; i < dl; ++i)
          Wx[i] +=
              Wide{l.w[static_cast<size_t>(at) * dl + i]} * x[static_cast<size_t>(l.row[a] + r)];
      }
    }
    // H_ll^-1 of (b - W'x) and of W'x.
    std::vector<Wide> of_step(dl), of_product(dl);
    for (size_t i = 0; i < dl; ++i) {
      for (size_t j = 0; j < dl; ++j) {
        Wide inverse = 0.0;
        for (size_t r = 0; r < dl; ++r)
          inverse += Wide{l.factor[r * dl + i]} * l.factor[r * dl + j];
        of_step[i] += inverse * (l.b[j] - Wx[j]);
        of_product[i] += inverse * Wx[j];
      }
    }
    Guarded step(dl);
    k().landmark_step(&l, x.data(), step.data());
    for (size_t i = 0; i < dl; ++i)
      ASSERT_NEAR(step[i], static_cast<double>(of_step[i]), 1e-12);
    EXPECT_TRUE(step.GuardsIntact());
    k().schur_multiply(&l, x.data(), product->data());
    at = 0;
    for (int a = 0; a < l.blocks; ++a) {
      for (int r = 0; r < l.dim[a]; ++r, ++at) {
        Wide sum = 0.0;
        for (size_t i = 0; i < dl; ++i)
          sum += l.w[static_cast<size_t>(at) * dl + i] * of_product[i];
        double& to = (*product_expected)[static_cast<size_t>(l.row[a] + r)];
        to = static_cast<double>(to - sum);
      }
    }
  }
};
GLISSADE_INSTANTIATE_KERNEL_TEST(SchurTest);

TEST_P(SchurTest, UniformBlocks) {
  Random random(31);
  for (const int d : {1, 2, 3, 4, 5, 6, 7, 8, 9, 12, 15, 16}) {
    for (int dl = 1; dl <= 4; ++dl) {
      for (const int landmarks : {1, 2, 7}) {
        Check(RandomBatch(std::vector<int>(5, d), landmarks, 3, dl, random), random);
        Check(RandomBatch(std::vector<int>(2, d), landmarks, 2, dl, random), random);
      }
    }
  }
}

TEST_P(SchurTest, MixedBlocks) {
  Random random(32);
  const int kinds[] = {6, 9, 1, 3, 15, 2};
  for (int dl = 1; dl <= 4; ++dl) {
    for (int trial = 0; trial < 20; ++trial) {
      std::vector<int> dims(static_cast<size_t>(1 + random.Below(8)));
      for (int& d : dims)
        d = kinds[random.Below(6)];
      Check(RandomBatch(dims, 1 + random.Below(9), 4, dl, random), random);
    }
  }
}

TEST_P(SchurTest, ManyLandmarksOnFewVertices) {
  Random random(33);
  for (int dl = 1; dl <= 4; ++dl) {
    Check(RandomBatch(std::vector<int>(3, 6), 60, 2, dl, random), random);
    Check(RandomBatch(std::vector<int>(3, 9), 60, 2, dl, random), random);
  }
}

TEST_P(SchurTest, NoBlocks) {
  const SchurPanel panel{};
  k().schur_blocks(&panel, 0, nullptr, nullptr, nullptr);
  const SchurLandmark nobody_sees{0, 1, nullptr, nullptr, nullptr, nullptr, nullptr};
  const double factor = 2.0, b = 3.0;
  SchurLandmark landmark = nobody_sees;
  landmark.factor = &factor;
  landmark.b = &b;
  double z = 7.0, beta = 0.0;
  k().schur_panel(&landmark, &z, &beta);
  EXPECT_EQ(z, 7.0);
  EXPECT_EQ(beta, 6.0);
}

TEST_P(SchurTest, FactorOfASmallInverse) {
  Random random(34);
  for (int n = 1; n <= 4; ++n) {
    for (int trial = 0; trial < 200; ++trial) {
      const size_t size = static_cast<size_t>(n * n);
      const GuardedMatrix a = RandomSpd(n, n, 0.0, random);
      const double scale = std::pow(10.0, 6.0 * random.Uniform());
      Guarded h(size);
      for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) {
          h[static_cast<size_t>(r * n + c)] = scale * (r >= c ? a(r, c) : a(c, r));
        }
      }
      const Guarded original = h;
      ASSERT_EQ(k().inverse_factor(n, h.data()), 0);
      EXPECT_TRUE(h.GuardsIntact());
      // C H C' = I, C lower triangular.
      for (int r = 0; r < n; ++r) {
        for (int c = 0; c < n; ++c) {
          long double s = 0.0;
          for (int i = 0; i < n; ++i) {
            for (int j = 0; j < n; ++j) {
              s += Wide{h[static_cast<size_t>(r * n + i)]} *
                   original[static_cast<size_t>(i * n + j)] * h[static_cast<size_t>(c * n + j)];
            }
          }
          EXPECT_NEAR(static_cast<double>(s), r == c ? 1.0 : 0.0, 1e-13);
          if (c > r) {
            EXPECT_EQ(h[static_cast<size_t>(r * n + c)], 0.0);
          }
        }
      }
      // The upper triangle is not read.
      Guarded lower = original;
      for (int r = 0; r < n; ++r) {
        for (int c = r + 1; c < n; ++c) {
          lower[static_cast<size_t>(r * n + c)] = std::numeric_limits<double>::quiet_NaN();
        }
      }
      ASSERT_EQ(k().inverse_factor(n, lower.data()), 0);
      EXPECT_TRUE(lower.SameBits(h));
    }
  }
}

TEST_P(SchurTest, FactorOfASmallInverseRefusesWhatHasNone) {
  const double bad_values[] = {0.0, -1.0, std::numeric_limits<double>::quiet_NaN(),
                               std::numeric_limits<double>::infinity(), 1e-320};
  for (int n = 1; n <= 4; ++n) {
    for (int at = 0; at < n; ++at) {
      for (const double value : bad_values) {
        Guarded h(static_cast<size_t>(n * n));
        for (int r = 0; r < n; ++r) {
          for (int c = 0; c < n; ++c)
            h[static_cast<size_t>(r * n + c)] = r == c ? 2.0 : 0.0;
        }
        h[static_cast<size_t>(at * n + at)] = value;
        const Guarded original = h;
        EXPECT_EQ(k().inverse_factor(n, h.data()), 1) << "n " << n << " value " << value;
        EXPECT_TRUE(h.SameBits(original));
      }
    }
  }
  double rank_one[4] = {1.0, 2.0, 2.0, 4.0};
  EXPECT_EQ(k().inverse_factor(2, rank_one), 1);
  EXPECT_EQ(k().inverse_factor(0, rank_one), 1);
  EXPECT_EQ(k().inverse_factor(5, rank_one), 1);
}

}  // namespace
}  // namespace glissade::kernels
