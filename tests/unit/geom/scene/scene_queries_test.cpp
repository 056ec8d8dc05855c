/// Nearest bodies and ray casts of scenes against all bodies, one by one.

#include "common/geom/scene_bodies.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Dense>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <numbers>
#include <random>
#include <stdexcept>
#include <vector>

namespace {

using Eigen::Vector3d;
using geom::BodyId;
using geom::Pose;
using geom::Scene;
using geom::Shape;
using geom_test::any_pose;
using geom_test::any_shape;
using geom_test::Bodies;
using geom_test::lattice_vectors;
using geom_test::many;
using geom_test::moved;
using geom_test::uniform3;

TEST(Scene, FindsTheNearestBody) {
  std::mt19937_64 random(6);
  const Vector3d x(3, 0, 0), y(0.9, 2.6, 0), z(-0.7, 0.5, 2.8);
  for (const geom::Lattice& lattice : {geom::Lattice{}, geom::Lattice{{x, y, z}}}) {
    Scene scene({.lattice = lattice});
    const Bodies bodies = many(scene, random, 15, 2.5);
    const std::vector<Vector3d> vectors = lattice_vectors(lattice, 5);
    for (int k = 0; k < 20; ++k) {
      const Shape shape = any_shape(random, 0.2);
      const Pose pose = any_pose(random, 4);
      double least = std::numeric_limits<double>::infinity(), least_of_point = least;
      std::size_t overlaps = 0;
      for (std::size_t b = 0; b < bodies.ids.size(); ++b) {
        for (const Vector3d& v : vectors) {
          const Pose there = moved(bodies.poses[b], v);
          const double centres = (there.position() - pose.position()).norm();
          if (centres - geom::bounding_radius(bodies.shapes[b]) - 0.4 > least) continue;
          least = std::min(least, geom::distance(shape, pose, bodies.shapes[b], there).distance);
          overlaps += geom::overlap(shape, pose, bodies.shapes[b], there) != geom::Answer::no ? 1 : 0;
        }
      }
      for (std::size_t b = 0; b < bodies.ids.size(); ++b) {
        for (const Vector3d& v : vectors) {
          const Pose there = moved(bodies.poses[b], v);
          const double centres = (there.position() - pose.position()).norm();
          if (centres - geom::bounding_radius(bodies.shapes[b]) > least_of_point) continue;
          least_of_point =
              std::min(least_of_point, geom::closest_point(bodies.shapes[b], there, pose.position()).distance);
        }
      }
      const geom::SceneNearest nearest = scene.nearest(shape, pose);
      ASSERT_TRUE(nearest.body);
      EXPECT_NEAR(nearest.result.distance, least, 1e-9);
      const geom::ScenePoint point = scene.closest_point(pose.position());
      ASSERT_TRUE(point.body);
      EXPECT_NEAR(point.closest.distance, least_of_point, 1e-9);
      if (least > 0.01) {
        EXPECT_FALSE(scene.nearest(shape, pose, 0.99 * least).body);
        EXPECT_TRUE(scene.nearest(shape, pose, 1.01 * least).body);
      }
      std::vector<geom::SceneImage> found;
      scene.overlapping(shape, pose, found);
      EXPECT_EQ(found.size(), overlaps);
    }
    for (const BodyId body : bodies.ids) {
      const geom::SceneNearest nearest = scene.nearest(body);
      ASSERT_TRUE(nearest.body);
      EXPECT_NE(nearest.body->body, body);
      double least = std::numeric_limits<double>::infinity();
      for (const BodyId other : bodies.ids) {
        if (other != body) least = std::min(least, scene.distance(body, other).result.distance);
      }
      EXPECT_NEAR(nearest.result.distance, least, 1e-9);
    }
  }
}

// The image that is nearest to a long body is far from the cell of its centre.
TEST(Scene, FindsTheNearestImageOfALongBody) {
  const geom::Lattice lattice{{Vector3d::Zero(), Vector3d(0.6, 1, 0), Vector3d::Zero()}};
  Scene scene({.lattice = lattice});
  const geom::Sphere ball(0.1);
  scene.add(ball, Pose());
  const geom::Ellipsoid needle({70.7, 0.01, 0.01});
  const double h = std::sqrt(0.5);
  const Pose pose =
      Pose::from_quaternion(std::cos(std::numbers::pi / 8), 0, 0, std::sin(std::numbers::pi / 8), {-50, 50, 0});
  ASSERT_NEAR(pose.rotation()(0, 0), h, 1e-12);
  double least = std::numeric_limits<double>::infinity();
  for (int k = -200; k <= 200; ++k) {
    const Pose there = Pose::translation(k * lattice.vectors[1]);
    least = std::min(least, geom::distance(needle, pose, ball.ellipsoid(), there).distance);
  }
  const geom::SceneNearest nearest = scene.nearest(needle, pose);
  ASSERT_TRUE(nearest.body);
  EXPECT_NEAR(nearest.result.distance, least, 1e-9);
}

// Of many bodies that a ray passes none is asked; one that declines far from it is no answer.
TEST(Scene, RaysThatMissFindNothing) {
  Scene scene;
  for (int k = 0; k < 20000; ++k) scene.add(geom::Sphere(0.1), Pose::translation({0.5 * k, 0, 1}));
  scene.add(geom::Sphere(0.1), Pose::translation({0, 1e90, 0}));
  const geom::SceneRayHit hit = scene.ray_cast({-1, 0, 0}, {1, 0, 0});
  EXPECT_FALSE(hit.body);
  EXPECT_EQ(hit.hit.status, geom::RayStatus::missed);
}

TEST(Scene, FindsTheLeastDistanceOfAllImages) {
  std::mt19937_64 random(7);
  const geom::Lattice lattice{{Vector3d(3, 0, 0), Vector3d(0.9, 2.6, 0), Vector3d(-0.7, 0.5, 2.8)}};
  Scene scene({.lattice = lattice});
  const Bodies bodies = many(scene, random, 8, 6);
  for (std::size_t i = 0; i < 8; ++i) {
    for (std::size_t j = i + 1; j < 8; ++j) {
      double least = std::numeric_limits<double>::infinity();
      for (const Vector3d& v : lattice_vectors(lattice, 7)) {
        const Pose there = moved(bodies.poses[j], v);
        if ((there.position() - bodies.poses[i].position()).norm() > 6) continue;
        least = std::min(least, geom::distance(bodies.shapes[i], bodies.poses[i], bodies.shapes[j], there).distance);
      }
      EXPECT_NEAR(scene.distance(bodies.ids[i], bodies.ids[j]).result.distance, least, 1e-9);
      EXPECT_NEAR(scene.distance(bodies.ids[j], bodies.ids[i]).result.distance, least, 1e-9);
    }
  }
}

TEST(Scene, CastsRaysOnTheFirstBody) {
  std::mt19937_64 random(8);
  const Vector3d x(3, 0, 0), y(0.9, 2.6, 0), z(-0.7, 0.5, 2.8);
  int hits = 0;
  for (const geom::Lattice& lattice : {geom::Lattice{}, geom::Lattice{{x, y, z}}}) {
    Scene scene({.lattice = lattice});
    const Bodies bodies = many(scene, random, 8, 2.5);
    const std::vector<Vector3d> vectors = lattice_vectors(lattice, 7);
    for (int k = 0; k < 60; ++k) {
      const Vector3d origin = uniform3(random, -3, 3);
      Vector3d direction = uniform3(random, -1, 1);
      if (k % 5 == 0) direction.x() = 0;
      double first = std::numeric_limits<double>::infinity();
      constexpr double kEnd = 4;
      for (std::size_t b = 0; b < bodies.ids.size(); ++b) {
        for (const Vector3d& v : vectors) {
          const geom::RayHit hit = geom::ray_cast(bodies.shapes[b], moved(bodies.poses[b], v), origin, direction);
          if (hit.status != geom::RayStatus::missed && hit.t <= kEnd) first = std::min(first, hit.t);
        }
      }
      const geom::SceneRayHit hit = scene.ray_cast(origin, direction, kEnd);
      EXPECT_EQ(hit.body.has_value(), first <= kEnd);
      if (hit.body) {
        EXPECT_NEAR(hit.hit.t, first, 1e-9);
        ++hits;
      }
    }
  }
  EXPECT_GE(hits, 20);
}

// The answers are those of ray_cast, which declines directions whose squares or inverses it cannot have.
TEST(Scene, CastsRaysOfAnyLength) {
  const geom::Box box({1, 1, 1});
  const Pose there = Pose::translation({3, 0.2, 0.1});
  Scene open, periodic({.lattice = geom::Lattice::cube(10)});
  open.add(box, there);
  periodic.add(box, there);
  for (const double length : {1e-310, 1e-308, 1e-307, 1e-300, 1.0, 1e300, 1e307, 1e308}) {
    const Vector3d direction(length, 0, 0);
    const geom::RayHit wanted = geom::ray_cast(box, there, Vector3d::Zero(), direction);
    const geom::SceneRayHit found = open.ray_cast(Vector3d::Zero(), direction);
    EXPECT_EQ(found.hit.status, wanted.status) << length;
    EXPECT_TRUE(found.body) << length;
    const geom::SceneRayHit beyond = open.ray_cast({20, 0, 0}, direction);
    EXPECT_FALSE(beyond.body) << length;
    if (wanted.status != geom::RayStatus::hit) continue;
    EXPECT_EQ(found.hit.t, wanted.t) << length;
    EXPECT_EQ(periodic.ray_cast(Vector3d::Zero(), direction, 2 * wanted.t).hit.t, wanted.t) << length;
  }
}

TEST(Scene, CastsRaysThroughManyCellsAndNoMore) {
  Scene tiny({.lattice = geom::Lattice::cube(1e-20)});
  tiny.add(geom::Sphere(1e-21), Pose());
  EXPECT_FALSE(tiny.ray_cast({3e-21, 3e-21, 3e-21}, {1e308, 0, 0}, 0).body);
  Scene cube({.lattice = geom::Lattice::cube(1)});
  const BodyId ball = cube.add(geom::Sphere(0.1), Pose());
  EXPECT_FALSE(cube.ray_cast({0, 0.5, 0.5}, {1, 0, 0}, 1e4).body);
  EXPECT_THROW((void)cube.ray_cast({0, 0.5, 0.5}, {1, 0, 0}, 1e7), std::invalid_argument);
  const geom::SceneRayHit far = cube.ray_cast({0.5, 0.5, 0}, {1, 1e-4, 0}, 1e4);
  ASSERT_TRUE(far.body);
  EXPECT_EQ(far.body->body, ball);
  EXPECT_GT(far.hit.t, 3000);
}

// Along directions in which the scene does not repeat, rays end where the bodies do.
TEST(Scene, CastsLongRaysAcrossRowsAndLayers) {
  const Vector3d x(1, 0.2, 0.1), y(0.3, 1, -0.2), none = Vector3d::Zero();
  for (const geom::Lattice& lattice : {geom::Lattice{{x, none, none}}, geom::Lattice{{x, none, y}}}) {
    Scene scene({.lattice = lattice});
    scene.add(geom::Sphere(0.3), Pose());
    scene.add(geom::Sphere(0.3), Pose::translation({0.4, 0.3, 2}));
    const double infinity = std::numeric_limits<double>::infinity();
    const geom::SceneRayHit from_afar = scene.ray_cast({0.4, 0.3, -1e7}, {0, 0, 1});
    ASSERT_TRUE(from_afar.body);
    EXPECT_FALSE(scene.ray_cast({0.4, 0.3, 1e7}, {0, 0, 1}).body);
    EXPECT_FALSE(scene.ray_cast({0, 0, 50}, x, 1e9).body);
    EXPECT_THROW((void)scene.ray_cast({0, 0, 1}, x, infinity), std::invalid_argument);
    std::mt19937_64 random(10);
    for (int k = 0; k < 50; ++k) {
      const Vector3d origin = uniform3(random, -3, 3), direction = uniform3(random, -1, 1);
      double first = infinity;
      for (const BodyId body : scene.bodies()) {
        for (const Vector3d& v : lattice_vectors(lattice, 60)) {
          const geom::RayHit hit = geom::ray_cast(geom::Sphere(0.3), moved(scene.pose(body), v), origin, direction);
          if (hit.status != geom::RayStatus::missed && hit.t <= 20) first = std::min(first, hit.t);
        }
      }
      const geom::SceneRayHit found = scene.ray_cast(origin, direction, 20);
      EXPECT_EQ(found.body.has_value(), first < infinity) << k;
      if (found.body) {
        EXPECT_NEAR(found.hit.t, first, 1e-9) << k;
      }
    }
  }
}

}  // namespace
