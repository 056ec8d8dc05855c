/// Pairs of scenes against all pairs, one by one.

#include "common/full_form.h"
#include "common/geom/scene_bodies.h"
#include "scene/parallel.h"

#include <geom/geom.h>

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <memory>
#include <random>
#include <stdexcept>
#include <string>
#include <thread>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using Eigen::Vector3d;
using geom::BodyId;
using geom::Pose;
using geom::Scene;
using geom_test::any_pose;
using geom_test::any_shape;
using geom_test::Bodies;
using geom_test::lattice_vectors;
using geom_test::many;
using geom_test::moved;
using geom_test::uniform3;

/// Pair with its image and distance, to be compared with some tolerance.
struct Found {
  BodyId i, j;
  Vector3d image;
  double distance;
};

std::vector<Found> brute_pairs(const Bodies& bodies, const geom::Lattice& lattice, int reach, double cutoff) {
  std::vector<Found> found;
  const std::vector<Vector3d> vectors = lattice_vectors(lattice, reach);
  for (std::size_t i = 0; i < bodies.ids.size(); ++i) {
    for (std::size_t j = i + 1; j < bodies.ids.size(); ++j) {
      const geom::Filter& f = bodies.filters[i];
      const geom::Filter& g = bodies.filters[j];
      if ((f.meets & g.group) == 0 || (g.meets & f.group) == 0) continue;
      for (const Vector3d& image : vectors) {
        const Pose there = moved(bodies.poses[j], image);
        const double centres = (there.position() - bodies.poses[i].position()).norm();
        if (centres > cutoff + geom::bounding_radius(bodies.shapes[i]) + geom::bounding_radius(bodies.shapes[j]))
          continue;
        const double d = geom::distance(bodies.shapes[i], bodies.poses[i], bodies.shapes[j], there).distance;
        if (d <= cutoff) found.push_back({bodies.ids[i], bodies.ids[j], image, d});
      }
    }
  }
  return found;
}

/// Expects the scene's pairs to be those of trying all, apart from those at the cut-off to rounding.
void expect_all_pairs(const Scene& scene, const Bodies& bodies, const geom::Lattice& lattice, int reach, double cutoff,
                      const std::string& what) {
  std::vector<geom::ScenePair> pairs;
  scene.pairs_within(cutoff, pairs);
  const std::vector<Found> wanted = brute_pairs(bodies, lattice, reach, cutoff);
  ASSERT_EQ(pairs.size(), wanted.size()) << what;
  const auto key = [](const auto& p) {
    return std::tuple(p.i, p.j, std::lround(1e6 * p.image.x()), std::lround(1e6 * p.image.y()),
                      std::lround(1e6 * p.image.z()));
  };
  std::vector<Found> sorted = wanted;
  std::sort(sorted.begin(), sorted.end(), [&](const Found& a, const Found& b) { return key(a) < key(b); });
  std::vector<geom::ScenePair> mine = pairs;
  std::sort(mine.begin(), mine.end(), [&](const auto& a, const auto& b) { return key(a) < key(b); });
  for (std::size_t k = 0; k < sorted.size(); ++k) {
    ASSERT_EQ(key(mine[k]), key(sorted[k])) << what;
    EXPECT_NEAR(mine[k].result.distance, sorted[k].distance, 1e-9) << what;
  }
}

TEST(Scene, FindsThePairsOfTryingAll) {
  std::mt19937_64 random(1);
  for (const double margin : {0.0, 0.1}) {
    for (const double ratio : {1.0, 1000.0}) {
      Scene scene({.margin = margin});
      Bodies bodies = many(scene, random, 120, 2.5, ratio);
      for (const double cutoff : {0.0, 0.1, 1.0}) {
        expect_all_pairs(scene, bodies, {}, 0, cutoff, "margin " + std::to_string(margin));
      }
    }
  }
}

TEST(Scene, FollowsMovesRemovalsAndAdditions) {
  std::mt19937_64 random(2);
  Scene scene({.margin = 0.05});
  Bodies bodies = many(scene, random, 80, 2);
  for (int round = 0; round < 12; ++round) {
    const double step = round % 3 == 0 ? 1.0 : 0.03;
    for (std::size_t k = 0; k < bodies.ids.size(); k += round % 2 == 0 ? 1 : 5) {
      bodies.poses[k] = moved(bodies.poses[k], uniform3(random, -step, step));
    }
    scene.move(bodies.ids, bodies.poses);
    for (int k = 0; k < 3; ++k) bodies.erase(scene, random() % bodies.ids.size());
    const int added = round == 5 ? 60 : 3;
    for (int k = 0; k < added; ++k) bodies.add(scene, any_shape(random, 0.5), any_pose(random, 2));
    EXPECT_EQ(scene.size(), bodies.ids.size());
    EXPECT_EQ(scene.bodies(), bodies.ids);
    expect_all_pairs(scene, bodies, {}, 0, 0.1, "round " + std::to_string(round));
  }
}

TEST(Scene, FindsThePairsOfAllImages) {
  std::mt19937_64 random(3);
  const Vector3d x(3, 0, 0), y(0.9, 2.6, 0), z(-0.7, 0.5, 2.8), none = Vector3d::Zero();
  const std::vector<std::pair<std::string, geom::Lattice>> lattices{
      {"cube", geom::Lattice::cube(3)}, {"sheared", {{x, y, z}}}, {"slit", {{x, none, z}}}, {"rod", {{none, y, none}}}};
  for (const auto& [name, lattice] : lattices) {
    Scene scene({.lattice = lattice});
    Bodies bodies = many(scene, random, 25, 5);  // some are cells away
    for (const double cutoff : {0.0, 0.3, 3.5}) {
      expect_all_pairs(scene, bodies, lattice, 8, cutoff, name + ", " + std::to_string(cutoff));
    }
    for (Pose& pose : bodies.poses) pose = moved(pose, uniform3(random, -4, 4));
    scene.move(bodies.ids, bodies.poses);
    expect_all_pairs(scene, bodies, lattice, 12, 0.2, name + ", moved");
  }
}

TEST(Scene, KeepsToFilters) {
  std::mt19937_64 random(4);
  Scene scene;
  Bodies bodies;
  for (int k = 0; k < 60; ++k) {
    const geom::Filter filter{1U << (random() % 3), static_cast<std::uint32_t>(random() % 8)};
    bodies.add(scene, any_shape(random, 0.5), any_pose(random, 1.5), filter);
  }
  expect_all_pairs(scene, bodies, {}, 0, 0.2, "filters");
  bodies.filters[7] = {};
  scene.set_filter(bodies.ids[7], {});
  expect_all_pairs(scene, bodies, {}, 0, 0.2, "a new filter");
}

TEST(Scene, GivesTheSameAnswersWithAnyNumberOfThreads) {
  std::mt19937_64 random(5);
  Scene scene({.lattice = geom::Lattice::cube(6)});
  many(scene, random, 300, 3);
  std::vector<geom::ScenePair> one, four;
  scene.pairs_within(0.3, one);
  scene.pairs_within(0.3, four, {}, 4);
  ASSERT_EQ(one.size(), four.size());
  EXPECT_GT(one.size(), 300U);
  for (std::size_t k = 0; k < one.size(); ++k) {
    EXPECT_EQ(std::tuple(one[k].i, one[k].j), std::tuple(four[k].i, four[k].j));
    EXPECT_EQ(one[k].result.distance, four[k].result.distance);
    if (k > 0) {
      EXPECT_LE(std::tuple(one[k - 1].i, one[k - 1].j), std::tuple(one[k].i, one[k].j));
    }
  }
  std::vector<geom::SceneOverlap> overlaps, of_threads;
  scene.overlapping_pairs(overlaps);
  scene.overlapping_pairs(of_threads, 3);
  ASSERT_EQ(overlaps.size(), of_threads.size());
  std::size_t deep = 0;
  for (const geom::ScenePair& pair : one) deep += pair.result.distance < 0 ? 1 : 0;
  EXPECT_EQ(overlaps.size(), deep);
}

/// A user's shape: a ball by its support function.
struct Ball {
  double radius;
  geom::Support support(const Vector3d& n) const { return {radius * n.norm(), radius * n.normalized()}; }
  Eigen::Matrix3d support_hessian(const Vector3d& n) const {
    const Vector3d m = n.normalized();
    return radius / n.norm() * (Eigen::Matrix3d::Identity() - m * m.transpose());
  }
  double bounding_radius() const { return radius; }
  double inscribed_radius() const { return radius; }
  double min_curvature_radius() const { return radius; }
};

TEST(Scene, TakesUsersShapesBesideOthers) {
  Scene scene;
  const BodyId ball = scene.add(Ball{0.5}, Pose());
  const BodyId box = scene.add(geom::Box({1, 1, 1}), Pose::translation({2, 0, 0}));
  std::vector<geom::ScenePair> pairs;
  scene.pairs_within(1, pairs);
  ASSERT_EQ(pairs.size(), 1U);
  EXPECT_EQ(pairs[0].i, ball);
  EXPECT_EQ(pairs[0].j, box);
  EXPECT_NEAR(pairs[0].result.distance, 0.5, 1e-12);
  EXPECT_NEAR(scene.ray_cast({-3, 0, 0}, {1, 0, 0}).hit.t, 2.5, 1e-12);
}

/// A ball that throws, or has no numbers, when it is told to.
struct FaultyBall : Ball {
  std::shared_ptr<int> mode = std::make_shared<int>(0);
  geom::Support support(const Vector3d& n) const {
    if (*mode == 1) throw std::runtime_error("no support");
    if (*mode == 2) return {std::numeric_limits<double>::quiet_NaN(), n};
    return Ball::support(n);
  }
};

TEST(Scene, PassesOnWhatUsersShapesThrow) {
  Scene scene;
  FaultyBall ball;
  ball.radius = 0.5;
  for (int k = 0; k < 40; ++k) scene.add(geom::Sphere(1), Pose::translation({1.5 * k, 0, 0}));
  scene.add(ball, Pose::translation({0, 1, 0}));
  std::vector<geom::ScenePair> pairs;
  scene.pairs_within(0.1, pairs);
  const std::size_t count = pairs.size();
  EXPECT_GE(count, 40U);
  *ball.mode = 1;
  EXPECT_THROW(scene.pairs_within(0.1, pairs, {}, 3), std::runtime_error);
  EXPECT_EQ(pairs.size(), count) << "a query that fails leaves its output";
  *ball.mode = 2;
  EXPECT_THROW(scene.add(ball, Pose()), std::invalid_argument);
  EXPECT_EQ(scene.size(), 41U);
}

// A move that fails at a body in the middle moves none, and queries find all where they were.
TEST(Scene, MovesAllOrNone) {
  for (const int mode : {1, 2}) {
    Scene scene({.lattice = {{Vector3d(300, 0, 0), Vector3d::Zero(), Vector3d::Zero()}}});
    FaultyBall ball;
    ball.radius = 1;
    const std::vector<BodyId> bodies{scene.add(geom::Sphere(1), Pose()), scene.add(ball, Pose::translation({10, 0, 0})),
                                     scene.add(geom::Sphere(1), Pose::translation({20, 0, 0}))};
    const std::vector<Pose> poses{Pose::translation({100, 0, 0}), Pose::translation({50, 0, 0}),
                                  Pose::translation({-400, 0, 0})};
    *ball.mode = mode;
    EXPECT_ANY_THROW(scene.move(bodies, poses));
    EXPECT_ANY_THROW(scene.add(ball, Pose()));
    *ball.mode = 0;
    EXPECT_EQ(scene.size(), 3U);
    for (std::size_t k = 0; k < 3; ++k) {
      EXPECT_EQ(scene.pose(bodies[k]).position().x(), 10.0 * static_cast<double>(k));
      EXPECT_NEAR(scene.closest_point({10.0 * static_cast<double>(k), 0, 3}).closest.distance, 2, 1e-12);
    }
    scene.move(bodies, poses);
    EXPECT_NEAR(scene.closest_point({50, 0, 3}).closest.distance, 2, 1e-12);
    EXPECT_EQ(scene.closest_point({200, 0, 3}).body->body, bodies[2]);
  }
}

TEST(Scene, PutsBodiesBackWithoutAskingShapes) {
  Scene scene;
  FaultyBall ball;
  ball.radius = 1;
  const std::vector<BodyId> bodies{scene.add(ball, Pose::translation({5, 0, 0})), scene.add(geom::Sphere(1), Pose())};
  const auto places = scene.places(bodies);
  EXPECT_THROW((void)scene.places(std::vector{BodyId(7)}), std::invalid_argument);
  scene.move(bodies, std::vector{Pose::translation({-70, 0, 0}), Pose::translation({70, 0, 0})});
  EXPECT_NEAR(scene.closest_point({70, 0, 3}).closest.distance, 2, 1e-12);
  *ball.mode = 1;
  scene.remove(bodies[1]);
  scene.put_back(*places);
  *ball.mode = 0;
  EXPECT_EQ(scene.pose(bodies[0]).position(), Vector3d(5, 0, 0));
  EXPECT_NEAR(scene.closest_point({5, 0, 3}).closest.distance, 2, 1e-12);
  EXPECT_FALSE(scene.has(bodies[1]));
}

// Distances side by side differ from those of one pair by rounding; which pairs are within the cut-off does not.
TEST(Scene, AgreesAboutPairsAtTheCutoff) {
  std::mt19937_64 random(9);
  for (int k = 0; k < 2000; ++k) {
    Scene scene;
    const geom::Ellipsoid a(uniform3(random, 0.1, 0.4)), b(uniform3(random, 0.1, 0.4));
    const BodyId i = scene.add(a, any_pose(random, 1)), j = scene.add(b, any_pose(random, 1));
    const double distance = geom::distance(a, scene.pose(i), b, scene.pose(j)).distance;
    ASSERT_EQ(scene.distance(i, j).result.distance, distance);
    if (!(distance > 0)) continue;
    std::vector<geom::ScenePair> pairs;
    scene.pairs_within(distance, pairs);
    EXPECT_EQ(pairs.size(), 1U) << k;
    EXPECT_TRUE(scene.nearest(i, distance).body) << k;
    scene.pairs_within(std::nextafter(distance, 0), pairs);
    EXPECT_TRUE(pairs.empty()) << k;
  }
}

TEST(Scene, StartsNoMoreThreadsThanProcessorsCanUse) {
  const auto processors = std::max(1U, std::thread::hardware_concurrency());
  EXPECT_LE(geom::scene::number_of_threads(std::numeric_limits<int>::max(), 1000000), 16 * processors);
  EXPECT_EQ(geom::scene::number_of_threads(1, 1000000), 1U);
  EXPECT_EQ(geom::scene::number_of_threads(2, 1000000), 2U);
  EXPECT_EQ(geom::scene::number_of_threads(2, 1), 1U);
}

TEST(Scene, IsEmptyWithoutBodies) {
  for (const geom::Lattice& lattice : {geom::Lattice{}, geom::Lattice::cube(2)}) {
    Scene scene({.lattice = lattice});
    const auto nothing = [&] {
      std::vector<geom::ScenePair> pairs(3);
      scene.pairs_within(1, pairs);
      EXPECT_TRUE(pairs.empty());
      EXPECT_FALSE(scene.nearest(geom::Sphere(1), Pose()).body);
      EXPECT_FALSE(scene.closest_point({0, 0, 0}).body);
      EXPECT_FALSE(scene.ray_cast({0, 0, 0}, {1, 0, 0}, 10).body);
    };
    nothing();
    const BodyId only = scene.add(geom::Sphere(0.5), Pose());
    EXPECT_FALSE(scene.nearest(only).body);
    EXPECT_NEAR(scene.closest_point({0, 0, 0}).closest.distance, -0.5, 1e-12);
    scene.remove(only);
    nothing();
    EXPECT_FALSE(scene.has(only));
    EXPECT_NE(scene.add(geom::Sphere(0.5), Pose()), only);
  }
}

template <class F>
std::string message(const F& f) {
  try {
    f();
  } catch (const std::invalid_argument& e) {
    return e.what();
  }
  return "nothing";
}

TEST(Scene, RefusesWhatItCannotDo) {
  using testing::HasSubstr;
  Scene scene({.lattice = geom::Lattice::cube(2)});
  const BodyId a = scene.add(geom::Sphere(0.2), Pose());
  const BodyId b = scene.add(geom::Sphere(0.2), Pose::translation({1, 0, 0}));
  const BodyId gone = scene.add(geom::Sphere(0.2), Pose());
  scene.remove(gone);
  EXPECT_THAT(message([&] { scene.remove(gone); }), HasSubstr("body 2 has been removed"));
  EXPECT_THAT(message([&] { (void)scene.pose(static_cast<BodyId>(9)); }), HasSubstr("body 9 has not been added"));
  const std::vector<BodyId> both{a, gone};
  const std::vector<Pose> poses{Pose::translation({0.5, 0, 0}), Pose()};
  EXPECT_THAT(message([&] { scene.move(both, poses); }), HasSubstr("removed"));
  EXPECT_EQ(scene.pose(a).position().x(), 0) << "a refused call moves nothing";
  EXPECT_THAT(message([&] { scene.move(std::span(both).first(1), poses); }), HasSubstr("1 bodies and 2 poses"));
  const std::vector<Pose> far{Pose::translation({0.5, 0, 0}), Pose::translation({1e30, 0, 0})};
  EXPECT_THAT(message([&] { scene.move(std::vector{a, b}, far); }), HasSubstr("lattice vectors away"));
  EXPECT_EQ(scene.pose(a).position().x(), 0);
  std::vector<geom::ScenePair> pairs;
  EXPECT_THAT(message([&] { scene.pairs_within(-1, pairs); }), HasSubstr("cutoff is -1"));
  EXPECT_THAT(message([&] { scene.pairs_within(std::nan(""), pairs); }), HasSubstr("cutoff"));
  EXPECT_THAT(message([&] { scene.pairs_within(1, pairs, {}, 0); }), HasSubstr("threads is 0"));
  EXPECT_THAT(message([&] { (void)scene.distance(a, a); }), HasSubstr("both handles are 0"));
  EXPECT_THAT(message([&] { (void)scene.ray_cast({0, 0, 0}, {0, 0, 0}, 1); }), HasSubstr("direction is zero"));
  EXPECT_THAT(message([&] { (void)scene.ray_cast({0, 0, 0}, {1, 0, 0}); }), HasSubstr("periodic"));
  EXPECT_THAT(message([&] { (void)scene.ray_cast({0, 2e17, 0}, {1, 0, 0}, 9); }), HasSubstr("origin is more than"));
  EXPECT_THAT(message([&] { scene.pairs_within(1e9, pairs); }), HasSubstr("1e8 lattice vectors"));
  std::vector<geom::SceneImage> found;
  EXPECT_THAT(message([&] {
                scene.overlapping(geom::Sphere(1), Pose::translation({1e20, 0, 0}), found);
              }),
              HasSubstr("lattice vectors away"));
  EXPECT_THAT(message([] { Scene({.margin = -1}); }), HasSubstr("margin"));
  const Vector3d v(1, 2, 3);
  EXPECT_THAT(message([&] { Scene({.lattice = {{v, 2 * v, Vector3d::UnitX()}}}); }), HasSubstr("plane"));
  EXPECT_THAT(message([&] { Scene({.lattice = {{v, Vector3d::Constant(std::nan("")), v}}}); }), HasSubstr("finite"));
}

TEST(Scene, RefusesRaysAmongTooManyImages) {
  // Bodies that are long beside the shortest lattice vector have hundreds of images at each place of a ray.
  Scene scene({.lattice = {{Vector3d(0.01, 0, 0), Vector3d(0, 9, 0), Vector3d(0, 0, 9)}}});
  scene.add(geom::Ellipsoid({4, 0.1, 0.1}), Pose());
  scene.add(geom::Ellipsoid({4, 0.1, 0.1}), Pose::translation({0, 3, 3}));
  EXPECT_TRUE(scene.ray_cast({0, 2, 2}, {0, -1, -1}, 1000).body);
  EXPECT_FALSE(scene.ray_cast({0, 1, 1}, {1, 0, 0}, 10).body);
  if (!full_form()) return;  // 1e8 images take a second or more
  EXPECT_THAT(message([&] {
                (void)scene.ray_cast({0, 1, 1}, {1, 0, 0}, 9000);
              }),
              testing::HasSubstr("1e8 lattice vectors"));
}

}  // namespace
