// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace glissade {

/// Names a vertex or edge type; its address is the type's identity.
struct TypeInfo {
  std::string_view name;
};

namespace internal {

template <class T>
consteval std::string_view TypeName() {
#if defined(__clang__) || defined(__GNUC__)
  // "... TypeName() [with T = ns::Name; ...]" (GCC) or "... TypeName() [T = ns::Name]" (Clang).
  std::string_view text = __PRETTY_FUNCTION__;
  const std::size_t begin = text.find("T = ") + 4;
  std::size_t end = text.find(';', begin);
  if (end == std::string_view::npos) end = text.rfind(']');
  text = text.substr(begin, end - begin);
  constexpr std::string_view kNamespace = "glissade::";
  if (text.substr(0, kNamespace.size()) == kNamespace) text.remove_prefix(kNamespace.size());
  return text;
#else
  return "type";
#endif
}

}  // namespace internal

template <class T>
inline constexpr TypeInfo kTypeInfo{internal::TypeName<T>()};

inline constexpr std::uint32_t kNullSlot = 0xffffffffu;

/// Address of a vertex of type V in one Graph. Small, copyable, never dangling: once its vertex is
/// removed, every call that is given the handle refuses it, and so does every other graph. Only a
/// clone knows the handles that its original had given out by then. A default-constructed handle is
/// null. Handles can be compared and hashed; there is one handle for a vertex, whoever is asked.
template <class V>
struct VertexHandle {
  std::uint32_t slot = kNullSlot;
  std::uint32_t generation = 0;
  std::uint32_t graph = 0;  ///< the graph it was added to; 0: none
  friend bool operator==(const VertexHandle&, const VertexHandle&) = default;
};

/// Address of an edge of type E in one Graph; see VertexHandle.
template <class E>
struct EdgeHandle {
  std::uint32_t slot = kNullSlot;
  std::uint32_t generation = 0;
  std::uint32_t graph = 0;  ///< the graph it was added to; 0: none
  friend bool operator==(const EdgeHandle&, const EdgeHandle&) = default;
};

/// A vertex handle whose type is known at run time only.
struct AnyVertex {
  const TypeInfo* type = nullptr;
  std::uint32_t slot = kNullSlot;
  std::uint32_t generation = 0;
  std::uint32_t graph = 0;

  AnyVertex() = default;
  AnyVertex(const TypeInfo* t, std::uint32_t s, std::uint32_t g, std::uint32_t of_graph = 0)
      : type(t), slot(s), generation(g), graph(of_graph) {}
  template <class V>
  AnyVertex(VertexHandle<V> h)  // NOLINT: implicit, a typed handle is a handle
      : type(&kTypeInfo<V>), slot(h.slot), generation(h.generation), graph(h.graph) {}

  /// The typed handle; nothing where the vertex is of another type.
  template <class V>
  [[nodiscard]] std::optional<VertexHandle<V>> As() const {
    if (type != &kTypeInfo<V>) return std::nullopt;
    return VertexHandle<V>{slot, generation, graph};
  }

  explicit operator bool() const { return slot != kNullSlot; }
  friend bool operator==(const AnyVertex&, const AnyVertex&) = default;
};

/// An edge handle whose type is known at run time only.
struct AnyEdge {
  const TypeInfo* type = nullptr;
  std::uint32_t slot = kNullSlot;
  std::uint32_t generation = 0;
  std::uint32_t graph = 0;

  AnyEdge() = default;
  AnyEdge(const TypeInfo* t, std::uint32_t s, std::uint32_t g, std::uint32_t of_graph = 0)
      : type(t), slot(s), generation(g), graph(of_graph) {}
  template <class E>
  AnyEdge(EdgeHandle<E> h)  // NOLINT: implicit, a typed handle is a handle
      : type(&kTypeInfo<E>), slot(h.slot), generation(h.generation), graph(h.graph) {}

  /// The typed handle; nothing where the edge is of another type.
  template <class E>
  [[nodiscard]] std::optional<EdgeHandle<E>> As() const {
    if (type != &kTypeInfo<E>) return std::nullopt;
    return EdgeHandle<E>{slot, generation, graph};
  }

  explicit operator bool() const { return slot != kNullSlot; }
  friend bool operator==(const AnyEdge&, const AnyEdge&) = default;
};

/// "VertexPose #3"; "null" for a null handle.
template <class Handle>
std::string ToString(const Handle& handle) {
  const auto name = [](const auto& any) {
    if (!any || any.type == nullptr) return std::string("null");
    std::string text(any.type->name);
    return text.append(" #").append(std::to_string(any.slot));
  };
  if constexpr (requires { handle.type; }) {
    return name(handle);
  } else if constexpr (requires { AnyVertex(handle); }) {
    return name(AnyVertex(handle));
  } else {
    return name(AnyEdge(handle));
  }
}

namespace internal {

/// Of a handle's numbers; types share slot numbers, so that a few of a mixed set collide.
template <class Handle>
struct HandleHash {
  std::size_t operator()(const Handle& handle) const noexcept {
    std::uint64_t x = (std::uint64_t{handle.slot} << 32 | handle.generation) ^
                      std::uint64_t{handle.graph} * 0x9e3779b97f4a7c15u;
    x = (x ^ x >> 32) * 0xd6e8feb86659fd93u;
    return static_cast<std::size_t>(x ^ x >> 32);
  }
};

}  // namespace internal
}  // namespace glissade

template <class V>
struct std::hash<glissade::VertexHandle<V>>
    : glissade::internal::HandleHash<glissade::VertexHandle<V>> {};
template <class E>
struct std::hash<glissade::EdgeHandle<E>>
    : glissade::internal::HandleHash<glissade::EdgeHandle<E>> {};
template <>
struct std::hash<glissade::AnyVertex> : glissade::internal::HandleHash<glissade::AnyVertex> {};
template <>
struct std::hash<glissade::AnyEdge> : glissade::internal::HandleHash<glissade::AnyEdge> {};
