/// First contact of a scene, beside time_of_contact of all pairs.

#include <common/geom/random.h>
#include <common/message_of.h>

#include <ed/ed.h>

#include <geom/geom.h>
#include <geom/scene.h>

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <cmath>
#include <cstddef>
#include <memory>
#include <stdexcept>
#include <utility>
#include <vector>

namespace scene_contact_test {
namespace {

using ed::BodyShape;
using ed::ContactResult;
using ed::ContactStatus;
using ed::GivenMotion;
using ed::MovingBody;
using ed::SceneContact;
using Eigen::Vector3d;
using geom::BodyId;
using geom::Pose;
using geom_test::Random;
using test_common::message_of;

GivenMotion along_x(double speed) {
  ed::Screw screw;
  screw.axis = Vector3d::UnitX();
  screw.speed = speed;
  return GivenMotion::screw(screw);
}

struct Crowd {
  geom::Scene scene;
  std::vector<BodyShape> shapes;
  std::vector<Pose> poses;
  std::vector<MovingBody> moving;  ///< the first bodies

  GivenMotion motion(std::size_t k) const {
    return k < moving.size() ? moving[k].motion : GivenMotion::resting(poses[k]);
  }
};

/// Bodies on a grid that do not touch, some of which move.
Crowd crowd(Random& random, int edge, double spacing, std::size_t moving, const geom::SceneOptions& options = {}) {
  Crowd all{geom::Scene(options), {}, {}, {}};
  for (int k = 0; k < edge * edge * edge; ++k) {
    const int row = k / edge, layer = row / edge;
    const Vector3d place(k % edge, row % edge, layer);
    const Pose X = random.pose(Vector3d(spacing * place + 0.1 * random.direction()));
    all.poses.push_back(X);
    if (k % 2 == 0) {
      const geom::Ellipsoid shape({0.4, 0.3, 0.45});
      all.shapes.emplace_back(shape);
      all.scene.add(shape, X);
    } else {
      const geom::Box shape({0.25, 0.2, 0.3});
      all.shapes.emplace_back(shape);
      all.scene.add(shape, X);
    }
  }
  for (std::size_t k = 0; k < moving; ++k) {
    ed::Screw screw;
    screw.pose = all.poses[k];
    screw.axis = random.direction();
    screw.point = screw.pose.position() + 0.2 * random.direction();
    screw.speed = random.uniform(-1, 1);
    screw.angular_speed = random.uniform(-1, 1);
    all.moving.push_back({BodyId(k), GivenMotion::screw(screw)});
  }
  return all;
}

/// First contact by all pairs and all images up to one lattice vector.
SceneContact by_all_pairs(const Crowd& all, double t_max, double period) {
  SceneContact first;
  first.contact.status = ContactStatus::separated;
  first.contact.time = t_max;
  for (std::size_t i = 0; i < all.moving.size(); ++i) {
    for (std::size_t j = i + 1; j < all.shapes.size(); ++j) {
      for (int image = 0; image < (period > 0 ? 27 : 1); ++image) {
        const int row = image / 3, layer = image / 9;
        const Vector3d number(image % 3, row % 3, layer);
        const Vector3d by = period > 0 ? Vector3d(period * (number - Vector3d::Ones())) : Vector3d::Zero();
        const GivenMotion motion = all.motion(j);
        const GivenMotion moved(
            [&](double t) { return Pose(motion.pose(t).rotation(), motion.pose(t).position() + by); },
            [&](double from, double to) { return motion.bounds(from, to); });
        const ContactResult found = time_of_contact(all.shapes[i], all.motion(i), all.shapes[j], moved, 0, t_max);
        if (found.status == ContactStatus::separated || !(found.time < first.contact.time)) continue;
        first.contact = found;
        first.i = BodyId(i);
        first.j = BodyId(j);
        first.image = by;
      }
    }
  }
  return first;
}

void expect_same(const SceneContact& found, const SceneContact& wanted) {
  ASSERT_EQ(found.contact.status, wanted.contact.status);
  EXPECT_NEAR(found.contact.time, wanted.contact.time, 1e-7);
  if (wanted.contact.status == ContactStatus::separated) return;
  EXPECT_EQ(found.i, wanted.i);
  EXPECT_EQ(found.j, wanted.j);
  EXPECT_LE((found.image - wanted.image).norm(), 1e-12);
}

TEST(SceneContact, IsTheFirstOfAllPairs) {
  Random random(1);
  int hits = 0;
  for (int i = 0; i < 20; ++i) {
    for (const std::size_t moving : {std::size_t{1}, std::size_t{2}, std::size_t{27}}) {
      Crowd all = crowd(random, 3, 1.3, moving);
      const double t_max = 1.5;
      const SceneContact wanted = by_all_pairs(all, t_max, 0);
      const SceneContact found = ed::first_contact(all.scene, all.moving, 0, t_max);
      expect_same(found, wanted);
      hits += found.contact.status == ContactStatus::hit ? 1 : 0;
      for (std::size_t k = 0; k < moving; ++k) {
        EXPECT_EQ(all.scene.pose(BodyId(k)).position(), all.motion(k).pose(found.contact.time).position());
      }
    }
  }
  EXPECT_GT(hits, 20);
}

TEST(SceneContact, OfAPeriodicSceneCountsImages) {
  Random random(2);
  const double period = 2.6;
  int across = 0;
  for (int i = 0; i < 10; ++i) {
    for (const std::size_t moving : {std::size_t{1}, std::size_t{8}}) {
      Crowd all = crowd(random, 2, 1.3, moving, {.margin = 0.1, .lattice = geom::Lattice::cube(period)});
      const SceneContact wanted = by_all_pairs(all, 1, period);
      const SceneContact found = ed::first_contact(all.scene, all.moving, 0, 1);
      expect_same(found, wanted);
      across += found.image.isZero(0) ? 0 : 1;
    }
  }
  EXPECT_GT(across, 0);
}

TEST(SceneContact, OverLongTimes) {
  // Bodies that move through many cells of a lattice, and far away in open space.
  geom::Scene periodic({.lattice = geom::Lattice::cube(2.6)});
  const BodyId runner = periodic.add(geom::Sphere(0.2), Pose::translation({0, 0, 0}));
  const BodyId other = periodic.add(geom::Sphere(0.2), Pose::translation({1.3, 1.3, 1.3}));
  const std::vector<MovingBody> along{{runner, along_x(1)}};
  EXPECT_EQ(ed::first_contact(periodic, along, 0, 1000).contact.status, ContactStatus::separated);
  periodic.move(other, Pose::translation({1.3, 0.39, 0}));
  EXPECT_EQ(ed::first_contact(periodic, along, 0, 1000).contact.status, ContactStatus::hit);
  geom::Scene open;
  const BodyId first = open.add(geom::Sphere(1), Pose());
  open.add(geom::Sphere(1), Pose::translation({1e5, 0, 0}));
  const std::vector<MovingBody> forth{{first, along_x(1)}};
  const SceneContact found = ed::first_contact(open, forth, 0, 1e6);
  EXPECT_EQ(found.contact.status, ContactStatus::hit);
  EXPECT_NEAR(found.contact.time, 1e5 - 2, 1e-9);
}

TEST(SceneContact, OfASmallFastBodyFarFromOthersIsThatOfThePair) {
  const geom::Sphere ball(0.01);
  ed::Screw along_y;
  along_y.axis = Vector3d::UnitY();
  along_y.speed = 1;
  const GivenMotion motion = GivenMotion::screw(along_y);
  geom::Scene scene;
  const BodyId body = scene.add(ball, Pose());
  scene.add(ball, Pose::translation({5, 0, 0}));
  const std::vector<MovingBody> moving{{body, motion}};
  const SceneContact found = ed::first_contact(scene, moving, 0, 1e4);
  EXPECT_EQ(found.contact.status, ContactStatus::separated);
  EXPECT_LE(found.contact.evaluations, 10);
  // Resting bodies whose number is more than a few for one that moves.
  for (int k = 0; k < 500; ++k) scene.add(ball, Pose::translation({5 + 0.1 * (k % 20), 0.1 * (k / 20), 0}));
  EXPECT_EQ(ed::first_contact(scene, moving, 0, 1e4).contact.status, ContactStatus::separated);
  scene.add(ball, Pose::translation({0, 9e3, 0}));
  const SceneContact hit = ed::first_contact(scene, moving, 0, 1e4);
  EXPECT_EQ(hit.contact.status, ContactStatus::hit);
  EXPECT_NEAR(hit.contact.time, 9e3 - 0.02, 1e-9);
}

TEST(SceneContact, OfASmallFastBodyInAPeriodicBoxEndsWithTheBudget) {
  // It passes images of the other one all the time.
  geom::Scene scene({.lattice = geom::Lattice::cube(1)});
  const BodyId body = scene.add(geom::Sphere(1e-6), Pose());
  scene.add(geom::Sphere(0.1), Pose::translation({0, 0.5, 0.5}));
  const std::vector<MovingBody> moving{{body, along_x(1)}};
  const SceneContact found = ed::first_contact(scene, moving, 0, 1e5, {.max_evaluations = 50});
  EXPECT_EQ(found.contact.status, ContactStatus::budget_exhausted);
  EXPECT_EQ(found.i, found.j);
  EXPECT_GT(found.contact.time, 10);
  EXPECT_LT(found.contact.time, 1000);
  EXPECT_EQ(scene.pose(body).position().x(), found.contact.time);
}

TEST(SceneContact, OfFiltersAndOverlaps) {
  geom::Scene scene;
  const BodyId ball = scene.add(geom::Sphere(1), Pose(), {.group = 1, .meets = 2});
  const BodyId ghost = scene.add(geom::Sphere(1), Pose::translation({3, 0, 0}), {.group = 1, .meets = 2});
  const BodyId wall = scene.add(geom::Sphere(1), Pose::translation({6, 0, 0}), {.group = 2});
  const std::vector<MovingBody> moving{{ball, along_x(1)}};
  const SceneContact found = ed::first_contact(scene, moving, 0, 10);
  EXPECT_EQ(found.contact.status, ContactStatus::hit);
  EXPECT_NEAR(found.contact.time, 4, 1e-12);
  EXPECT_EQ(std::pair(found.i, found.j), std::pair(ball, wall));
  scene.set_filter(ghost, {});
  EXPECT_EQ(ed::first_contact(scene, moving, 3.5, 10).contact.status, ContactStatus::hit);
  scene.set_filter(ball, {});
  const SceneContact inside = ed::first_contact(scene, moving, 3.5, 10);
  EXPECT_EQ(inside.contact.status, ContactStatus::overlapping);
  EXPECT_EQ(std::pair(inside.i, inside.j), std::pair(ball, ghost));
  EXPECT_EQ(ed::first_contact(scene, {}, 0, 1).contact.status, ContactStatus::separated);
}

TEST(SceneContact, ThatFailsLeavesTheScene) {
  geom::Scene scene;
  const BodyId ball = scene.add(geom::Sphere(1), Pose());
  const BodyId gone = scene.add(geom::Sphere(1), Pose::translation({9, 0, 0}));
  scene.add(geom::Sphere(1), Pose::translation({5, 0, 0}));
  scene.remove(gone);
  const GivenMotion motion = along_x(1);
  const auto message = [&](const std::vector<MovingBody>& moving) {
    return message_of([&] { return ed::first_contact(scene, moving, 1, 2); });
  };
  EXPECT_NE(message({{gone, motion}}).find("body 1 "), std::string::npos) << message({{gone, motion}});
  EXPECT_EQ(message_of([&] { return ed::first_contact(scene, {}, 2, 1); }),
            "first_contact: t_min is 2 and t_max 1; accepted: finite times, t_max no earlier");
  const GivenMotion fast(
      [](double t) {
        return Pose::translation({3 * t, 0, 0});
      },
      [](double, double) {
        return ed::MotionBounds{1, 0, 0, 0};
      });
  EXPECT_NE(message({{ball, fast}}).find("first_contact: the motion of body 0 breaks its bounds: it moves"),
            std::string::npos)
      << message({{ball, fast}});
  EXPECT_EQ(message({{ball, motion}, {ball, motion}}),
            "first_contact: body 0 is given twice; accepted: one motion a body");
  const GivenMotion throws([](double t) { return t > 1 ? throw std::invalid_argument("too late") : Pose(); },
                           [](double, double) {
                             return ed::MotionBounds{3, 0, 0, 0};
                           });
  EXPECT_EQ(message({{ball, throws}}), "too late");
  EXPECT_EQ(scene.pose(ball).position(), Vector3d(0, 0, 0));
}

/// A ball whose support function throws when it is told to.
struct MoodyBall {
  std::shared_ptr<bool> throws = std::make_shared<bool>(false);
  geom::Support support(const Vector3d& n) const {
    if (*throws) throw std::runtime_error("no support");
    return {n.norm(), n.normalized()};
  }
  Eigen::Matrix3d support_hessian(const Vector3d& n) const {
    const Vector3d m = n.normalized();
    return (Eigen::Matrix3d::Identity() - m * m.transpose()) / n.norm();
  }
  double bounding_radius() const { return 1; }
  double inscribed_radius() const { return 1; }
  double min_curvature_radius() const { return 1; }
};

// Bodies are put back even if their shapes still throw.
TEST(SceneContact, RefusesMotionsThatGetOutOfReachOfTheirBounds) {
  // By its bounds, the body gets nowhere near the other one.
  geom::Scene scene;
  const BodyId a = scene.add(geom::Sphere(1), Pose());
  scene.add(geom::Sphere(1), Pose::translation({40, 0, 0}));
  const GivenMotion motion(
      [](double t) {
        return Pose::translation({t, 0, 0});
      },
      [](double, double) {
        return ed::MotionBounds{0.1, 0, 0, 0};
      });
  const std::vector<MovingBody> moving{{a, motion}};
  const std::string message = message_of([&] { return ed::first_contact(scene, moving, 0, 100); });
  EXPECT_NE(message.find("first_contact: the motion of body 0 breaks its bounds: it moves by"), std::string::npos)
      << message;
  EXPECT_EQ(scene.pose(a).position(), Vector3d::Zero().eval());
}

TEST(SceneContact, ThatAShapeThrowsOutOfLeavesTheScene) {
  geom::Scene scene;
  const MoodyBall ball;
  const BodyId first = scene.add(geom::Sphere(1), Pose::translation({0, 9, 0}));
  const BodyId second = scene.add(ball, Pose());
  scene.add(geom::Sphere(1), Pose::translation({50, 0, 0}));
  const GivenMotion motion(
      [throws = ball.throws](double t) {
        return *throws = t > 2, Pose::translation({3 + t, 0, 0});
      },
      [](double, double) {
        return ed::MotionBounds{1, 0, 0, 0};
      });
  const std::vector<MovingBody> moving{{first, GivenMotion::resting(Pose::translation({3, 9, 0}))}, {second, motion}};
  EXPECT_THROW((void)ed::first_contact(scene, moving, 0, 100), std::runtime_error);
  *ball.throws = false;
  EXPECT_EQ(scene.pose(first).position(), Vector3d(0, 9, 0));
  EXPECT_EQ(scene.pose(second).position(), Vector3d(0, 0, 0));
  EXPECT_NEAR(scene.closest_point({0, 9, 3}).closest.distance, 2, 1e-12);
  EXPECT_NEAR(scene.closest_point({0, 0, 3}).closest.distance, 2, 1e-12);
}

}  // namespace
}  // namespace scene_contact_test
