// Envelopes: a body never leaves its envelope before exit_time says so, and no pair that could touch is kept
// out of the lists. Both are sampled against the definition; that the samples would see a wrong bound is tested too.

#include "base/periodic.h"
#include "motion/axis_motion.h"
#include "neighbours/cell.h"
#include "neighbours/dilated.h"
#include "neighbours/oriented.h"

#include <common/ed_states.h>
#include <common/finder_ensemble.h>

#include <ed/random.h>

#include <geom/distance.h>
#include <geom/kernel/uniaxial.h>

#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

using ed::internal::AxisMotion;
using ed::internal::BodyFrame;
using CellEnvelopes = ed::internal::CellEnvelopes<ed::internal::UniaxialBodies>;
using ed::internal::DilatedEnvelopes;
using ed::internal::OrientedEnvelopes;
using ed::internal::UniaxialInertia;
using Eigen::Vector3d;
using finder_test::log_uniform;

struct Shape {
  double a;  // along the axis
  double b;
  geom::kernel::Spheroid spheroid() const { return {a, b}; }
  double difference() const { return std::abs(a - b); }
  double bounding_radius() const { return std::max(a, b); }
  double support(const Vector3d& u, const Vector3d& n) const {
    const double x = u.dot(n);
    return std::sqrt(b * b * (n - x * u).squaredNorm() + a * a * x * x);
  }
};

DilatedEnvelopes envelopes(const Shape& shape, double thickness, double exit_thickness) {
  return {2, shape.spheroid(), shape.difference(), shape.bounding_radius(), thickness, exit_thickness};
}

AxisMotion random_motion(ed::Random& random, const UniaxialInertia& inertia) {
  AxisMotion motion;
  BodyFrame frame;
  motion.time = 0;
  motion.position = random.normal3();
  motion.velocity = log_uniform(random, 1e-3, 3) * random.direction();
  const Vector3d u = random.direction();
  frame.x_axis = u.unitOrthogonal();
  frame.spin = inertia.spins ? random.normal() : 0;
  Vector3d omega = log_uniform(random, 1e-2, 10) * random.direction();
  omega -= omega.dot(u) * u;
  set_rotation(inertia, u, omega, motion, frame);
  return motion;
}

/// A body at the origin whose axis x turns towards y at `rate`.
AxisMotion simple_motion(const Vector3d& velocity, double rate) {
  AxisMotion motion;
  motion.time = 0;
  motion.position.setZero();
  motion.velocity = velocity;
  motion.e0.setZero();
  motion.e1 = Vector3d::UnitX();
  motion.e2 = Vector3d::UnitY();
  motion.rate = rate;
  return motion;
}

Vector3d axis_at(const AxisMotion& motion, double t) {
  const double angle = motion.rate * (t - motion.time);
  return motion.e0 + std::cos(angle) * motion.e1 + std::sin(angle) * motion.e2;
}

/// Returns how far the body at (r, u) reaches beyond the body at (r0, u0), along the worst of all directions: by
/// sampling, a little below the truth.
double reach_beyond(const Shape& shape, const Vector3d& r, const Vector3d& u, const Vector3d& r0, const Vector3d& u0) {
  double worst = -1e300;
  Vector3d best = Vector3d::UnitX();
  const auto beyond = [&](const Vector3d& n) { return n.dot(r - r0) + shape.support(u, n) - shape.support(u0, n); };
  ed::Random random(1);
  const auto look = [&](const Vector3d& n) {
    const double value = beyond(n);
    if (value > worst) {
      worst = value;
      best = n;
    }
  };
  for (int k = 0; k < 60; ++k) look(random.direction());
  for (double step = 0.3; step > 1e-5; step *= 0.7) {
    for (int k = 0; k < 4; ++k) look((best + step * random.direction()).normalized());
  }
  return worst;
}

/// Largest reach beyond the envelope, minus its thickness, in a share of the time up to the exit bound.
struct Exits {
  int trials = 0;
  int finite = 0;
  double worst = -1e300;     // up to exit_time: must not be positive
  int outside_at_twice = 0;  // how many bodies are outside, at some time, if exit_time were twice as long
};

Exits sample_exits(const Shape& shape, bool spins, std::uint64_t seed) {
  const UniaxialInertia inertia{1, 0.4, 0.3, spins};
  ed::Random random(seed);
  Exits exits;
  for (int trial = 0; trial < 150; ++trial) {
    const double exit_thickness = log_uniform(random, 0.03, 1);
    DilatedEnvelopes envelope = envelopes(shape, 1.25 * exit_thickness, exit_thickness);
    const AxisMotion motion = random_motion(random, inertia);
    constexpr double kBox = 100;
    // Placed where the body was some time ago, in another image of the box; looked at since.
    const double ago = random.uniform() * 0.5 * exit_thickness / (motion.velocity.norm() + shape.difference() * 10);
    const Vector3d r0 = motion.position - ago * motion.velocity;
    const Vector3d u0 = axis_at(motion, -ago);
    const bool wrapped = random.uniform() < 0.3;
    envelope.place(0, r0 + Vector3d(wrapped ? kBox : 0, 0, 0), u0);
    const double exit = envelope.exit_time(0, motion, motion.position, motion.axis(), 0, kBox);
    EXPECT_GE(exit, 0);
    ++exits.trials;
    if (!(exit < 1e6)) continue;
    ++exits.finite;
    const auto outside = [&](double t) {
      return reach_beyond(shape, motion.position_at(t), axis_at(motion, t), r0, u0) - exit_thickness;
    };
    constexpr int kTimes = 8;
    for (int k = 1; k <= kTimes; ++k) exits.worst = std::max(exits.worst, outside(exit * k / kTimes));
    bool late = false;
    for (int k = 1; k <= kTimes; ++k) late = late || outside(exit * (1 + 1.0 * k / kTimes)) > 0;
    exits.outside_at_twice += late ? 1 : 0;
  }
  return exits;
}

TEST(ExitTime, IsNeverLaterThanTheTrueExit) {
  std::uint64_t seed = 1;
  for (const Shape& shape : {Shape{1, 1}, Shape{3, 1}, Shape{1, 3}, Shape{5, 0.8}, Shape{0.2, 2}}) {
    for (const bool spins : {false, true}) {
      const Exits exits = sample_exits(shape, spins, ++seed);
      std::printf("a = %.1f, b = %.1f, %s: outside by %.1e at most; %d of %d outside at twice the time\n", shape.a,
                  shape.b, spins ? "spin" : "no spin", exits.worst, exits.outside_at_twice, exits.finite);
      // Rounding of positions of order 1.
      EXPECT_LE(exits.worst, 1e-13);
      EXPECT_GT(exits.finite, exits.trials / 2);
      // The bound is tight enough to be worth testing: most bodies are outside at twice the time.
      EXPECT_GT(exits.outside_at_twice, exits.finite * 3 / 4);
    }
  }
}

TEST(ExitTime, OfSpheresIsExact) {
  const Shape sphere{1, 1};
  DilatedEnvelopes envelope = envelopes(sphere, 0.5, 0.5);
  const AxisMotion motion = simple_motion({0, 2, 0}, 7);
  envelope.place(0, Vector3d(0, -0.25, 0), motion.axis());
  EXPECT_NEAR(envelope.exit_time(0, motion, Vector3d::Zero(), motion.axis(), 3, 100), 3 + 0.125, 1e-15);
}

TEST(ExitTime, OfABodyThatRestsIsNever) {
  const AxisMotion motion = simple_motion(Vector3d::Zero(), 0);
  DilatedEnvelopes envelope = envelopes({3, 1}, 0.5, 0.5);
  envelope.place(0, Vector3d::Zero(), motion.axis());
  EXPECT_EQ(envelope.exit_time(0, motion, Vector3d::Zero(), motion.axis(), 3, 100), ed::internal::kNever);
}

TEST(ExitTime, IsNowForABodyThatIsOutside) {
  const AxisMotion motion = simple_motion({0, 0, -1}, 0);
  DilatedEnvelopes envelope = envelopes({3, 1}, 0.5, 0.4);
  envelope.place(0, Vector3d::Zero(), motion.axis());
  EXPECT_EQ(envelope.exit_time(0, motion, Vector3d(0, 0, 0.45), motion.axis(), 3, 100), 3);
  EXPECT_EQ(envelope.exit_time(0, motion, Vector3d::Zero(), Vector3d::UnitY(), 3, 100), 3);
}

TEST(AngleBound, IsAboveTheAngleAndClose) {
  for (int k = 0; k <= 3000; ++k) {
    const double angle = 3.1415926 * k / 3000;
    const double chord = 2 * std::sin(0.5 * angle);
    const double bound = ed::internal::angle_bound(chord);
    ASSERT_GE(bound, angle * (1 - 1e-15));
    if (chord < 1) {
      ASSERT_LE(bound, angle + 0.01 * angle * angle * angle);
    }
  }
}

/// Two bodies whose surfaces are `gap` apart, apart along a random direction: chosen normal, support points, offset.
struct PlacedPair {
  Vector3d r;  // from i to k
  Vector3d u_i;
  Vector3d u_k;
};

PlacedPair place_pair(const Shape& shape, double gap, ed::Random& random) {
  const Vector3d n = random.direction();
  PlacedPair pair{Vector3d::Zero(), random.direction(), random.direction()};
  const auto support_point = [&](const Vector3d& u, const Vector3d& m) {
    const double x = u.dot(m);
    return Vector3d((shape.b * shape.b * (m - x * u) + shape.a * shape.a * x * u) / shape.support(u, m));
  };
  pair.r = support_point(pair.u_i, n) + gap * n - support_point(pair.u_k, -n);
  return pair;
}

TEST(MayMeet, NeverRejectsAPairCloserThanTwiceTheThickness) {
  ed::Random random(31);
  for (const Shape& shape : {Shape{1, 1}, Shape{3, 1}, Shape{1, 3}, Shape{8, 0.8}, Shape{0.2, 2}, Shape{0.1, 1}}) {
    int taken = 0;
    for (int trial = 0; trial < 20000; ++trial) {
      const double delta = log_uniform(random, 0.01, 1);
      // Half of them at the very edge, where the decision is hardest.
      const double share = trial % 2 == 0 ? random.uniform() : 1 - log_uniform(random, 1e-12, 1e-2);
      const PlacedPair pair = place_pair(shape, 2 * delta * share, random);
      DilatedEnvelopes envelope = envelopes(shape, delta, delta);
      envelope.place(0, Vector3d::Zero(), pair.u_i);
      envelope.place(1, pair.r, pair.u_k);
      Vector3d normal = Vector3d::Zero();
      ASSERT_TRUE(envelope.may_overlap(0, 1, pair.r, normal))
          << "a = " << shape.a << ", b = " << shape.b << ", delta = " << delta << ", share = " << share;
      ASSERT_NEAR(normal.norm(), 1, 1e-10);
      ++taken;
    }
    EXPECT_EQ(taken, 20000);
  }
}

TEST(MayMeet, TakesOverlappingPairs) {
  ed::Random random(32);
  for (const Shape& shape : {Shape{3, 1}, Shape{1, 3}, Shape{0.2, 2}}) {
    for (int trial = 0; trial < 2000; ++trial) {
      const PlacedPair pair = place_pair(shape, -0.5 * random.uniform() * std::min(shape.a, shape.b), random);
      DilatedEnvelopes envelope = envelopes(shape, 0.1, 0.1);
      envelope.place(0, Vector3d::Zero(), pair.u_i);
      envelope.place(1, pair.r, pair.u_k);
      Vector3d normal = Vector3d::Zero();
      ASSERT_TRUE(envelope.may_overlap(0, 1, pair.r, normal));
    }
  }
}

TEST(MayMeet, RejectsNearlyAllPairsThatCannot) {
  ed::Random random(33);
  for (const Shape& shape : {Shape{1, 1}, Shape{3, 1}, Shape{1, 3}}) {
    int rejected = 0;
    constexpr int kPairs = 4000;
    for (int trial = 0; trial < kPairs; ++trial) {
      const double delta = 0.2;
      const PlacedPair pair = place_pair(shape, 2 * delta * 1.02, random);
      DilatedEnvelopes envelope = envelopes(shape, delta, delta);
      envelope.place(0, Vector3d::Zero(), pair.u_i);
      envelope.place(1, pair.r, pair.u_k);
      Vector3d normal = Vector3d::Zero();
      rejected += envelope.may_overlap(0, 1, pair.r, normal) ? 0 : 1;
    }
    // Two Newton steps decide nearly all pairs 2 % beyond the limit: else lists would be too long, and this test's
    // counterpart above would prove little.
    EXPECT_GT(rejected, kPairs * 95 / 100) << "a = " << shape.a;
  }
}

TEST(Envelopes, ThickestAndThinnestFitTheBox) {
  const double R = 1.7;
  const double box = ed::internal::smallest_image_box(R);
  // In the smallest box the thickest envelope allowed is the thinnest in use.
  EXPECT_NEAR(ed::internal::thickest_envelope(box, R), ed::internal::kThinnestEnvelope * R, 1e-15);
  // Centres of neighbours are within 2 R + 4 delta, which is half the box.
  const double delta = ed::internal::thickest_envelope(20, R);
  EXPECT_NEAR(2 * R + 4 * delta, 10, 1e-14);
  // What a shrinking box may eat up: all pairs outside the lists stay 2 delta_exit apart.
  const DilatedEnvelopes envelope = envelopes({1.7, 1}, 0.5, 0.4);
  const double scale = envelope.least_scale();
  for (const double h : {2.0, 2.7, 3.4}) {
    const double gap = 2 * envelope.thickness();
    EXPECT_GE(scale * (gap + h) - h, 2 * envelope.exit_thickness() - 1e-14);
  }
}

// ---- The paper's boxes and cells ------------------------------------------------------------------------------------

/// Returns by how much the body at (r, u) reaches beyond the box: exact, from the support function along the faces'
/// normals.
double beyond_box(const Shape& shape, const geom::OrientedBox& box, const Vector3d& r, const Vector3d& u) {
  double worst = -1e300;
  for (int k = 0; k < 3; ++k) {
    const Vector3d n = box.axes.col(k);
    const double reach = std::abs(n.dot(r - box.centre)) + shape.support(u, n);
    worst = std::max(worst, reach - box.half_extents[k]);
  }
  return worst;
}

/// Follows a body by its exit bounds, renewed as the event loop does, until it is about to leave: the sum of the
/// bounds.
double follow_to_the_exit(const OrientedEnvelopes& envelopes, const AxisMotion& motion, double& worst,
                          const Shape& shape) {
  double now = 0;
  for (int look = 0; look < 5000; ++look) {
    const double exit = envelopes.exit_time(0, motion, motion.position_at(now), now, 1000);
    for (int k = 0; k <= 10; ++k) {
      const double t = now + (exit - now) * k / 10;
      worst = std::max(worst, beyond_box(shape, envelopes.box(0), motion.position_at(t), axis_at(motion, t)));
    }
    if (exit - now < envelopes.worthwhile(0, motion)) return exit;
    now = exit;
  }
  ADD_FAILURE() << "the exit is never reached";
  return now;
}

TEST(OrientedEnvelopes, ExitIsNeverLateAndHardlyEarly) {
  ed::Random random(51);
  for (const Shape& shape : {Shape{1, 1}, Shape{3, 1}, Shape{1, 3}, Shape{5, 0.8}, Shape{0.2, 2}}) {
    for (const bool spins : {false, true}) {
      double worst = -1e300;
      int outside_soon = 0;
      constexpr int kTrials = 200;
      for (int trial = 0; trial < kTrials; ++trial) {
        const double delta = log_uniform(random, 0.03, 1);
        OrientedEnvelopes envelopes(1, shape.spheroid(), shape.bounding_radius(), delta, spins);
        const AxisMotion motion = random_motion(random, {1, 0.4, 0.3, spins});
        envelopes.place(0, motion.position, motion.axis(), motion.axis().unitOrthogonal());
        const double exit = follow_to_the_exit(envelopes, motion, worst, shape);
        // A body may brush a face and turn away again; most are outside some time later.
        bool out = false;
        for (int k = 1; k <= 200; ++k) {
          const double t = exit + envelopes.worthwhile(0, motion) * 5 * k / 200;
          out = out || beyond_box(shape, envelopes.box(0), motion.position_at(t), axis_at(motion, t)) > 0;
        }
        outside_soon += out ? 1 : 0;
      }
      std::printf("box of a = %.1f, b = %.1f, %s: outside by %.1e at most; %d of %d outside soon after\n", shape.a,
                  shape.b, spins ? "spin" : "no spin", worst, outside_soon, kTrials);
      EXPECT_LE(worst, 1e-12);
      EXPECT_GT(outside_soon, kTrials * 3 / 4);
    }
  }
}

TEST(OrientedEnvelopes, ABodyOutsideHasLeft) {
  OrientedEnvelopes envelopes(1, Shape{3, 1}.spheroid(), 3, 0.5, false);
  envelopes.place(0, Vector3d::Zero(), Vector3d::UnitX(), Vector3d::UnitY());
  AxisMotion motion = simple_motion(Vector3d::Zero(), 0);
  EXPECT_EQ(envelopes.exit_time(0, motion, Vector3d(0.6, 0, 0), 2, 100), 2);
  EXPECT_EQ(envelopes.exit_time(0, motion, Vector3d(100.6, 0, 0), 2, 100), 2);
  EXPECT_GT(envelopes.exit_time(0, motion, Vector3d(0.4, 0, 0), 2, 100), 1e100);  // it rests
}

/// Bodies that touch while each is in its box must be neighbours, also in a periodic box that is as small as allowed.
TEST(OrientedEnvelopes, BodiesThatTouchAreNeighbours) {
  ed::Random random(52);
  for (const Shape& shape : {Shape{1, 1}, Shape{3, 1}, Shape{1, 3}, Shape{8, 0.8}, Shape{0.2, 2}}) {
    int tested = 0;
    for (int trial = 0; trial < 40000; ++trial) {
      const double delta = log_uniform(random, 0.01, 1);
      OrientedEnvelopes envelopes(2, shape.spheroid(), shape.bounding_radius(), delta, false);
      const PlacedPair pair = place_pair(shape, 0, random);
      const Vector3d d_i = delta * random.uniform() * random.direction();
      const Vector3d d_k = delta * random.uniform() * random.direction();
      const auto turned = [&](const Vector3d& u) {
        return Vector3d((u + 0.5 * delta / shape.bounding_radius() * random.direction()).normalized());
      };
      const Vector3d u_i = turned(pair.u_i);
      const Vector3d u_k = turned(pair.u_k);
      envelopes.place(0, d_i, u_i, u_i.unitOrthogonal());
      envelopes.place(1, pair.r + d_k, u_k, u_k.unitOrthogonal());
      if (beyond_box(shape, envelopes.box(0), Vector3d::Zero(), pair.u_i) > 0) continue;
      if (beyond_box(shape, envelopes.box(1), pair.r, pair.u_k) > 0) continue;
      ++tested;
      Vector3d normal = Vector3d::Zero();
      const Vector3d r = pair.r + d_k - d_i;
      ASSERT_TRUE(envelopes.may_overlap(0, 1, r, normal));
      ASSERT_LE(r.norm(), envelopes.reach());
      ASSERT_NEAR(normal.norm(), 1, 1e-10);
    }
    EXPECT_GT(tested, 2000) << "a = " << shape.a;
  }
}

TEST(OrientedEnvelopes, ThickestLeavesNearestImagesSafe) {
  ed::Random random(53);
  for (const Shape& shape : {Shape{1, 1}, Shape{3, 1}, Shape{1, 3}, Shape{5, 0.8}, Shape{0.2, 2}}) {
    const double R = shape.bounding_radius();
    for (const double box : {ed::internal::smallest_image_box(R), 6 * R}) {
      const double delta = ed::internal::thickest_oriented_envelope(shape.spheroid(), R, box);
      ASSERT_GT(delta, 0);
      // No place inside its box takes a body's centre further than an eighth of what the periodic box leaves.
      OrientedEnvelopes envelopes(1, shape.spheroid(), R, delta, false);
      envelopes.place(0, Vector3d::Zero(), Vector3d::UnitZ(), Vector3d::UnitX());
      double furthest = 0;
      for (int trial = 0; trial < 100000; ++trial) {
        const Vector3d u = (Vector3d::UnitZ() + random.uniform() * random.direction()).normalized();
        const Vector3d r = 3 * delta * random.uniform() * random.direction();
        if (beyond_box(shape, envelopes.box(0), r, u) <= 0) furthest = std::max(furthest, r.norm());
      }
      EXPECT_GT(furthest, 0);
      EXPECT_LE(2 * R + 4 * furthest, 0.5 * box * (1 + 1e-12)) << "a = " << shape.a << ", box = " << box;
    }
  }
}

TEST(CellEnvelopes, ExitIsTheCrossingOfTheFirstFace) {
  ed::Random random(54);
  constexpr double kBox = 10;
  CellEnvelopes cells(1, kBox, 1.1);  // four cells of 2.5
  AxisMotion motion = simple_motion(Vector3d::Zero(), 0);
  for (int trial = 0; trial < 20000; ++trial) {
    motion.position = kBox * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
    motion.velocity = random.normal3();
    cells.place(0, motion.position);
    const double exit = cells.exit_time(0, motion.position, motion.velocity, 0, kBox);
    ASSERT_GE(exit, 0);
    const auto cell = [&](double t) { return Vector3d((motion.position_at(t) / 2.5).array().floor().matrix()); };
    // The face itself is met 2.5e-10 earlier, in length.
    EXPECT_EQ(cell(std::max(0.0, exit - 1e-7)), cell(0));
    // Just beyond the face: a new envelope is that of the next cell, which is not left at once.
    EXPECT_NE(cell(exit), cell(0));
    cells.place(0, motion.position_at(exit));
    const double next = cells.exit_time(0, motion.position_at(exit), motion.velocity, exit, kBox);
    EXPECT_GT(next - exit, cells.worthwhile(motion.velocity));
  }
}

/// Three or four cells along an edge: the nearest image of a neighbour may be the wrong one.
TEST(CellEnvelopes, BodiesThatTouchAreNeighboursInTheImageThatTouches) {
  ed::Random random(55);
  for (const double box : {6.1, 8.3, 12.0, 30.0}) {
    CellEnvelopes cells(2, box, 1);
    for (int trial = 0; trial < 20000; ++trial) {
      const Vector3d r_i = box * Vector3d(random.uniform() - 0.5, random.uniform() - 0.5, random.uniform() - 0.5);
      const Vector3d d = 2 * random.uniform() * random.direction();
      const Vector3d r_k = ed::internal::nearest_image(r_i + d, box);
      cells.place(0, r_i);
      cells.place(1, r_k);
      Vector3d normal;
      ASSERT_TRUE(cells.may_overlap(0, 1, ed::internal::nearest_image(r_k - r_i, box), normal));
      ASSERT_LT((cells.image(0, 1, r_k - r_i, box) - d).norm(), 1e-12) << box;
      ASSERT_LE(d.norm(), cells.reach());
    }
  }
}

}  // namespace
