/// Superellipsoids and mixed pairs: seeds of other libraries, and what Newton's method makes of them.

#include "common/finder/scale.h"
#include "common/forked.h"
#include "common/geom/manufactured.h"
#include "common/geom/superellipsoid_sets.h"

#include <geom/geom.h>
#include <geom/kernel/any_body.h>
#include <geom/seeds.h>
#if HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdio>
#include <limits>
#include <stdexcept>
#include <variant>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using finder_test::scaled;
using geom_test::any_exponent;
using geom_test::kExponents;
using geom_test::lower_bound;
using geom_test::ManufacturedPair;
using geom_test::Random;

struct Pair {
  Shape a, b;
  Pose X_WA, X_WB;
};

Shape any_shape(Random& random, double unit) {
  const Vector3d axes = unit * random.biaxial(random.coin() ? 3 : 100).semi_axes();
  if (random.uniform() < 0.25) return Ellipsoid(axes);
  return Superellipsoid(axes, any_exponent(random), any_exponent(random));
}

/// Pairs that overlap, touch or share their centre, aligned with the axes or not, some huge or tiny.
Pair hostile_pair(int i) {
  Random random(static_cast<std::uint64_t>(i) + 1);
  const double unit = i % 7 == 0 ? random.log_uniform(1e-9, 1e9) : 1;
  const Shape a = any_shape(random, unit);
  const Shape b = i % 2 == 0 ? a : any_shape(random, unit);
  const double size = bounding_radius(a) + bounding_radius(b);
  const std::array gaps{0.0, 1e-16, -1e-16, 1e-14, 1e-12, 2e-12, 1e-9, 1e-7, -1e-9, -1e-4, -1e-2, 1e-3, 0.1};
  const double gap = size * gaps[static_cast<std::size_t>(random.uniform() * gaps.size())];
  switch (static_cast<int>(4 * random.uniform())) {
    case 0: {  // faces, edges or tips against each other, along an axis or a diagonal
      Vector3d n = Vector3d::Unit(static_cast<int>(3 * random.uniform()));
      if (random.coin()) n = (n + Vector3d::Unit(static_cast<int>(3 * random.uniform()))).normalized();
      return {a, b, Pose(), Pose::translation((support(a, n).height + support(b, -n).height + gap) * n)};
    }
    case 1:
      return {a, b, random.pose(0.0),
              random.pose(random.coin() ? Vector3d(Vector3d::Zero()) : gap * random.direction())};
    case 2:
      return {a, b, random.pose(size), random.pose(size)};
    default: {
      const ManufacturedPair pair = kernel::with_bodies(
          a, b, [&](const auto& s, const auto& t) { return geom_test::manufacture(s, t, gap, random); });
      return {a, b, pair.X_WA, pair.X_WB};
    }
  }
}

struct SeedCounts {
  int usable = 0;
  int overlapping = 0;
  int declined = 0;
  int broken = 0;  ///< usable, but refused by check_seed; or not usable, but with a number
  int wrong = 0;   ///< answers of Newton's method that distance contradicts
};

bool is_answer(const DistanceResult& r) {
  return r.status == DistanceStatus::separated || r.status == DistanceStatus::overlapping;
}

/// Whether the gap that the bodies certify along the normal of `r` is not its distance.
template <class A, class B>
bool is_wrong(const A& a, const Pose& X_WA, const B& b, const Pose& X_WB, const DistanceResult& r) {
  const double size = (X_WB.position() - X_WA.position()).norm() + a.bounding_radius() + b.bounding_radius();
  const DistanceResult ours = distance(a, X_WA, b, X_WB);
  return std::abs(lower_bound(a, X_WA, b, X_WB, r.normal) - r.distance) > 1e-12 * size ||
         (is_answer(ours) && !(std::abs(ours.distance - r.distance) <= 1e-12 * size + ours.error_bound));
}

/// Returns f(a, b) with the ellipsoids or superellipsoids inside.
template <class F>
auto with_surfaces(const Shape& a, const Shape& b, const F& f) {
  return kernel::with_equations(
      "a", a, [&](const auto& s) { return kernel::with_equations("b", b, [&](const auto& t) { return f(s, t); }); });
}

template <class Seed>
void expect_no_abort(const char* name, int pairs, const Seed& seed_of) {
  SeedCounts counts;
  const int aborts = geom_test::run_forked(pairs, counts, [&](int i, SeedCounts& record) {
    const Pair p = hostile_pair(i);
    with_surfaces(p.a, p.b, [&](const auto& a, const auto& b) {
      const WitnessPair seed = seed_of(a, p.X_WA, b, p.X_WB);
      ++(seed.status == SeedStatus::usable        ? record.usable
         : seed.status == SeedStatus::overlapping ? record.overlapping
                                                  : record.declined);
      if (seed.status != SeedStatus::usable && !std::isnan(seed.point_a.x())) ++record.broken;
      try {
        check_seed(a, p.X_WA, b, p.X_WB, seed);
      } catch (const std::invalid_argument&) {
        ++record.broken;
        return;
      }
      for (const NewtonSystem system : {NewtonSystem::eight, NewtonSystem::five}) {
        const DistanceResult r = newton_distance(a, p.X_WA, b, p.X_WB, system, seed);
        if (is_answer(r) && is_wrong(a, p.X_WA, b, p.X_WB, r)) ++record.wrong;
      }
    });
  });
  std::printf("%s, hostile pairs: %d usable, %d overlapping, %d declined, %d broken, %d wrong answers, %d aborts\n",
              name, counts.usable, counts.overlapping, counts.declined, counts.broken, counts.wrong, aborts);
  EXPECT_EQ(aborts, 0) << name;
  EXPECT_EQ(counts.broken, 0) << name;
  EXPECT_EQ(counts.wrong, 0) << name;
  EXPECT_GT(counts.usable, 0) << name;
}

TEST(SuperellipsoidOracle, SeedsNeverEndTheProcess) {
  expect_no_abort("fcl", scaled(2'000, 100'000), [](const auto&... pair) { return fcl_seed(pair...); });
  expect_no_abort("ccd", scaled(2'000, 100'000), [](const auto&... pair) { return ccd_seed(pair...); });
#if HARDBODY_WITH_CGAL
  expect_no_abort("cgal", scaled(200, 10'000), [](const auto&... pair) { return cgal_seed(pair...); });
#endif
}

// ---------------------------------------------------------------------------------------------------------------------

template <class Seed>
void expect_alike(const Seed& seed_of) {
  for (int i = 0; i < 40; ++i) {
    const Pair p = hostile_pair(i);
    const WitnessPair seed = seed_of(p.a, p.X_WA, p.b, p.X_WB);
    const WitnessPair inside =
        with_surfaces(p.a, p.b, [&](const auto& a, const auto& b) { return seed_of(a, p.X_WA, b, p.X_WB); });
    ASSERT_EQ(seed.status, inside.status) << i;
    if (seed.status != SeedStatus::usable) continue;
    EXPECT_EQ(seed.point_a, inside.point_a) << i;
    EXPECT_EQ(seed.point_b, inside.point_b) << i;
  }
}

TEST(SuperellipsoidOracle, SeedsOfShapesChosenAtRunTimeAreThoseOfTheShapesInside) {
  expect_alike([](const auto&... pair) { return fcl_seed(pair...); });
  expect_alike([](const auto&... pair) { return ccd_seed(pair...); });
#if HARDBODY_WITH_CGAL
  expect_alike([](const auto&... pair) { return cgal_seed(pair...); });
#endif
}

// ---------------------------------------------------------------------------------------------------------------------

struct Solved {
  int pairs = 0;
  int seeds = 0;  ///< usable ones
  std::array<int, 2> right{};
  std::array<int, 2> wrong{};

  Solved& operator+=(const Solved& s) {
    pairs += s.pairs;
    seeds += s.seeds;
    for (std::size_t k = 0; k < 2; ++k) {
      right[k] += s.right[k];
      wrong[k] += s.wrong[k];
    }
    return *this;
  }
};

template <class A, class B, class Seed>
void solve(const A& a, const B& b, const Seed& seed_of, Random& random, Solved& solved) {
  const ManufacturedPair pair = geom_test::manufacture(a, b, random.log_uniform(1e-6, 10), random);
  const WitnessPair seed = seed_of(a, pair.X_WA, b, pair.X_WB);
  ++solved.pairs;
  solved.seeds += seed.status == SeedStatus::usable;
  const double wanted = lower_bound(a, pair.X_WA, b, pair.X_WB, pair.normal);
  for (const NewtonSystem system : {NewtonSystem::eight, NewtonSystem::five}) {
    const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, seed);
    const std::size_t column = system == NewtonSystem::eight ? 0 : 1;
    const bool right = r.status == DistanceStatus::separated && std::abs(r.distance - wanted) <= 1e-12 * pair.size;
    solved.right[column] += right;
    solved.wrong[column] += is_answer(r) && !right;
  }
}

/// Pairs of one e1 and e2, semi-axes drawn from [1, 3], gaps log-uniform in [1e-6, 10]; the second body of every third
/// is an ellipsoid.
template <class Seed>
Solved solve_cell(double e1, double e2, int pairs, const Seed& seed_of) {
  Solved cell;
  Random random(static_cast<std::uint64_t>(1000 * e1 + 10 * e2));
  for (int i = 0; i < pairs; ++i) {
    const Superellipsoid a(random.biaxial(3).semi_axes(), e1, e2);
    const Ellipsoid axes = random.biaxial(3);
    if (i % 3 == 0) {
      solve(a, axes, seed_of, random, cell);
    } else {
      solve(a, Superellipsoid(axes.semi_axes(), e1, e2), seed_of, random, cell);
    }
  }
  return cell;
}

/// Shares of pairs solved by the eight equations and by the five.
using Shares = std::array<double, 2>;

Shares shares_of(const Solved& solved) {
  return {1.0 * solved.right[0] / solved.pairs, 1.0 * solved.right[1] / solved.pairs};
}

/// The share that a cell of few pairs must have solved where `share` is that of many: three standard deviations less.
double least_of_few(double share, int pairs) {
  return share - 3 * std::sqrt(share * (1 - share) / pairs);
}

/// `least`: shares of all pairs, `worst`: of any cell, if it had infinitely many.
template <class Seed>
void expect_solved(const char* name, int pairs_a_cell, const Shares& least, const Shares& worst, const Seed& seed_of) {
  std::printf("\n%s: %d pairs a cell; solved in %%, eight equations / five\n e1\\e2", name, pairs_a_cell);
  for (const double e2 : kExponents) std::printf("  %13g", e2);
  std::printf("\n");
  Solved all;
  Shares worst_found{1, 1};
  for (const double e1 : kExponents) {
    std::printf("%6g", e1);
    for (const double e2 : kExponents) {
      const Solved cell = solve_cell(e1, e2, pairs_a_cell, seed_of);
      const Shares found = shares_of(cell);
      std::printf("  %6.2f/%6.2f", 100 * found[0], 100 * found[1]);
      for (std::size_t k = 0; k < 2; ++k) {
        worst_found[k] = std::min(worst_found[k], found[k]);
        EXPECT_EQ(cell.wrong[k], 0) << name << ", e1 = " << e1 << ", e2 = " << e2;
        EXPECT_GE(found[k], least_of_few(worst[k], cell.pairs)) << name << ", e1 = " << e1 << ", e2 = " << e2;
      }
      all += cell;
    }
    std::printf("\n");
  }
  const Shares found = shares_of(all);
  std::printf(
      "all: %.2f %% of the seeds usable, solved %.3f / %.3f %%, in the worst cell %.2f / %.2f %%, wrong %d / %d\n",
      100.0 * all.seeds / all.pairs, 100 * found[0], 100 * found[1], 100 * worst_found[0], 100 * worst_found[1],
      all.wrong[0], all.wrong[1]);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(all.wrong[k], 0) << name;
    EXPECT_GE(found[k], least[k]) << name;
  }
}

TEST(SuperellipsoidOracle, NewtonSolvesSeparatedPairsFromEverySeed) {
  expect_solved("fcl", scaled(60, 2'000), {0.999, 0.99}, {0.99, 0.97},
                [](const auto&... pair) { return fcl_seed(pair...); });
  expect_solved("ccd", scaled(60, 2'000), {0.999, 0.99}, {0.99, 0.97},
                [](const auto&... pair) { return ccd_seed(pair...); });
#if HARDBODY_WITH_CGAL
  expect_solved("cgal", scaled(12, 500), {0.99, 0.98}, {0.98, 0.95},
                [](const auto&... pair) { return cgal_seed(pair...); });
#endif
  expect_solved("centres", scaled(60, 2'000), {0.98, 0.96}, {0.9, 0.84},
                [](const auto&... pair) { return centre_seed(pair...); });
  expect_solved("dual", scaled(60, 2'000), {0.999, 0.999}, {0.99, 0.99},
                [](const auto&... pair) { return dual_seed(pair...); });
}

}  // namespace
}  // namespace geom
