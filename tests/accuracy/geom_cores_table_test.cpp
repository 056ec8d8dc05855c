/// The table data/accuracy/cores.csv: errors of distance() by pair of kinds, for spheres, capsules, boxes, polyhedra,
/// cylinders, cones and rounded ones. tools/accuracy writes it.
///
/// Known answers: features of both bodies (vertices, edges, faces; edges parallel in half of the pairs) are put into
/// parallel planes, apart by a gap that is log-uniform from 1e-10 to 10. HARDBODY_FULL=1: 1,000,000 pairs a row instead
/// of 2,000.

#include "common/full_form.h"
#include "common/geom/accuracy_rows.h"
#include "common/geom/core_pairs.h"

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <string>
#include <tuple>
#include <vector>

namespace geom {
namespace {

using geom_test::Random;

/// Bodies of one kind, drawn from a list that is made once: hulls take long.
template <class Shape>
struct BodiesOfAKind {
  const char* name;
  double accuracy;
  std::vector<Shape> bodies;

  const Shape& next(Random& random) const {
    return bodies[static_cast<std::size_t>(random.uniform() * static_cast<double>(bodies.size()))];
  }
};

template <class Make>
auto kind(const char* name, double accuracy, const Make& make) {
  Random random(7);
  std::vector<decltype(make(random))> bodies;
  for (int k = 0; k < 100; ++k) bodies.push_back(make(random));
  return BodiesOfAKind<decltype(make(random))>{name, accuracy, std::move(bodies)};
}

double drawn_length(Random& random) {
  return random.log_uniform(0.1, 10);
}

auto all_kinds() {
  const auto box = [](Random& r) { return Box({drawn_length(r), drawn_length(r), drawn_length(r)}); };
  const auto hull = [](Random& r) { return geom_test::random_polyhedron(r.coin() ? 8 : 32, r); };
  const auto cylinder = [](Random& r) { return Cylinder(drawn_length(r), drawn_length(r)); };
  const auto cone = [](Random& r) { return Cone(drawn_length(r), drawn_length(r)); };
  return std::tuple{
      kind("sphere", geom_test::kEllipsoidAccuracy, [](Random& r) { return Sphere(drawn_length(r)); }),
      kind("capsule", geom_test::kEllipsoidAccuracy,
           [](Random& r) {
             const double l = drawn_length(r);
             return Capsule(l, l * r.log_uniform(1e-3, 10));
           }),
      kind("box", geom_test::kEllipsoidAccuracy, box),
      kind("polyhedron", geom_test::kEllipsoidAccuracy, hull),
      kind("rounded box", geom_test::kEllipsoidAccuracy,
           [&](Random& r) { return Rounded<Box>(box(r), r.log_uniform(1e-3, 1)); }),
      kind("rounded polyhedron", geom_test::kEllipsoidAccuracy,
           [&](Random& r) { return Rounded<ConvexPolyhedron>(hull(r), r.log_uniform(1e-3, 1)); }),
      kind("cylinder", geom_test::kEllipsoidAccuracy, cylinder),
      kind("cone", geom_test::kEllipsoidAccuracy, cone),
      kind("rounded cylinder", geom_test::kEllipsoidAccuracy,
           [&](Random& r) { return Rounded<Cylinder>(cylinder(r), r.log_uniform(1e-3, 1)); }),
      kind("rounded cone", geom_test::kEllipsoidAccuracy,
           [&](Random& r) { return Rounded<Cone>(cone(r), r.log_uniform(1e-3, 1)); }),
  };
}

template <class A, class B>
void cores_row(const BodiesOfAKind<A>& kind_a, const BodiesOfAKind<B>& kind_b) {
  const long pairs = full_form() ? 1000000 : short_form() ? 300 : 2000;
  Random random(1);
  std::vector<double> errors;
  long failures = 0;
  long evaluations = 0;
  double bound = 0;
  for (long k = 0; k < pairs; ++k) {
    const A& a = kind_a.next(random);
    const B& b = kind_b.next(random);
    const double gap = random.log_uniform(1e-10, 10);
    const auto pair =
        geom_test::manufacture_features(a, static_cast<int>(k % 3), b, static_cast<int>(k / 3 % 3), gap, random);
    const DistanceResult r = distance(a, pair.X_WA, b, pair.X_WB);
    evaluations += r.iterations;
    // The position of B is rounded to the size of the coordinates, the world's origin included.
    const double error = std::abs(r.distance - gap) / geom_test::extent_of(pair);
    if (r.status != DistanceStatus::separated || !(error <= std::max(kind_a.accuracy, kind_b.accuracy))) ++failures;
    if (std::isnan(error)) continue;
    errors.push_back(error);
    bound = std::max(bound, r.error_bound / pair.size);
  }
  std::sort(errors.begin(), errors.end());
  std::printf("| %s, %s | %ld | %ld | %.1e | %.1e | %.1e | %.1f |\n", kind_a.name, kind_b.name, pairs, failures,
              errors[errors.size() / 2], errors.back(), bound,
              static_cast<double>(evaluations) / static_cast<double>(pairs));
  std::fflush(stdout);
  EXPECT_EQ(failures, 0) << kind_a.name << ", " << kind_b.name;
  EXPECT_LE(bound, 1e-13) << kind_a.name << ", " << kind_b.name;
}

TEST(CoresTable, IsWithinTheContract) {
  std::printf("| pair | pairs | failures | median error | largest error | largest error bound | evaluations |\n");
  std::printf("|---|---|---|---|---|---|---|\n");
  const auto kinds = all_kinds();
  std::apply(
      [&](const auto&... a) {
        const auto rows_of = [&](const auto& first) { (cores_row(first, a), ...); };
        (rows_of(a), ...);
      },
      kinds);
}

}  // namespace
}  // namespace geom
