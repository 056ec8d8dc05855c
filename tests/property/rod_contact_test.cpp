// Contact times of rods, as RodGap finds them in the fast engine, against conservative advancement (convex_flights.h).

#include <common/finder/convex_flights.h>

#include <contact/rods/gap.h>
#include <motion/checks.h>

#include <gtest/gtest.h>

namespace finder_test {
namespace {

using ed::internal::AxisMotion;
using ed::internal::Rod;
using ed::internal::RodGap;

/// Returns a sphere, or a capsule; some are long.
TestBody rod(Random& random) {
  if (random.uniform() < 0.2) return sphere(random);
  const double radius = random.uniform(0.2, 1);
  const double aspect = random.uniform() < 0.1 ? random.log_uniform(30, 5000) : random.log_uniform(0.1, 30);
  const geom::Capsule s(radius * aspect, radius);
  return test_body("rod", s, s.volume(), s.inertia(1), {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}});
}

TestBody spinless_rod(Random& random) {
  TestBody body = rod(random);
  body.spins = false;
  return body;
}

/// Two rods and their motions.
struct RodParts {
  explicit RodParts(const Flight& f)
      : rod_a(rod_of(f.shape_a.body)),
        rod_b(rod_of(f.shape_b.body)),
        motion_a(motion_of(f.shape_a, f.a)),
        motion_b(motion_of(f.shape_b, f.b)) {}

  static Rod rod_of(const ConvexBody& body) { return {body.bounding_radius - body.ball, body.ball}; }
  static AxisMotion motion_of(const TestBody& body, const RigidMotion& motion) {
    const ed::internal::TopState now = motion.top.at(0);
    return ed::internal::top_motion({geom::Pose(now.R, motion.position), motion.velocity, now.omega, body.inertia, 0},
                                    2)
        .axis;
  }

  Rod rod_a, rod_b;
  AxisMotion motion_a, motion_b;
};

/// The pair gap of an event loop of rods.
template <bool kSpin, bool kHalved = false>
class TestRodGap : private RodParts, public RodGap<kSpin> {
 public:
  explicit TestRodGap(const Flight& f)
      : RodParts(f), RodGap<kSpin>(rod_a, motion_a, rod_b, motion_b, f.b.position - f.a.position, 0) {
    if (kHalved) this->curvature_share_ = 0.5;
  }
};

TEST(RodContact, WithSpin) {
  expect_none_missed(search<TestRodGap<true>>("rods", rod, rod));
}
TEST(RodContact, WithoutSpin) {
  expect_none_missed(search<TestRodGap<false>>("rods without spin", spinless_rod, spinless_rod));
}
TEST(RodContact, IsMissedWithHalfTheCurvature) {
  const Tally tally = search<TestRodGap<true, true>>("rods, half the curvature", rod, rod);
  EXPECT_GT(tally.missed + tally.late, 0);
}
}  // namespace
}  // namespace finder_test
