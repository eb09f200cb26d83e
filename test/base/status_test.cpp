// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
#include "glissade/base/status.h"

#include <gtest/gtest.h>

#include <memory>
#include <set>
#include <string>
#include <vector>

namespace glissade {
namespace {

struct Vertex {};
struct Edge {};

TEST(Status, DefaultIsOkAndBlamesNobody) {
  const Status status;
  EXPECT_TRUE(status.ok());
  EXPECT_TRUE(bool(status));
  EXPECT_EQ(status.code(), StatusCode::kOk);
  EXPECT_TRUE(status.message().empty());
  EXPECT_FALSE(status.vertex());
  EXPECT_FALSE(status.edge());
  EXPECT_FALSE(status.other_edge());
}

TEST(Status, KeepsCodeMessageAndCulprit) {
  const VertexHandle<Vertex> v{7, 2};
  const Status about_vertex(StatusCode::kSingular, "flat", AnyVertex(v));
  EXPECT_FALSE(about_vertex.ok());
  EXPECT_EQ(about_vertex.code(), StatusCode::kSingular);
  EXPECT_EQ(about_vertex.message(), "flat");
  EXPECT_EQ(about_vertex.vertex(), AnyVertex(v));
  EXPECT_FALSE(about_vertex.edge());

  const EdgeHandle<Edge> a{1, 0}, b{2, 5};
  const Status duplicate(StatusCode::kDuplicate, "twice", AnyEdge(a), AnyEdge(b));
  EXPECT_EQ(duplicate.edge(), AnyEdge(a));
  EXPECT_EQ(duplicate.other_edge(), AnyEdge(b));
  EXPECT_FALSE(duplicate.vertex());
}

TEST(Status, EveryCodeHasAnOwnName) {
  std::set<std::string_view> names;
  int count = 0;
  for (int code = 0; code <= static_cast<int>(StatusCode::kParseError); ++code, ++count) {
    const std::string_view name = ToString(static_cast<StatusCode>(code));
    EXPECT_FALSE(name.empty());
    EXPECT_NE(name, "unknown");
    names.insert(name);
  }
  EXPECT_EQ(static_cast<int>(names.size()), count);
  EXPECT_EQ(ToString(static_cast<StatusCode>(1000)), "unknown");
}

TEST(Result, HoldsAValueOrSaysWhyNot) {
  const Result<int> good = 3;
  EXPECT_TRUE(good.ok());
  EXPECT_TRUE(good.status().ok());
  EXPECT_EQ(good.value(), 3);
  EXPECT_EQ(*good, 3);

  const Result<int> bad = Status(StatusCode::kNotFinite, "NaN");
  EXPECT_FALSE(bad.ok());
  EXPECT_FALSE(bool(bad));
  EXPECT_EQ(bad.status().code(), StatusCode::kNotFinite);
  EXPECT_EQ(bad.value(), 0) << "a default-constructed value stands in";
}

TEST(Result, AnOkStatusIsNoResult) {
  const Result<int> result = Status();
  EXPECT_FALSE(result.ok()) << "there is no value, so it cannot be ok";
  EXPECT_FALSE(result.status().message().empty());
}

TEST(Result, ConvertsToHandlesAndToTheNullHandleOnFailure) {
  const Result<VertexHandle<Vertex>> good = VertexHandle<Vertex>{4, 1};
  const VertexHandle<Vertex> typed = good;
  const AnyVertex any = good;
  EXPECT_EQ(typed.slot, 4u);
  EXPECT_EQ(any, AnyVertex(typed));

  const Result<VertexHandle<Vertex>> bad = Status(StatusCode::kInvalidArgument, "no");
  const AnyVertex none = bad;
  EXPECT_FALSE(none);
  EXPECT_EQ(ToString(none), "null");
}

TEST(Result, MovesValuesThatCannotBeCopied) {
  Result<std::unique_ptr<int>> result = std::make_unique<int>(5);
  std::unique_ptr<int> taken = std::move(result).value();
  ASSERT_NE(taken, nullptr);
  EXPECT_EQ(*taken, 5);
}

TEST(Handles, NullUntilGiven) {
  EXPECT_FALSE(AnyVertex());
  EXPECT_FALSE(AnyEdge());
  EXPECT_FALSE(AnyVertex(VertexHandle<Vertex>()));
  EXPECT_EQ(ToString(VertexHandle<Vertex>()), "null");
  EXPECT_EQ(ToString(EdgeHandle<Edge>()), "null");
}

TEST(Handles, OfDifferentTypesOrGenerationsDiffer) {
  const AnyVertex v = VertexHandle<Vertex>{1, 1};
  EXPECT_NE(v, AnyVertex(VertexHandle<Edge>{1, 1}));
  EXPECT_NE(v, AnyVertex(VertexHandle<Vertex>{1, 2}));
  EXPECT_NE(v, AnyVertex(VertexHandle<Vertex>{2, 1}));
  EXPECT_EQ(v, AnyVertex(VertexHandle<Vertex>{1, 1}));
}

TEST(Handles, ReadAsTypeAndNumber) {
  const std::string text = ToString(VertexHandle<Vertex>{12, 3});
  EXPECT_NE(text.find("Vertex"), std::string::npos) << text;
  EXPECT_TRUE(text.ends_with(" #12")) << text;
  EXPECT_EQ(text, ToString(AnyVertex(VertexHandle<Vertex>{12, 3})));
  EXPECT_EQ(text.rfind("glissade::", 0), std::string::npos) << "our own namespace goes without";
}

}  // namespace
}  // namespace glissade
