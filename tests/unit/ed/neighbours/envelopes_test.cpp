// Envelopes: a body never leaves its envelope before exit_time says so, and no pair that could touch is kept
// out of the lists. Both are sampled against the definition; that the samples would see a wrong bound is tested too.

#include "common/finder/moving_spheroids.h"
#include "motion/axis_motion.h"
#include "neighbours/cell.h"
#include "neighbours/dilated.h"
#include "neighbours/oriented.h"

#include <common/ed/states.h>
#include <common/finder/ensemble.h>

#include <ed/random.h>

#include <geom/distance.h>
#include <geom/kernel/uniaxial.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

using ed::internal::AxisMotion;
using CellEnvelopes = ed::internal::CellEnvelopes<ed::internal::UniaxialBodies>;
using ed::internal::DilatedEnvelopes;
using ed::internal::UniaxialInertia;
using Eigen::Vector3d;
using finder_test::log_uniform;
using moving_spheroids::axis_at;
using moving_spheroids::place_pair;
using moving_spheroids::PlacedPair;
using moving_spheroids::random_motion;
using moving_spheroids::Shape;
using moving_spheroids::simple_motion;

DilatedEnvelopes envelopes(const Shape& shape, double thickness, double exit_thickness) {
  return {2, shape.spheroid(), shape.difference(), shape.bounding_radius(), thickness, exit_thickness};
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

}  // namespace
