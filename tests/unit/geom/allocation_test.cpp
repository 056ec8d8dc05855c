// No query of two bodies allocates, easy or hard, and scenes survive every allocation that fails: calls of operator new
// are counted.

#include "common/counted_allocations.h"
#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>
#include <geom/kernel/any_body.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <new>
#include <optional>
#include <utility>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using geom_test::Random;

/// Round, flat, long, with faces, edges and vertices.
std::vector<Shape> shapes() {
  return {Ellipsoid({1, 1, 1}),
          Ellipsoid({1, 1, 8}),
          Ellipsoid({1, 0.7, 0.1}),
          Superellipsoid({1, 1.2, 0.8}, 1, 1),
          Superellipsoid({1, 1.2, 0.8}, 0.2, 0.3),
          Superellipsoid({1, 0.5, 2}, 1.6, 1.5),
          Superellipsoid({1, 1, 30}, 0.5, 1.3)};
}

struct Pairs {
  std::vector<Shape> a, b;
  std::vector<Pose> X_WA, X_WB;
};

/// Apart, slightly and deeply overlapping, concentric.
Pairs all_pairs() {
  Random random(1);
  Pairs pairs;
  for (const Shape& a : shapes()) {
    for (const Shape& b : shapes()) {
      for (const double gap : {1.0, 1e-6, -1e-6, -0.3}) {
        const auto pair = kernel::with_bodies(
            a, b, [&](const auto& s, const auto& t) { return geom_test::manufacture(s, t, gap, random); });
        pairs.a.push_back(a);
        pairs.b.push_back(b);
        pairs.X_WA.push_back(pair.X_WA);
        pairs.X_WB.push_back(pair.X_WB);
      }
      pairs.a.push_back(a);
      pairs.b.push_back(b);
      pairs.X_WA.emplace_back();
      pairs.X_WB.emplace_back();
    }
  }
  return pairs;
}

template <class Query>
void expect_none(const char* name, const Query& query) {
  const std::uint64_t before = allocations;
  query();
  EXPECT_EQ(allocations - before, 0U) << name;
}

TEST(Allocations, NoneInAQuery) {
  const Pairs p = all_pairs();
  int answers = 0;
  const auto for_each = [&](const auto& query) {
    return [&] {
      for (std::size_t i = 0; i < p.a.size(); ++i) query(p.a[i], p.X_WA[i], p.b[i], p.X_WB[i]);
    };
  };
  const auto is_answer = [](const DistanceResult& r) { return r.status != DistanceStatus::not_converged; };
  expect_none("distance", for_each([&](const auto&... pair) { answers += is_answer(distance(pair...)); }));
  expect_none("local distance", for_each([&](const auto&... pair) {
                answers += is_answer(distance(pair..., {.penetration = Penetration::local}));
              }));
  EXPECT_EQ(answers, 2 * static_cast<int>(p.a.size()));
  expect_none("overlap", for_each([&](const auto&... pair) { answers += overlap(pair...) == Answer::yes; }));
  expect_none("lower bound", for_each([&](const auto&... pair) {
                answers += distance_lower_bound(pair..., Vector3d(Vector3d::UnitX())) > 0;
              }));
  expect_none("newton_distance", for_each([&](const auto&... pair) {
                for (const NewtonSystem system : {NewtonSystem::eight, NewtonSystem::five}) {
                  answers += is_answer(newton_distance(pair..., system, dual_seed(pair...)));
                }
              }));
  expect_none("points and rays", for_each([&](const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
                answers += contains(a, X_WA, X_WB.position());
                answers += closest_point(b, X_WB, Vector3d(5, 1, 2)).distance > 0;
                answers += closest_point(a, X_WA, X_WA.position()).distance > 0;
                answers += ray_cast(a, X_WA, Vector3d(9, 1, 2), X_WA.position() - Vector3d(9, 1, 2)).t > 0;
                answers += oriented_box(b, X_WB).half_extents.x() > 0;
              }));
}

TEST(Allocations, NoneInABatch) {
  const Pairs p = all_pairs();
  std::vector<DistanceResult> results(p.a.size());
  expect_none("of shapes", [&] { (void)distance_batch(p.a, p.X_WA, p.b, p.X_WB, results); });
  const std::vector<Ellipsoid> needles(p.a.size(), Ellipsoid({1, 1, 8}));
  const std::vector<Ellipsoid> plates(p.a.size(), Ellipsoid({1, 0.7, 0.1}));
  expect_none("of ellipsoids", [&] {
    (void)distance_batch(needles, p.X_WA, needles, p.X_WB, results);
    (void)distance_batch(needles, p.X_WA, plates, p.X_WB, results);
  });
}

// ---- A scene whose memory ends

/// Answers of a scene.
struct Answers {
  std::vector<std::pair<BodyId, BodyId>> pairs;
  std::vector<double> distances;
  std::size_t size = 0;
  std::size_t overlaps = 0;
  std::optional<BodyId> nearest;
  double ray = 0;

  bool operator==(const Answers&) const = default;
};

Pose at(double x, double y, double z) {
  return {Eigen::Matrix3d::Identity(), {x, y, z}};
}

Answers answers_of(const Scene& scene) {
  Answers answers;
  std::vector<ScenePair> pairs;
  scene.pairs_within(1.5, pairs);
  for (const ScenePair& pair : pairs) {
    answers.pairs.emplace_back(pair.i, pair.j);
    answers.distances.push_back(pair.result.distance);
  }
  std::vector<SceneOverlap> overlaps;
  scene.overlapping_pairs(overlaps);
  answers.overlaps = overlaps.size();
  answers.size = scene.size();
  const SceneNearest nearest = scene.nearest(Shape(Ellipsoid({1, 1, 1})), at(2, 3, 40));
  if (nearest.body) answers.nearest = nearest.body->body;
  answers.distances.push_back(nearest.result.distance);
  const SceneRayHit hit = scene.ray_cast({-50, 1, 1}, {1, 0, 0});
  answers.ray = hit.body ? hit.hit.t : -1;
  return answers;
}

/// A scene with bodies in and outside its tree, removed ones and free places.
struct ManyBodies {
  Scene scene;
  std::vector<BodyId> bodies;

  /// Constructs one with `more` bodies added last. If it is mixed they have changed places, so that the tree does not
  /// fit them.
  explicit ManyBodies(std::size_t more, bool mixed = false) {
    Random random(5);
    const std::vector<Shape> kinds = {Ellipsoid({1, 1, 2}), Ellipsoid({1, 0.7, 0.5}), Sphere(1), Capsule(1, 0.5)};
    for (std::size_t k = 0; k < 60; ++k) add(kinds[k % 4], random);
    (void)answers_of(scene);
    for (std::size_t k = 0; k < 60; k += 7) scene.remove(bodies[k]);
    std::erase_if(bodies, [&](BodyId body) { return !scene.has(body); });
    for (std::size_t k = 0; k < more; ++k) add(kinds[k % 3], random);
    if (mixed) mix();
  }

  void add(const Shape& shape, Random& random) { bodies.push_back(scene.add(shape, random.pose(8))); }

  void mix() {
    std::vector<Pose> poses;
    for (std::size_t k = 0; k < bodies.size(); ++k) poses.push_back(scene.pose(bodies[(17 * k + 5) % bodies.size()]));
    scene.move(bodies, poses);
  }
};

/// Lets the first allocation of `change` fail, then the second and so on, on a scene of its own each time, until it
/// needs no more, or 40 have failed. Each time the scene's answers are those before the change, and the change can then
/// be made. Returns how many allocations it takes.
template <class Change>
std::uint64_t allocations_survived(std::size_t more, bool mixed, const Change& change) {
  const Answers before = answers_of(ManyBodies(more, mixed).scene);
  for (std::uint64_t failing = 1; failing <= 40; ++failing) {
    ManyBodies many(more, mixed);
    failing_allocation = allocations + failing;
    bool failed = false;
    try {
      change(many.scene, many.bodies);
    } catch (const std::bad_alloc&) {
      failed = true;
    }
    failing_allocation = 0;
    if (!failed) return failing - 1;
    EXPECT_EQ(answers_of(many.scene), before) << "allocation " << failing;
    change(many.scene, many.bodies);
  }
  return 40;
}

TEST(Allocations, OfASceneMayFail) {
  std::uint64_t of_adding = 0;
  for (std::size_t more = 0; more < 20; ++more) {
    of_adding += allocations_survived(more, false, [](Scene& scene, const std::vector<BodyId>&) {
      const std::size_t before = scene.size();
      (void)scene.add(Shape(Ellipsoid({1, 2, 3})), at(5, 5, 5));
      EXPECT_EQ(scene.size(), before + 1);
    });
  }
  EXPECT_GT(of_adding, 1U);
  const auto move_all = [](Scene& scene, const std::vector<BodyId>& bodies) {
    std::vector<Pose> poses;
    for (const BodyId body : bodies) {
      const Pose X = scene.pose(body);
      poses.emplace_back(X.rotation(), X.position() + Vector3d(3, 0, 0));
    }
    scene.move(bodies, poses);
  };
  EXPECT_GT(allocations_survived(20, false, move_all), 1U);
  const auto ask = [](Scene& scene, const std::vector<BodyId>&) { (void)answers_of(scene); };
  // With many bodies outside the tree, and where it has become worse, a query builds a new one.
  EXPECT_GT(allocations_survived(60, false, ask), 5U);
  EXPECT_GT(allocations_survived(30, true, ask), 5U);
}

}  // namespace
}  // namespace geom
