// Envelopes of bodies of any shape: a body never leaves its envelope before exit_time says so, no pair that could touch
// is kept out of the lists, and the periodic box is large enough for what turns in its envelope. All is sampled against
// the definitions, and the samples must be able to see a bound that is wrong.

#include "neighbours/general.h"
#include "bodies/general.h"
#include "neighbours/oriented_slack.h"

#include <common/ed/families.h>
#include <common/finder/ensemble.h>
#include <common/geom/shapes.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <memory>
#include <string>
#include <vector>

namespace {

using ed::BodyShape;
using ed::internal::Envelopes;
using ed::internal::GeneralBodies;
using ed::internal::GeneralDilatedEnvelopes;
using ed::internal::GeneralOrientedEnvelopes;
using Eigen::Matrix3d;
using Eigen::Vector3d;
using finder_test::log_uniform;

constexpr double kBox = 100;

ed::CustomShape short_rod() {
  return {geom_test::Spherocylinder{1, 0.5}, {"rod", 2.0944, 2, true}};
}
ed::CustomShape pear() {
  return {geom_test::Pear{0.7, 0.8, 0.4}, {"pear", 2.5, 2, false}};
}

std::vector<BodyShape> shapes() {
  return {ed_test::superball(8),
          ed_test::superball(1.25),
          ed_test::superellipsoid({1, 0.8, 0.6}, 0.7, 1.3),
          ed_test::superellipsoid({1, 1, 2}, 0.5, 0.5),
          ed_test::ellipsoid({1, 0.8, 0.5}),
          short_rod(),
          pear()};
}

ed::Body random_body(ed::Random& random, int species) {
  ed::Body body;
  body.species = species;
  body.position = random.normal3();
  body.rotation = random.rotation();
  body.velocity = log_uniform(random, 1e-3, 3) * random.direction();
  body.angular_velocity = log_uniform(random, 1e-2, 10) * random.direction();
  return body;
}

/// One body of each shape, of a species of its own.
ed::System pair_of(const BodyShape& a, const BodyShape& b, ed::Random& random) {
  ed::System system;
  system.box = kBox;
  for (const BodyShape& shape : {a, b}) {
    const int species = static_cast<int>(system.species.size());
    const double r = ed::inscribed_radius(shape);
    system.species.push_back({shape, 1, r * r * Vector3d(0.5, 0.45, 0.4)});
    system.bodies.push_back(random_body(random, species));
  }
  return system;
}

/// Returns how far the body in `now` reaches beyond the body in `before`, along the worst of all directions: by
/// sampling, a little below the truth.
double reach_beyond(const BodyShape& shape, const ed::Motion& now, const ed::Motion& before) {
  ed::Random random(1);
  double worst = -1e300;
  Vector3d best = Vector3d::UnitX();
  const auto look = [&](const Vector3d& n) {
    const auto height = [&](const ed::Motion& m) {
      return n.dot(m.pose.position()) + ed::support(shape, m.pose.rotation().transpose() * n).height;
    };
    const double beyond = height(now) - height(before);
    if (beyond <= worst) return;
    worst = beyond;
    best = n;
  };
  for (int k = 0; k < 60; ++k) look(random.direction());
  double step = 0.3;
  while (step > 1e-5) {
    for (int k = 0; k < 4; ++k) look((best + step * random.direction()).normalized());
    step *= 0.7;
  }
  return worst;
}

/// Returns by how much the body in `now` reaches beyond the box, thicker by `thickness`, of the body in `before`.
double beyond_general_box(const BodyShape& shape, double thickness, const ed::Motion& now, const ed::Motion& before) {
  const Vector3d extents = ed::half_extents(shape).array() + thickness;
  double worst = -1e300;
  for (int k = 0; k < 3; ++k) {
    for (const double side : {1.0, -1.0}) {
      const Vector3d n = side * before.pose.rotation().col(k);
      const double height = ed::support(shape, now.pose.rotation().transpose() * n).height;
      worst = std::max(worst, n.dot(now.pose.position() - before.pose.position()) + height - extents[k]);
    }
  }
  return worst;
}

struct GeneralExits {
  int trials = 0;
  double worst = -1e300;  ///< largest reach beyond the envelope before the exit
  int late = 0;           ///< trials in which a part is outside before three times the bound
};

/// Bodies are followed by their exit bounds, renewed as the event loop does, and are outside soon after the last.
template <class Make, class Beyond>
GeneralExits sample_exits(const BodyShape& shape, const Make& make, const Beyond& beyond) {
  ed::Random random(5);
  GeneralExits exits;
  for (int trial = 0; trial < 100; ++trial) {
    const double thickness = log_uniform(random, 0.03, 1);
    const GeneralBodies bodies(pair_of(shape, shape, random));
    const auto envelopes = make(bodies, thickness);
    envelopes->place(0, bodies, 0);
    double now = 0;
    for (int look = 0; look < 1000; ++look) {
      const double exit = envelopes->exit_time(0, bodies, now, kBox);
      EXPECT_GE(exit, now);
      for (int k = 0; k <= 8; ++k) {
        const double t = now + (exit - now) * k / 8;
        exits.worst = std::max(exits.worst, beyond(shape, thickness, bodies.motion(0, t), bodies.motion(0, 0)));
      }
      if (exit - now < envelopes->worthwhile(0, bodies)) {
        now = exit;
        break;
      }
      now = exit;
    }
    ++exits.trials;
    bool outside = false;
    for (int k = 1; k <= 40; ++k) {
      const double t = now * (1 + 2.0 * k / 40);
      outside = outside || beyond(shape, thickness, bodies.motion(0, t), bodies.motion(0, 0)) > 0;
    }
    exits.late += outside ? 1 : 0;
  }
  return exits;
}

void expect_sound(const std::string& what, const GeneralExits& exits) {
  std::printf("%s: outside by %.1e at most; %d of %d outside before three times the bound\n", what.c_str(), exits.worst,
              exits.late, exits.trials);
  // Rounding of positions of order 1.
  EXPECT_LE(exits.worst, 1e-13) << what;
  EXPECT_GT(exits.late, exits.trials / 2) << what;
}

TEST(GeneralEnvelopes, AreNeverLeftBeforeTheExit) {
  for (const BodyShape& shape : shapes()) {
    expect_sound("dilated " + ed::describe(shape),
                 sample_exits(
                     shape,
                     [](const GeneralBodies& bodies, double thickness) {
                       return std::make_unique<GeneralDilatedEnvelopes>(bodies, 1.25 * thickness, thickness);
                     },
                     [](const BodyShape& s, double thickness, const ed::Motion& now, const ed::Motion& before) {
                       return reach_beyond(s, now, before) - thickness;
                     }));
    expect_sound("box of " + ed::describe(shape), sample_exits(
                                                      shape,
                                                      [](const GeneralBodies& bodies, double thickness) {
                                                        return std::make_unique<GeneralOrientedEnvelopes>(bodies,
                                                                                                          thickness);
                                                      },
                                                      beyond_general_box));
  }
}

/// Two bodies whose surfaces are `gap` apart.
ed::System placed_pair(const BodyShape& a, const BodyShape& b, double gap, ed::Random& random) {
  ed::System system = pair_of(a, b, random);
  const Vector3d n = random.direction();
  const auto point = [&](int i, const Vector3d& m) {
    const ed::Body& body = system.bodies[static_cast<std::size_t>(i)];
    return Vector3d(body.rotation * ed::support(i == 0 ? a : b, body.rotation.transpose() * m).point);
  };
  system.bodies[1].position = system.bodies[0].position + point(0, n) + gap * n - point(1, -n);
  return system;
}

TEST(GeneralEnvelopes, NeverKeepAPairApartThatCanTouch) {
  ed::Random random(31);
  const std::vector<BodyShape> all = shapes();
  for (std::size_t i = 0; i < all.size(); ++i) {
    int rejected = 0;
    constexpr int kPairs = 2000;
    for (int trial = 0; trial < kPairs; ++trial) {
      const BodyShape& a = all[i];
      const BodyShape& b =
          all[trial % 2 == 0 ? i : static_cast<std::size_t>(random.uniform() * static_cast<double>(all.size()))];
      const double thickness = log_uniform(random, 0.01, 1);
      // Half of them at the very edge, where the decision is hardest; some overlap.
      const double share = trial % 4 == 0 ? 1.2 * random.uniform() - 0.2 : 1 - log_uniform(random, 1e-12, 1e-2);
      const auto may_overlap = [&](const ed::System& system, bool boxes) {
        const GeneralBodies bodies(system);
        GeneralDilatedEnvelopes dilated(bodies, thickness, thickness);
        GeneralOrientedEnvelopes oriented(bodies, thickness);
        Envelopes<GeneralBodies>& envelopes = boxes ? static_cast<Envelopes<GeneralBodies>&>(oriented) : dilated;
        for (const int k : {0, 1}) envelopes.place(k, bodies, 0);
        const Vector3d r = system.bodies[1].position - system.bodies[0].position;
        Vector3d normal;
        return r.norm() <= envelopes.reach() && envelopes.may_overlap(0, 1, r, normal);
      };
      const ed::System near = placed_pair(a, b, 2 * thickness * share, random);
      ASSERT_TRUE(may_overlap(near, false)) << ed::describe(a) << ", " << ed::describe(b) << ", share " << share;
      ASSERT_TRUE(may_overlap(near, true)) << ed::describe(a) << ", " << ed::describe(b) << ", share " << share;
      rejected += may_overlap(placed_pair(a, b, 2 * thickness * 1.1, random), false) ? 0 : 1;
    }
    // Lists would be too long otherwise, and this test would prove little.
    EXPECT_GT(rejected, kPairs * 9 / 10) << ed::describe(all[i]);
  }
}

TEST(OrientedSlack, IsNeverLessThanTheRoomOfABodyThatTurns) {
  ed::Random random(7);
  std::vector<BodyShape> all = shapes();
  // A bounding sphere that is larger than need be, which CustomShape allows.
  struct LooseRod : geom_test::Spherocylinder {
    double bounding_radius() const { return 1.2 * Spherocylinder::bounding_radius(); }
  };
  all.emplace_back(ed::CustomShape(LooseRod{{1, 0.5}}, {"loose rod", 2.0944, 2, true}));
  for (const BodyShape& shape : all) {
    for (const double thickness : {0.01, 0.1, 0.5}) {
      const double slack = ed::internal::oriented_slack(shape, thickness);
      double most = 0;
      for (int trial = 0; trial < 20000; ++trial) {
        const double angle = trial % 2 == 0 ? 3.1415926 : log_uniform(random, 1e-3, 1);
        const Matrix3d R = Eigen::AngleAxisd(angle * random.uniform(), random.direction()).toRotationMatrix();
        Vector3d room;
        bool fits = true;
        for (int k = 0; k < 3; ++k) {
          const double extent = ed::half_extents(shape)[k] + thickness;
          const double up = extent - ed::support(shape, R.row(k)).height;
          const double down = extent - ed::support(shape, -R.row(k)).height;
          fits = fits && up + down >= 0;
          room[k] = std::max(up, down);
        }
        if (fits) most = std::max(most, room.norm());
      }
      EXPECT_LE(most, slack) << ed::describe(shape) << ", thickness " << thickness;
      EXPECT_GE(most, thickness) << ed::describe(shape);
    }
  }
}

TEST(SmallestBox, IsTheFirstThatBoxesAroundBodiesFitInto) {
  ed::Random random(9);
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  for (const BodyShape& shape : shapes()) {
    ed::System system = pair_of(shape, shape, random);
    for (ed::Body& body : system.bodies) body.velocity.setZero();
    system.bodies[0].position.setZero();
    system.bodies[1].position = 2.1 * ed::bounding_radius(shape) * Vector3d::UnitX();
    system.box = ed::smallest_box({{system.species[0], 1}, {system.species[1], 1}}, options.neighbours);
    EXPECT_NO_THROW(ed::Simulation(system, options)) << ed::describe(shape);
    system.box *= 1 - 1e-6;
    EXPECT_THAT(test_common::message_of([&] { ed::Simulation(system, options); }),
                testing::HasSubstr("accepted: at least"))
        << ed::describe(shape);
  }
}

}  // namespace
