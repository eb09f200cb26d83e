// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <cstring>
#include <iterator>
#include <tuple>
#include <type_traits>
#include <utility>

#include "glissade/base/bundle.h"
#include "glissade/base/pack.h"
#include "glissade/edges/concept.h"
#include "glissade/edges/lane_run.h"

/// \file
/// A run of template edges (edges/lanes.h), as many edges at once as a register has room for. All
/// of it belongs to the unit that instantiates it: see Unit in base/pack.h.
namespace glissade::internal {

template <class E, class Unit, class List = typename E::Vertices,
          class Lanes = std::remove_cvref_t<decltype(E::kLanes)>>
struct PackEvaluator;

template <class E, class Unit, class... V, class... M>
struct PackEvaluator<E, Unit, VertexList<V...>, std::tuple<M...>> {
  using T = Pack<Unit>;
  static constexpr int kW = T::kWidth;
  static constexpr int kRows = E::kResidualDim;
  using Views = Bundle<View<V, T>...>;
  using Lanes = Bundle<typename LaneAt<T, M>::Type...>;
  using Vertices = std::index_sequence_for<V...>;
  static constexpr bool kDuals = kIsResidualOnly<E>;
  struct None {};
  using Tangents = std::conditional_t<kDuals, Bundle<ViewTangent<V, T>...>, None>;

  struct Results {
    Vec<T, kRows> r;
    Bundle<Mat<T, kRows, V::kTangentDim>...> J;
  };

  /// The n-th number of an object of packs.
  template <class Object>
  static T* Number(Object* object, int n) {
    return reinterpret_cast<T*>(object) + n;
  }

  /// tangents: null where no Jacobians are wanted.
  template <std::size_t... I>
  static void LoadFrames(const LaneRun& run, Views* views, Tangents* tangents,
                         std::index_sequence<I...>) {
    const auto load = [&](auto i, auto* view) {
      using Vertex = EdgeVertex<E, static_cast<int>(i())>;
      if (static_cast<int>(i()) == run.landmark) return;
      *view = Broadcast<T>(ViewOfState<Vertex>(run.states[i()]));
      if constexpr (kDuals) {
        if (tangents == nullptr) return;
        ViewTangent<Vertex, double> tangent;
        FindViewTangent<Vertex>(run.states[i()], &tangent);
        auto& out = Get<i()>(*tangents);
        for (std::size_t n = 0; n < std::size(out.d); ++n)
          out.d[n] = T(tangent.d[n]);
      }
    };
    (load(std::integral_constant<std::size_t, I>{}, &Get<I>(*views)), ...);
  }

  template <std::size_t... I>
  static void LoadLandmarks(const LaneRun& run, const int* lane, Views* views, Tangents* tangents,
                            std::index_sequence<I...>) {
    const auto load = [&](auto i, auto* view) {
      using Vertex = EdgeVertex<E, static_cast<int>(i())>;
      if constexpr (Vertex::kTangentDim <= 4) {  // else it cannot be one
        if (static_cast<int>(i()) != run.landmark) return;
        constexpr int kCount = static_cast<int>(sizeof(*view) / sizeof(T));
        if constexpr (kViewIsState<Vertex>) {
          for (int n = 0; n < kCount; ++n)
            *Number(view, n) = T::Of([&](int k) { return run.landmark_states[lane[k]][n]; });
        } else {
          double numbers[kW][kCount];
          for (int k = 0; k < kW; ++k) {
            const auto one = View<Vertex, double>::Of(run.landmark_states[lane[k]]);
            std::memcpy(numbers[k], &one, sizeof(one));
          }
          for (int n = 0; n < kCount; ++n)
            *Number(view, n) = T::Of([&](int k) { return numbers[k][n]; });
        }
        if constexpr (kDuals) {
          if (tangents == nullptr) return;
          ViewTangent<Vertex, double> of_lane[kW];
          for (int k = 0; k < kW; ++k)
            FindViewTangent<Vertex>(run.landmark_states[lane[k]], &of_lane[k]);
          auto& out = Get<i()>(*tangents);
          for (std::size_t n = 0; n < std::size(out.d); ++n)
            out.d[n] = T::Of([&](int k) { return of_lane[k].d[n]; });
        }
      }
    };
    (load(std::integral_constant<std::size_t, I>{}, &Get<I>(*views)), ...);
  }

  template <std::size_t... K>
  static void LoadLanes(const E* edges, const LaneRun& run, const int* lane, Lanes* lanes,
                        std::index_sequence<K...>) {
    const auto load = [&](auto member, auto* out) {
      constexpr int kCount = static_cast<int>(sizeof(*out) / sizeof(T));
      const double* numbers[kW];
      for (int k = 0; k < kW; ++k)
        numbers[k] = reinterpret_cast<const double*>(&(edges[run.edges[lane[k]]].*member));
      for (int n = 0; n < kCount; ++n)
        *Number(out, n) = T::Of([&](int k) { return numbers[k][n]; });
    };
    (load(LaneMember<E, K>(), &Get<K>(*lanes)), ...);
  }

  template <std::size_t... I, std::size_t... K>
  static bool Call(const E& edge, const Views& views, [[maybe_unused]] const Tangents& tangents,
                   const Lanes& lanes, double* const* J, Results* out, std::index_sequence<I...>,
                   std::index_sequence<K...>) {
    if constexpr (kDuals) {
      return DualEvaluator<E, T, typename E::Vertices, typename LaneAt<T, M>::Type...>::Evaluate(
          edge, views, tangents, lanes, out->r,
          (J != nullptr && J[I] != nullptr ? &Get<I>(out->J) : nullptr)...);
    } else {
      return edge.Evaluate(Get<I>(views)..., Get<K>(lanes)..., out->r,
                           (J != nullptr && J[I] != nullptr ? &Get<I>(out->J) : nullptr)...);
    }
  }

  /// Edges of these kW lanes.
  static bool EvaluatePack(const E* edges, const LaneRun& run, const int* lane, Views* views,
                           Tangents* tangents, double* const* J, Results* out) {
    LoadLandmarks(run, lane, views, J != nullptr ? tangents : nullptr, Vertices{});
    Lanes lanes;
    LoadLanes(edges, run, lane, &lanes, std::index_sequence_for<M...>{});
    return Call(edges[run.edges[lane[0]]], *views, *tangents, lanes, J, out, Vertices{},
                std::index_sequence_for<M...>{});
  }

  /// Puts all lanes of the results, or the first one alone, where lane s is.
  template <std::size_t... I>
  static void Store(const Results& results, const LaneRun& run, const LaneValues& values, int s,
                    bool one, std::index_sequence<I...>) {
    const auto put = [&](const auto& from, double* to) {
      constexpr int kCount = static_cast<int>(sizeof(from) / sizeof(T));
      for (int n = 0; n < kCount; ++n) {
        double* at = to + std::int64_t{n} * run.lanes + s;
        if (one) {
          *at = from[n].Lane(0);
        } else {
          from[n].Store(at);
        }
      }
    };
    put(results.r, values.r);
    ((values.J != nullptr && values.J[I] != nullptr ? put(Get<I>(results.J), values.J[I]) : void()),
     ...);
  }

  /// Tells the compiler that an object is written to, where it cannot see that all of it is before
  /// it is read. Costs nothing.
  template <class Object>
  static void CountAsWritten(Object* object) {
    __asm__ volatile("" : "=m"(*object));
  }

  static int Evaluate(const void* all, const LaneRun& run, const LaneValues& values) {
    const E* edges = static_cast<const E*>(all);
    Views views;
    Tangents tangents;
    CountAsWritten(&views);
    CountAsWritten(&tangents);
    LoadFrames(run, &views, values.J != nullptr ? &tangents : nullptr, Vertices{});
    Results results;
    CountAsWritten(&results);
    for (int s = 0; s < run.count; s += kW) {
      int lane[kW];
      for (int k = 0; k < kW; ++k)
        lane[k] = s + k < run.count ? s + k : run.count - 1;
      pack_diverged<Unit> = false;
      const bool ok = EvaluatePack(edges, run, lane, &views, &tangents, values.J, &results);
      if (!pack_diverged<Unit>) {
        if (!ok) return s;
        Store(results, run, values, s, false, Vertices{});
        continue;
      }
      // Each with a pack of its own.
      if (values.one_by_one != nullptr) ++*values.one_by_one;
      for (int k = 0; k < kW && s + k < run.count; ++k) {
        int same[kW];
        for (int i = 0; i < kW; ++i)
          same[i] = s + k;
        if (!EvaluatePack(edges, run, same, &views, &tangents, values.J, &results)) return s + k;
        Store(results, run, values, s + k, true, Vertices{});
      }
    }
    return -1;
  }
};

/// What AddEdge of E belongs to: this unit, where it brings code for packs.
template <class E>
using UnitOf = std::conditional_t<kEvaluatesInPacks<E> && !kLibraryEvaluates<E>, ThisUnit, void>;

/// The EvaluateLanes of E in this unit; null where E is not a template, or the library's own.
template <class E, class Unit>
constexpr EvaluateLanes UnitEvaluator() {
  if constexpr (kEvaluatesInPacks<E> && !kLibraryEvaluates<E>) {
    return &PackEvaluator<E, Unit>::Evaluate;
  } else {
    return nullptr;
  }
}

}  // namespace glissade::internal
