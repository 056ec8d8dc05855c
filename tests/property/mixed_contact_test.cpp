// Contact times of an ellipsoid of revolution and a rod, as MixedGap finds them in the fast engine, against
// conservative advancement (convex_flights.h): prolate, oblate, needles, discs, balls; capsules from nearly round to
// thin ones.

#include <common/finder/convex_flights.h>

#include <contact/rods/spheroid_gap.h>
#include <motion/checks.h>

#include <gtest/gtest.h>

#include <cmath>
#include <variant>

namespace finder_test {
namespace {

using ed::internal::AxisMotion;
using ed::internal::MixedGap;
using ed::internal::Rod;
using geom::kernel::Spheroid;

TestBody spheroid(Random& random, double aspect) {
  const double b = random.uniform(0.2, 1) / std::max(1.0, std::sqrt(aspect));
  const geom::Ellipsoid s({b, b, aspect * b});
  const ConvexBody body{ed::BodyShape(s)};
  return {"ellipsoid", body, body, s.inertia(1), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}}};
}

TestBody any_spheroid(Random& random) {
  const double kind = random.uniform();
  if (kind < 0.1) return spheroid(random, 1);
  if (kind < 0.2) return spheroid(random, random.log_uniform(10, 100));
  if (kind < 0.3) return spheroid(random, random.log_uniform(0.01, 0.1));
  return spheroid(random, random.log_uniform(0.15, 8));
}

TestBody any_capsule(Random& random) {
  const double radius = random.uniform(0.2, 1);
  const double aspect = random.uniform() < 0.1 ? random.log_uniform(30, 1000) : random.log_uniform(0.01, 30);
  const geom::Capsule s(radius * aspect, radius);
  return test_body("rod", s, s.volume(), s.inertia(1), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

TestBody spinless(TestBody body) {
  body.spins = false;
  return body;
}

/// The two bodies and their motions.
struct MixedParts {
  explicit MixedParts(const Flight& f)
      : shape(shape_of(f.shape_a.body)),
        rod{f.shape_b.body.bounding_radius - f.shape_b.body.ball, f.shape_b.body.ball},
        motion_a(motion_of(f.shape_a, f.a)),
        motion_b(motion_of(f.shape_b, f.b)) {}

  static Spheroid shape_of(const ConvexBody& body) {
    const auto& axes = std::get<geom::Ellipsoid>(body.shape).semi_axes();
    return {axes.z(), axes.x()};
  }
  static AxisMotion motion_of(const TestBody& body, const RigidMotion& motion) {
    const ed::internal::TopState now = motion.top.at(0);
    return ed::internal::top_motion({geom::Pose(now.R, motion.position), motion.velocity, now.omega, body.inertia, 0},
                                    2)
        .axis;
  }

  Spheroid shape;
  Rod rod;
  AxisMotion motion_a, motion_b;
};

/// The pair gap of an event loop of ellipsoids and rods.
template <bool kSpin, bool kHalved = false>
class TestMixedGap : private MixedParts, public MixedGap<kSpin> {
 public:
  explicit TestMixedGap(const Flight& f)
      : MixedParts(f),
        MixedGap<kSpin>({shape, f.shape_a.body.bounding_radius, std::sqrt(std::min(shape.a2, shape.b2))}, motion_a, rod,
                        motion_b, f.b.position - f.a.position, 0) {
    if (kHalved) this->curvature_share_ = 0.5;
  }
};

TEST(MixedContact, WithSpin) {
  expect_none_missed(search<TestMixedGap<true>>("ellipsoids and rods", any_spheroid, any_capsule));
}
TEST(MixedContact, WithoutSpin) {
  expect_none_missed(search<TestMixedGap<false>>(
      "ellipsoids and rods without spin", [](Random& random) { return spinless(any_spheroid(random)); },
      [](Random& random) { return spinless(any_capsule(random)); }));
}
TEST(MixedContact, IsMissedWithHalfTheCurvature) {
  const Tally tally =
      search<TestMixedGap<true, true>>("ellipsoids and rods, half the curvature", any_spheroid, any_capsule);
  EXPECT_GT(tally.missed + tally.late, 0);
}

}  // namespace
}  // namespace finder_test
