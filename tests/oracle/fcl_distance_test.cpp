/// distance() against FCL: where they disagree by more than FCL's tolerance, a certificate says who is wrong.

#include "common/finder/scale.h"
#include "common/forked.h"
#include "common/geom/manufactured.h"
#include "oracle/fcl_raw.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <cstdio>

namespace geom {
namespace {

using Eigen::Vector3d;
using finder_test::scaled;
using geom_test::fcl_distance;
using geom_test::FclDistance;
using geom_test::lower_bound;
using geom_test::ManufacturedPair;
using geom_test::Random;

// What FCL's distance_tolerance promises, an absolute length.
constexpr double kFclTolerance = 1e-6;

struct Comparison {
  int pairs = 0;
  int agree = 0;       ///< pairs that agree within kFclTolerance
  int fcl_far = 0;     ///< FCL's distance is too large: our points are on the surfaces, and closer
  int fcl_near = 0;    ///< FCL's distance is too small: g(n) is larger, a lower bound of the distance
  int fcl_no_gap = 0;  ///< FCL takes the pair for overlapping: g(n) > 0 proves it is not
  int fcl_threw = 0;
  int undecided = 0;  ///< neither: ours might be wrong
  double max_disagreement = 0;
};

/// All shapes: spheroids from discs to needles, and three different axes.
Ellipsoid any_shape(Random& random) {
  return random.coin() ? random.spheroid(random.log_uniform(0.01, 100)) : random.biaxial(10);
}

/// Rounding of the points and heights involved.
double rounding(const ManufacturedPair& pair) {
  return 1e-13 * (pair.size + pair.X_WA.position().norm());
}

/// Returns the distance of `point` from the surface, to first order in f.
double offset(const Ellipsoid& shape, const Pose& X, const Vector3d& point) {
  const Vector3d x = X.to_body(point);
  return std::abs(shape.value(x)) / shape.gradient(x).norm();
}

void judge(const Ellipsoid& a, const Ellipsoid& b, const ManufacturedPair& pair, const DistanceResult& ours,
           const FclDistance& fcl, Comparison& out) {
  ++out.pairs;
  if (fcl.outcome == FclDistance::Outcome::threw) {
    ++out.fcl_threw;
    return;
  }
  const double difference = fcl.distance - ours.distance;
  if (std::abs(difference) <= kFclTolerance) {
    ++out.agree;
    return;
  }
  const double certain = lower_bound(a, pair.X_WA, b, pair.X_WB, ours.normal) - rounding(pair);
  const double claimed = (ours.point_b - ours.point_a).norm() + offset(a, pair.X_WA, ours.point_a) +
                         offset(b, pair.X_WB, ours.point_b) + rounding(pair);
  if (fcl.distance < 0 && certain > 0) {
    ++out.fcl_no_gap;
  } else if (fcl.distance >= 0 && certain > fcl.distance) {
    ++out.fcl_near;
  } else if (claimed < fcl.distance) {
    ++out.fcl_far;
  } else {
    ++out.undecided;
    return;
  }
  out.max_disagreement = std::max(out.max_disagreement, std::abs(difference));
}

void print(const char* name, const Comparison& c, int aborts) {
  std::printf(
      "%s: %d pairs, %d agree within %g; FCL wrong, certified: %d too far, %d too near, %d taken for overlapping "
      "(by up to %.1e); %d threw, %d aborts, %d undecided\n",
      name, c.pairs, c.agree, kFclTolerance, c.fcl_far, c.fcl_near, c.fcl_no_gap, c.max_disagreement, c.fcl_threw,
      aborts, c.undecided);
}

TEST(FclOracle, SeparatedPairsAgreeOrFclIsWrong) {
  Comparison comparison;
  const int pairs = scaled(20'000, 200'000);
  const int aborts = geom_test::run_forked(pairs, comparison, [](int i, Comparison& record) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    const Ellipsoid a = any_shape(random);
    const Ellipsoid b = any_shape(random);
    const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-5, 10), random);
    const DistanceResult ours = distance(a, pair.X_WA, b, pair.X_WB);
    if (ours.status != DistanceStatus::separated) {
      ++record.undecided;
      return;
    }
    judge(a, b, pair, ours, fcl_distance(a, pair.X_WA, b, pair.X_WB, /*signed_distance=*/false), record);
  });
  print("separated", comparison, aborts);
  EXPECT_EQ(comparison.undecided, 0);
  EXPECT_EQ(comparison.pairs, pairs - aborts);
  EXPECT_GE(comparison.agree, 0.3 * pairs) << "an oracle that never agrees is none";
  EXPECT_LE(aborts, pairs / 100);
  EXPECT_LE(comparison.max_disagreement, 1e-2);
}

struct Depths {
  int pairs = 0;
  int agree = 0;
  int fcl_shallow = 0;  ///< a shift by FCL's depth along its normal does not part the bodies
  int fcl_deep = 0;     ///< a shift by less parts them, along our normal
  int fcl_apart = 0;    ///< FCL takes them for separated; the support points along our normal say how deep they overlap
  int fcl_threw = 0;
  int undecided = 0;
  double max_disagreement = 0;
};

/// d = max g(n): each g(n) is a shift along n that parts the bodies, the largest is the shortest of them.
void judge_depth(const Ellipsoid& a, const Ellipsoid& b, const ManufacturedPair& pair, const DistanceResult& ours,
                 const FclDistance& fcl, Depths& out) {
  ++out.pairs;
  if (fcl.outcome == FclDistance::Outcome::threw) {
    ++out.fcl_threw;
    return;
  }
  const double difference = fcl.distance - ours.distance;
  if (std::abs(difference) <= kFclTolerance) {
    ++out.agree;
    return;
  }
  const Vector3d n_fcl = (fcl.point_a - fcl.point_b).normalized();
  if (fcl.distance > 0) {
    // A point on the segment between our witness points lies inside both bodies.
    const Vector3d middle = 0.5 * (ours.point_a + ours.point_b);
    const bool inside = a.value(pair.X_WA.to_body(middle)) < 0 && b.value(pair.X_WB.to_body(middle)) < 0;
    ++(inside ? out.fcl_apart : out.undecided);
  } else if (difference < 0) {
    const bool parts = lower_bound(a, pair.X_WA, b, pair.X_WB, ours.normal) > fcl.distance + rounding(pair);
    ++(parts ? out.fcl_deep : out.undecided);
  } else {
    const bool stuck = lower_bound(a, pair.X_WA, b, pair.X_WB, n_fcl) < fcl.distance - rounding(pair);
    ++(stuck ? out.fcl_shallow : out.undecided);
  }
  out.max_disagreement = std::max(out.max_disagreement, std::abs(difference));
}

TEST(FclOracle, OverlapsAgreeOrFclIsWrong) {
  Depths depths;
  const int pairs = scaled(5'000, 50'000);
  const int aborts = geom_test::run_forked(pairs, depths, [](int i, Depths& record) {
    Random random(static_cast<std::uint64_t>(i) + 1);
    const Ellipsoid a = random.spheroid(random.log_uniform(0.2, 5));
    const Ellipsoid b = random.biaxial(5);
    const double rho = a.min_curvature_radius() + b.min_curvature_radius();
    const ManufacturedPair pair = geom_test::manufacture(a, b, -rho * random.log_uniform(1e-8, 0.9), random);
    const DistanceResult ours = distance(a, pair.X_WA, b, pair.X_WB);
    if (ours.status != DistanceStatus::overlapping) {
      ++record.undecided;
      return;
    }
    judge_depth(a, b, pair, ours, fcl_distance(a, pair.X_WA, b, pair.X_WB, /*signed_distance=*/true), record);
  });
  std::printf(
      "overlapping: %d pairs, %d agree within %g; FCL wrong, certified: %d too deep, %d too shallow, %d taken for "
      "separated (by up to %.1e); %d threw, %d aborts, %d undecided\n",
      depths.pairs, depths.agree, kFclTolerance, depths.fcl_deep, depths.fcl_shallow, depths.fcl_apart,
      depths.max_disagreement, depths.fcl_threw, aborts, depths.undecided);
  EXPECT_EQ(depths.undecided, 0);
  EXPECT_EQ(depths.pairs, pairs - aborts);
  EXPECT_GE(depths.agree, 0.8 * pairs);
  EXPECT_LE(aborts, pairs / 100);
  EXPECT_LE(depths.max_disagreement, 1e-2);
}

}  // namespace
}  // namespace geom
