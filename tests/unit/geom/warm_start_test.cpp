/// Warm starts of shapes given by support function alone: calls of support functions against those of a cold start.

#include "common/geom/counted.h"
#include "common/geom/random.h"
#include "common/geom/shapes.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstddef>
#include <string>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::CountedBody;
using geom_test::PairOfPoses;
using geom_test::PlainBox;
using geom_test::PlainFrustum;
using geom_test::PlainRounded;
using geom_test::poses_apart;
using geom_test::Random;
using geom_test::repetitions;
using geom_test::Spherocylinder;
using geom_test::WrappedEllipsoid;

struct Kind {
  std::string name;
  CountedBody body;
};

std::array<Kind, 6> kinds() {
  return {Kind{"capsule", CountedBody(Spherocylinder{1, 0.5})},
          Kind{"box", CountedBody(PlainBox{{1, 0.7, 0.5}})},
          Kind{"cylinder", CountedBody(PlainFrustum{0.8, 0.5, 0.5})},
          Kind{"cone", CountedBody(PlainFrustum{0.6, 0.7, 0})},
          Kind{"rounded box", CountedBody(PlainRounded<PlainBox>{{{0.9, 0.6, 0.4}}, 0.1})},
          Kind{"ellipsoid", CountedBody(WrappedEllipsoid{Ellipsoid({1, 0.7, 0.5})})}};
}

long take_calls(const CountedBody& body) {
  return body.take_calls();
}
long take_calls(const Ellipsoid& /*body*/) {
  return 0;
}

/// Normals that warm starts are from: of the pair itself, and of the pair moved and turned by these fractions of a
/// unit.
constexpr std::array kMoves = {0.0, 1e-6, 1e-3, 0.03};

/// Returns the normal of the pair with B moved, bodies apart.
template <class Other>
Vector3d normal_of_moved(const CountedBody& a, const Other& b, const PairOfPoses& pair, double move, Random& random) {
  while (true) {
    const Eigen::Matrix3d turned = Eigen::AngleAxisd(move, random.direction()).toRotationMatrix();
    const Pose X_WB(turned * pair.X_WB.rotation(), pair.X_WB.position() + move * random.direction());
    const DistanceResult d = distance(a, pair.X_WA, b, X_WB, {.penetration = Penetration::local});
    if (d.distance > 0) return d.normal;
  }
}

/// Checks that warm starts need no more calls than cold ones in the mean, and have the same answer.
template <class Other>
void check_calls(const CountedBody& a, const Other& b) {
  const double size = a.bounding_radius() + b.bounding_radius();
  const int pairs = repetitions(100);
  long cold = 0;
  std::array<long, kMoves.size()> warm{};
  Random random(1);
  for (int i = 0; i < pairs; ++i) {
    const double gap = random.log_uniform(1e-6, 1);
    const PairOfPoses pair = poses_apart(a, b, gap, false, random);
    const auto calls_of = [&](const Vector3d& start, DistanceResult& d) {
      (void)(take_calls(a) + take_calls(b));
      d = distance(a, pair.X_WA, b, pair.X_WB, {.start = start});
      const long calls = take_calls(a) + take_calls(b);
      EXPECT_LE(std::abs(d.distance - gap), 2 * kWidestGap * (2 * size + gap)) << "pair " << i;
      EXPECT_LE(d.error_bound, kWidestGap * (2 * size + gap)) << "pair " << i;
      return calls;
    };
    DistanceResult first, d;
    cold += calls_of(Vector3d::Zero(), first);
    for (std::size_t k = 0; k < kMoves.size(); ++k) {
      const Vector3d start = k == 0 ? first.normal : normal_of_moved(a, b, pair, kMoves[k], random);
      warm[k] += calls_of(start, d);
    }
  }
  for (std::size_t k = 0; k < kMoves.size(); ++k) {
    EXPECT_LE(warm[k], cold) << "sums over " << pairs << " pairs; start from the pair moved by " << kMoves[k];
  }
}

TEST(WarmStart, NeedsNoMoreCallsThanAColdOne) {
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    check_calls(kind.body, kind.body);
  }
}

TEST(WarmStart, NeedsNoMoreCallsThanAColdOneBesideAnEllipsoid) {
  for (const Kind& kind : kinds()) {
    SCOPED_TRACE(kind.name);
    check_calls(kind.body, Ellipsoid({1, 0.6, 0.4}));
  }
}

}  // namespace
}  // namespace geom
