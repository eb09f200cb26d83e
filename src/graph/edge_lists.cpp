// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/graph/edge_lists.h"
#include "glissade/graph/pools.h"

#include <algorithm>

namespace glissade::internal {

void EdgeLists::Clear() {
  for (Column& column : columns_)
    std::fill(column.heads.begin(), column.heads.end(), -1);
  next_.clear();
  edge_of_link_.clear();
}

void EdgeLists::Rebind(const std::vector<std::unique_ptr<VertexPoolBase>>& pools) {
  for (Column& column : columns_) {
    const TypeInfo* type = column.vertices->ops().type;
    const auto same = std::find_if(pools.begin(), pools.end(),
                                   [&](const auto& pool) { return pool->ops().type == type; });
    column.vertices = same->get();
  }
}

void EdgeLists::Grow(std::vector<std::int32_t>* heads, std::uint32_t slot) {
  heads->resize(std::max<std::size_t>({slot + std::size_t{1}, 2 * heads->size(), 16}), -1);
}

}  // namespace glissade::internal
