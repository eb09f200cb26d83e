// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#pragma once

#include <cstdint>
#include <memory>
#include <vector>

#include "glissade/graph/vertex_pool.h"

namespace glissade::internal {

/// Which edges of one pool there are at each vertex: a singly linked list per vertex through the
/// edges' arguments ("links"), youngest first.
///
/// Why lists and not a sorted index that is built when somebody asks: a sliding window adds and
/// removes edges all the time and asks about hundreds of landmarks in between; an index would be
/// built anew for each question. Why not doubly linked: what is removed stays where it is, marked,
/// until Graph::Compact(), which closes the gaps and links anew what is left, so that nobody has to
/// find a link's predecessor. An added edge writes two numbers for each of its vertices.
///
/// Heads are by vertex slot, which stays when dense indices change; links are by dense edge index.
class EdgeLists {
 public:
  /// arity: of all edges; 0 if it differs from edge to edge.
  explicit EdgeLists(int arity) : arity_(arity) {}

  /// The lists of the vertices of a pool, as a number for the calls below; new ones if there are
  /// none yet. May allocate.
  int ColumnOf(const VertexPoolBase* vertices) {
    const int column = Find(vertices);
    if (column >= 0) return column;
    columns_.push_back({vertices, {}});
    return static_cast<int>(columns_.size()) - 1;
  }
  /// The next Append() for this vertex, and `count` in all, will not allocate.
  void MakeRoom(int column, std::uint32_t slot) {
    std::vector<std::int32_t>& heads = columns_[static_cast<std::size_t>(column)].heads;
    if (slot >= heads.size()) Grow(&heads, slot);
  }
  void MakeRoomForLinks(std::size_t count) {
    MakeRoomIn(&next_, count);
    if (arity_ == 0) MakeRoomIn(&edge_of_link_, count);
  }
  /// Links the next argument of an edge: of all edges in their order, of each edge all arguments.
  void Append(int column, std::uint32_t slot, int edge) {
    std::int32_t& head = columns_[static_cast<std::size_t>(column)].heads[slot];
    next_.push_back(head);
    head = static_cast<std::int32_t>(next_.size()) - 1;
    if (arity_ == 0) edge_of_link_.push_back(edge);
  }
  /// Takes back the last Append(), which was for this vertex.
  void TakeBack(int column, std::uint32_t slot) {
    columns_[static_cast<std::size_t>(column)].heads[slot] = next_.back();
    next_.pop_back();
    if (arity_ == 0) edge_of_link_.pop_back();
  }
  /// Forgets the edges at a vertex.
  void Drop(const VertexPoolBase* vertices, std::uint32_t slot) {
    const int column = Find(vertices);
    if (column < 0) return;
    std::vector<std::int32_t>& heads = columns_[static_cast<std::size_t>(column)].heads;
    if (slot < heads.size()) heads[slot] = -1;
  }
  /// Forgets all edges, keeps the room.
  void Clear();
  /// To the pools of the same types of another graph: the edges were copied there.
  void Rebind(const std::vector<std::unique_ptr<VertexPoolBase>>& pools);

  /// The first link of a vertex; negative if there is none. Then Next(), until that is negative.
  [[nodiscard]] std::int32_t First(const VertexPoolBase* vertices, std::uint32_t slot) const {
    const int column = Find(vertices);
    if (column < 0) return -1;
    const std::vector<std::int32_t>& heads = columns_[static_cast<std::size_t>(column)].heads;
    return slot < heads.size() ? heads[slot] : -1;
  }
  [[nodiscard]] std::int32_t Next(std::int32_t link) const {
    return next_[static_cast<std::size_t>(link)];
  }
  [[nodiscard]] int EdgeOf(std::int32_t link) const {
    return arity_ == 0 ? edge_of_link_[static_cast<std::size_t>(link)] : link / arity_;
  }

 private:
  struct Column {
    const VertexPoolBase* vertices;
    std::vector<std::int32_t> heads;  // by slot, as far as there were edges
  };
  [[nodiscard]] int Find(const VertexPoolBase* vertices) const {
    for (std::size_t k = 0; k < columns_.size(); ++k) {
      if (columns_[k].vertices == vertices) return static_cast<int>(k);
    }
    return -1;
  }
  static void Grow(std::vector<std::int32_t>* heads, std::uint32_t slot);

  int arity_;
  std::vector<Column> columns_;
  std::vector<std::int32_t> next_;
  std::vector<std::int32_t> edge_of_link_;  // where arity_ is 0
};

}  // namespace glissade::internal
