/// Scenes far from the origin, from the bodies, or with lattices whose vectors are far from the shortest ones.

#include <geom/geom.h>
#include <geom/scene.h>

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

namespace {

using Eigen::Vector3d;
using geom::BodyId;
using geom::Pose;
using geom::Scene;

geom::Lattice lattice(const Vector3d& x, const Vector3d& y, const Vector3d& z) {
  return {{x, y, z}};
}

// The distance is below its lower bound there by the rounding of coordinates.
TEST(SceneFar, HasPairsWithinExactlyTheirDistance) {
  const Vector3d off(-1492.26, 516.08, -2060.39);
  Scene scene;
  const BodyId a = scene.add(geom::Superellipsoid({0.3, 0.3, 4}, 0.7, 1.4), Pose::translation(off));
  const BodyId b = scene.add(geom::Capsule(1, 1), Pose::translation(off + Vector3d(0, 0, 13.34)));
  const double distance = scene.distance(a, b).result.distance;
  EXPECT_NEAR(distance, 7.34, 1e-11);
  std::vector<geom::ScenePair> pairs;
  scene.pairs_within(distance, pairs);
  EXPECT_EQ(pairs.size(), 1U);
  EXPECT_TRUE(scene.nearest(a, distance).body);
}

TEST(SceneFar, AnswersTheSmallestHandleOfBodiesEquallyFarWhateverHappenedBefore) {
  const Vector3d off(91.33, -1870.67, -4115.02), up(0, 0, 19.73);
  const geom::Superellipsoid shape({0.3, 0.3, 4}, 0.7, 1.4);
  const geom::Capsule capsule(1, 1);
  Scene scene;
  const std::vector<BodyId> both{scene.add(capsule, Pose::translation(off + up)),
                                 scene.add(capsule, Pose::translation(off - up))};
  EXPECT_EQ(scene.nearest(shape, Pose::translation(off)).body->body, both[0]);
  std::vector<BodyId> others;
  for (int k = 0; k < 80; ++k) others.push_back(scene.add(capsule, Pose::translation(off + Vector3d(0, 50 + k, 0))));
  (void)scene.closest_point(Vector3d::Zero());
  for (const BodyId other : others) scene.remove(other);
  scene.move(both[0], Pose::translation(off + Vector3d(0, 9, 0)));
  (void)scene.closest_point(Vector3d::Zero());
  scene.move(both[0], Pose::translation(off + up));
  EXPECT_EQ(scene.nearest(shape, Pose::translation(off)).body->body, both[0]);
}

// Of a way along directions in which the scene does not repeat, nothing leads along the lattice.
TEST(SceneFar, FindsLayersAndRowsFromFarAway) {
  const Vector3d x(1, 0.2, 0), y(0, 1, 0), none = Vector3d::Zero();
  for (const geom::Lattice& images : {lattice(x, y, none), lattice(x, none, none), lattice(none, none, x)}) {
    for (const double height : {50.0, 6e3, 1e5}) {
      Scene scene({.lattice = images});
      const BodyId low = scene.add(geom::Sphere(0.3), Pose());
      const Vector3d above(3, 0.6, height);
      EXPECT_NEAR(scene.closest_point(above).closest.distance, height - 0.3, 1e-9 * height);
      const geom::SceneNearest nearest = scene.nearest(geom::Sphere(0.3), Pose::translation(above));
      EXPECT_NEAR(nearest.result.distance, height - 0.6, 1e-9 * height);
      const BodyId high = scene.add(geom::Sphere(0.3), Pose::translation(above));
      EXPECT_NEAR(scene.distance(low, high).result.distance, height - 0.6, 1e-9 * height);
      EXPECT_NEAR(scene.nearest(low).result.distance, height - 0.6, 1e-9 * height);
    }
  }
}

// So many images that bodies are asked one by one.
TEST(SceneFar, FindsTheDeepestOfBodiesWithManyImages) {
  Scene scene({.lattice = lattice({0.01, 0, 0}, {0, 0.02, 0}, Vector3d::Zero())});
  scene.add(geom::Box({4, 4, 0.3}), Pose());
  const BodyId thick = scene.add(geom::Box({4, 4, 1}), Pose());
  scene.add(geom::Box({4, 4, 0.5}), Pose());
  const geom::ScenePoint found = scene.closest_point({0.001, 0.001, 0});
  ASSERT_TRUE(found.body);
  EXPECT_EQ(found.body->body, thick);
  EXPECT_NEAR(found.closest.distance, -1, 1e-12);
}

TEST(SceneFar, HasTheSameDistancesInAShearedLattice) {
  const Vector3d y(0, 3, 0), z(0, 0, 3);
  for (const double shear : {0.0, 30.0, 300.0, -3000.0}) {
    Scene scene({.lattice = lattice({3, 0, 0}, y + Vector3d(shear, 0, 0), z)});
    const BodyId a = scene.add(geom::Sphere(0.5), Pose());
    const BodyId b = scene.add(geom::Sphere(0.5), Pose::translation({1.5, 1.5, 40}));
    const double wanted = std::sqrt(1.5 * 1.5 * 2 + 1) - 1;
    EXPECT_NEAR(scene.distance(a, b).result.distance, wanted, 1e-9) << shear;
    EXPECT_NEAR(scene.nearest(a).result.distance, wanted, 1e-9) << shear;
  }
}

TEST(SceneFar, NamesImagesWithoutMinusZero) {
  Scene scene({.lattice = lattice({1, 0, 0}, Vector3d::Zero(), Vector3d::Zero())});
  scene.add(geom::Sphere(0.3), Pose());
  const geom::SceneRayHit hit = scene.ray_cast({0.2, 1000, 0}, {0, -1, 0});
  ASSERT_TRUE(hit.body);
  for (int k = 0; k < 3; ++k) EXPECT_FALSE(std::signbit(hit.body->image[k]));
}

}  // namespace
