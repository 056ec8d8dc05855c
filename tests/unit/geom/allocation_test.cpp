// No query allocates, easy or hard: every call of operator new is counted.

#include "common/counted_allocations.h"
#include "common/geom/manufactured.h"
#include "common/geom/random.h"

#include <geom/geom.h>
#include <geom/kernel/any_body.h>

#include <gtest/gtest.h>

#include <cstdint>
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

}  // namespace
}  // namespace geom
