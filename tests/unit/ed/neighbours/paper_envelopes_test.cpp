// The paper's envelopes, oriented boxes and cells: no body leaves one before exit_time says so, and no pair that could
// touch is left out of the lists.

#include "base/periodic.h"
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
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>

namespace {

using ed::internal::AxisMotion;
using CellEnvelopes = ed::internal::CellEnvelopes<ed::internal::UniaxialBodies>;
using ed::internal::OrientedEnvelopes;
using Eigen::Vector3d;
using finder_test::log_uniform;
using moving_spheroids::axis_at;
using moving_spheroids::place_pair;
using moving_spheroids::PlacedPair;
using moving_spheroids::random_motion;
using moving_spheroids::Shape;
using moving_spheroids::simple_motion;

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
