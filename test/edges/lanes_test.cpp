// SPDX-FileCopyrightText: 2026 The glissade authors
// SPDX-License-Identifier: BSD-3-Clause
//
// What edges in packs may be made of, and which runs they may share.
#include "glissade/edges/lanes.h"

#include <gtest/gtest.h>

#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <span>
#include <string>
#include <string_view>

#include "glissade/base/matrix.h"
#include "glissade/base/small_matrix.h"
#include "glissade/edges/bal.h"
#include "glissade/edges/reprojection.h"
#include "glissade/edges/reprojection_stereo.h"
#include "glissade/edges/reprojection_xyz.h"
#include "glissade/edges/same_in_run.h"
#include "glissade/lie/pose.h"
#include "support/template_edges.h"

namespace glissade {
namespace {

struct Stamped {
  Vector2 uv;
  double stamp = 0.0;
  double weights[2][2] = {};
};
struct OfStamped {
  double first;
  Stamped all;
};
struct WithNumber {
  double a = 0.0;
  int b = 0;
};
struct OfWithNumber {
  Vector2 uv;
  WithNumber more;
};
struct WithTail {
  double a[3];
  bool valid;
};
struct OfView {
  double a;
  std::string_view name;
};
struct Named {
  double* data;
  Named() {}
};
enum class Kind : long long { kFirst };

TEST(Lanes, MembersThatAreNoDoublesAreRefused) {
  using internal::kMadeOfDoubles;
  static_assert(kMadeOfDoubles<double>);
  static_assert(kMadeOfDoubles<double[3]>);
  static_assert(kMadeOfDoubles<double[3][2]>);
  static_assert(kMadeOfDoubles<std::array<double, 4>>);
  static_assert(kMadeOfDoubles<Vector2>);
  static_assert(kMadeOfDoubles<Vector<1>>);
  static_assert(kMadeOfDoubles<Vector<9>>);
  static_assert(kMadeOfDoubles<Matrix6>);
  static_assert(kMadeOfDoubles<Matrix<2, 3>>);
  static_assert(kMadeOfDoubles<Vector2[2]>);
  static_assert(kMadeOfDoubles<Pose>);
  static_assert(kMadeOfDoubles<Vec<double, 3>>);
  static_assert(kMadeOfDoubles<Eigen::Vector4d>);
  static_assert(kMadeOfDoubles<Eigen::Quaterniond>);
  static_assert(kMadeOfDoubles<Stamped>);
  static_assert(kMadeOfDoubles<OfStamped>);

  static_assert(!kMadeOfDoubles<long long>);
  static_assert(!kMadeOfDoubles<std::size_t>);
  static_assert(!kMadeOfDoubles<int[2]>);
  static_assert(!kMadeOfDoubles<float[2]>);
  static_assert(!kMadeOfDoubles<long double>);
  static_assert(!kMadeOfDoubles<double*>);
  static_assert(!kMadeOfDoubles<Kind>);
  static_assert(!kMadeOfDoubles<std::array<float, 2>>);
  static_assert(!kMadeOfDoubles<Eigen::Vector2f>);
  static_assert(!kMadeOfDoubles<Eigen::Vector4f>);
  static_assert(!kMadeOfDoubles<Eigen::VectorXd>);
  static_assert(!kMadeOfDoubles<std::string>);
  static_assert(!kMadeOfDoubles<std::string_view>);
  static_assert(!kMadeOfDoubles<WithNumber>);
  static_assert(!kMadeOfDoubles<OfWithNumber>);
  static_assert(!kMadeOfDoubles<WithTail>);
  static_assert(!kMadeOfDoubles<OfView>);
  static_assert(!kMadeOfDoubles<Named>);
  static_assert(!kMadeOfDoubles<std::span<const double>>);
  static_assert(!kMadeOfDoubles<Eigen::Map<Eigen::Vector3d>>);
}

using test::OffsetInPacks;
using test::RangeInPacks;

struct Same : OffsetInPacks {};
struct SameOfSame : Same {};
/// A member that SameSensor does not compare: lane 0's would be taken for all.
struct Added : OffsetInPacks {
  double sigma = 1.0;
};
struct AddedOfEmpty : RangeInPacks {
  double sigma = 1.0;
};
struct AddedAndCompared : OffsetInPacks {
  double sigma = 1.0;
  [[nodiscard]] bool SameSensor(const AddedAndCompared& other) const noexcept {
    return OffsetInPacks::SameSensor(other) && sigma == other.sigma;
  }
};
struct AddedToThat : AddedAndCompared {
  double more = 1.0;
};
struct BesideTheBases : OffsetInPacks {
  using OffsetInPacks::SameSensor;
  double sigma = 1.0;
  [[nodiscard]] bool SameSensor(const BesideTheBases& other) const {
    return OffsetInPacks::SameSensor(other) && sigma == other.sigma;
  }
};
/// SameInRun is asked first.
struct ComparedByTheOtherName : EdgeReprojectionStereo {
  double sigma = 1.0;
  [[nodiscard]] bool SameSensor(const ComparedByTheOtherName& other) const {
    return EdgeReprojectionStereo::SameSensor(other) && sigma == other.sigma;
  }
};
/// In the padding of the base.
struct Padded : OffsetInPacks {
  int camera = 0;
  [[nodiscard]] bool SameSensor(const Padded& other) const { return camera == other.camera; }
};
struct AddedToPadding : Padded {
  int antenna = 0;
};
/// A base that asks what derives from it.
template <class E>
struct ByAntenna {
  int antenna = 0;
  [[nodiscard]] bool SameSensor(const E& other) const {
    return static_cast<const E&>(*this).antenna == other.antenna;
  }
};
struct OfAntenna : RangeInPacks, ByAntenna<OfAntenna> {};

TEST(Lanes, SameSensorOfABaseDoesNotKnowWhatAnEdgeAdds) {
  using internal::kKnowsWhatDiffers;
  static_assert(kEvaluatesInPacks<Added>);
  static_assert(!kKnowsWhatDiffers<Added>);
  static_assert(!kKnowsWhatDiffers<AddedOfEmpty>);
  static_assert(!kKnowsWhatDiffers<AddedToThat>);
  static_assert(!kKnowsWhatDiffers<ComparedByTheOtherName>);
  static_assert(!kKnowsWhatDiffers<AddedToPadding>);

  static_assert(kKnowsWhatDiffers<RangeInPacks>);
  static_assert(kKnowsWhatDiffers<OffsetInPacks>);
  static_assert(kKnowsWhatDiffers<Same>);
  static_assert(kKnowsWhatDiffers<SameOfSame>);
  static_assert(kKnowsWhatDiffers<AddedAndCompared>);
  static_assert(kKnowsWhatDiffers<BesideTheBases>);
  static_assert(kKnowsWhatDiffers<Padded>);
  static_assert(kKnowsWhatDiffers<OfAntenna>);
  static_assert(kKnowsWhatDiffers<EdgeBal>);
  static_assert(kKnowsWhatDiffers<EdgeReprojection>);
  static_assert(kKnowsWhatDiffers<EdgeReprojectionXYZ>);
  static_assert(kKnowsWhatDiffers<EdgeReprojectionStereo>);
}

}  // namespace
}  // namespace glissade
