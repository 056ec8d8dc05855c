/// The seeds from other libraries: never an abort, and what Newton's method makes of them.

#include "common/finder/scale.h"
#include "common/forked.h"
#include "common/geom/manufactured.h"

#include <geom/geom.h>
#include <geom/seeds.h>
#if HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <gtest/gtest.h>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstdio>
#include <functional>
#include <string>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using finder_test::scaled;
using geom_test::distance_tolerance;
using geom_test::ManufacturedPair;
using geom_test::Random;

struct Pair {
  Ellipsoid a;
  Ellipsoid b;
  Pose X_WA;
  Pose X_WB;
};

/// A pose that GJK finds degenerate: axes along the world's.
Pose aligned(Random& random, const Vector3d& position) {
  static const std::array<Pose, 4> kTurns{Pose(), Pose::from_quaternion(0.5, 0.5, 0.5, 0.5),
                                          Pose::from_quaternion(0, 1, 0, 0),
                                          Pose::from_quaternion(0.5, -0.5, 0.5, 0.5)};
  return {kTurns[static_cast<std::size_t>(4 * random.uniform())].rotation(), position};
}

/// Pairs that overlap, touch, share their centre or are needles and discs; some aligned, some huge or tiny.
Pair hostile_pair(int i) {
  Random random(static_cast<std::uint64_t>(i));
  const double unit = i % 7 == 0 ? random.log_uniform(1e-9, 1e9) : 1;
  const auto shape = [&] {
    const double x0 = random.coin() ? random.log_uniform(1e-3, 1e3) : random.log_uniform(0.1, 10);
    return Ellipsoid(unit * (i % 3 == 0 ? random.biaxial(100) : random.spheroid(x0)).semi_axes());
  };
  const Ellipsoid a = shape();
  const Ellipsoid b = i % 2 == 0 ? a : shape();
  const double rho = a.min_curvature_radius() + b.min_curvature_radius();
  const double size = a.bounding_radius() + b.bounding_radius();
  const std::array gaps{0.0,         1e-16 * size, -1e-16 * size, 1e-14 * size, 1e-12 * size, 1e-9 * size,
                        1e-7 * size, -1e-9 * size, -0.5 * rho,    -rho,         -10 * rho,    1e-3 * size};
  const double gap = gaps[static_cast<std::size_t>(12 * random.uniform())];
  switch (static_cast<int>(5 * random.uniform())) {
    case 0: {  // on one axis of both, at gap
      const Pose X_WA = aligned(random, Vector3d::Zero());
      const Pose X_turned = aligned(random, Vector3d::Zero());
      const Vector3d n = Vector3d::Unit(static_cast<int>(3 * random.uniform()));
      const double centres = a.support(X_WA.rotation().transpose() * n).height +
                             b.support(X_turned.rotation().transpose() * n).height + gap;
      return {a, b, X_WA, Pose(X_turned.rotation(), centres * n)};
    }
    case 1:  // concentric, or nearly
      return {a, b, random.pose(0.0),
              random.pose(random.coin() ? Vector3d(Vector3d::Zero()) : gap * random.direction())};
    case 2:  // anywhere within reach
      return {a, b, random.pose(size), random.pose(size)};
    default: {
      const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
      return {a, b, pair.X_WA, pair.X_WB};
    }
  }
}

struct SeedCounts {
  int usable = 0;
  int overlapping = 0;
  int declined = 0;
  int broken = 0;  ///< usable, but a point is not finite or refused by check_seed; or not usable, but with a number
};

void count(const Pair& p, const WitnessPair& seed, SeedCounts& counts) {
  (seed.status == SeedStatus::usable        ? counts.usable
   : seed.status == SeedStatus::overlapping ? counts.overlapping
                                            : counts.declined)++;
  try {
    check_seed(p.a, p.X_WA, p.b, p.X_WB, seed);
  } catch (const std::invalid_argument&) {
    ++counts.broken;
  }
  if (seed.status != SeedStatus::usable && !std::isnan(seed.point_a.x())) ++counts.broken;
}

void print(const char* name, const SeedCounts& counts, int aborts) {
  std::printf("%s, hostile pairs: %d usable, %d overlapping, %d declined, %d broken, %d aborts\n", name, counts.usable,
              counts.overlapping, counts.declined, counts.broken, aborts);
}

TEST(SeedsOracle, FclSeedNeverEndsTheProcess) {
  SeedCounts counts;
  const int aborts = geom_test::run_forked(scaled(50'000, 100'000), counts, [](int i, SeedCounts& record) {
    const Pair p = hostile_pair(i);
    count(p, fcl_seed(p.a, p.X_WA, p.b, p.X_WB), record);
  });
  print("fcl", counts, aborts);
  EXPECT_EQ(aborts, 0);
  EXPECT_EQ(counts.broken, 0);
  EXPECT_GT(counts.usable, 0);
  EXPECT_GT(counts.overlapping, 0);
}

TEST(SeedsOracle, CcdSeedNeverEndsTheProcess) {
  SeedCounts counts;
  const int aborts = geom_test::run_forked(scaled(10'000, 100'000), counts, [](int i, SeedCounts& record) {
    const Pair p = hostile_pair(i);
    count(p, ccd_seed(p.a, p.X_WA, p.b, p.X_WB), record);
  });
  print("ccd", counts, aborts);
  EXPECT_EQ(aborts, 0);
  EXPECT_EQ(counts.broken, 0);
}

TEST(SeedsOracle, FclSeedCallsAPairOverlappingOnlyWhereThatIsKnown) {
  const Ellipsoid needle({1, 1, 3});
  const auto status = [&](const Vector3d& p_B) {
    return fcl_seed(needle, Pose(), needle, Pose::translation(p_B)).status;
  };
  EXPECT_EQ(status({0, 0, 0}), SeedStatus::overlapping);
  EXPECT_EQ(status({1.5, 0, 0}), SeedStatus::overlapping);  // inscribed spheres meet; too deep for `distance`
  EXPECT_EQ(status({1.999, 0, 0}), SeedStatus::overlapping);
  EXPECT_EQ(status({2, 0, 0}), SeedStatus::declined);  // touching
  EXPECT_EQ(status({2.001, 0, 0}), SeedStatus::usable);
  // Apart, by as much as there is.
  for (const double far : {1e60, 1e99, kMaxCoordinate}) {
    EXPECT_NE(status({far, 0, 0}), SeedStatus::overlapping) << far;
    EXPECT_NE(status({far, far, -far}), SeedStatus::overlapping) << far;
  }
}

#if HARDBODY_WITH_CGAL
TEST(SeedsOracle, CgalSeedNeverEndsTheProcess) {
  SeedCounts counts;
  const int aborts = geom_test::run_forked(scaled(1'000, 10'000), counts, [](int i, SeedCounts& record) {
    const Pair p = hostile_pair(i);
    count(p, cgal_seed(p.a, p.X_WA, p.b, p.X_WB), record);
  });
  print("cgal", counts, aborts);
  EXPECT_EQ(aborts, 0);
  EXPECT_EQ(counts.broken, 0);
}

#endif

using SeedFunction = std::function<WitnessPair(const Ellipsoid&, const Pose&, const Ellipsoid&, const Pose&)>;

struct Solved {
  int pairs = 0;
  int seeds = 0;  ///< usable ones
  std::array<int, 2> right{};
  std::array<int, 2> wrong{};
};

void solve(const Ellipsoid& a, const Ellipsoid& b, double gap, const SeedFunction& seed_of, Random& random,
           Solved& solved) {
  const ManufacturedPair pair = geom_test::manufacture(a, b, gap, random);
  const WitnessPair seed = seed_of(a, pair.X_WA, b, pair.X_WB);
  ++solved.pairs;
  solved.seeds += seed.status == SeedStatus::usable;
  for (const NewtonSystem system : {NewtonSystem::eight, NewtonSystem::five}) {
    const DistanceResult r = newton_distance(a, pair.X_WA, b, pair.X_WB, system, seed);
    const std::size_t column = system == NewtonSystem::eight ? 0 : 1;
    const bool answered = r.status == DistanceStatus::separated || r.status == DistanceStatus::overlapping;
    const bool right =
        r.status == DistanceStatus::separated && std::abs(r.distance - gap) <= distance_tolerance(pair.size);
    solved.right[column] += right;
    solved.wrong[column] += answered && !right;
  }
}

void print_row(const char* seed, const std::string& shapes, const Solved& s) {
  std::printf("%-8s %-8s %7d %7.2f %% %9.3f %% %9.3f %% %6d\n", seed, shapes.c_str(), s.pairs,
              100.0 * s.seeds / s.pairs, 100.0 * s.right[0] / s.pairs, 100.0 * s.right[1] / s.pairs,
              s.wrong[0] + s.wrong[1]);
}

/// Both systems from one kind of seed, on separated pairs of spheroids of X0 = 0.1..10 and of biaxial ellipsoids: gaps
/// log-uniform in [1e-6, 10] of the two equal semi-axes, the shortest of the biaxial ones.
/// `least_share`: of the pairs that are solved, with eight equations and with five.
Solved expect_solved(const char* name, int pairs, std::array<double, 2> least_share, const SeedFunction& seed_of) {
  const std::vector<double> aspect_ratios{0.1, 0.2, 0.5, 1, 2, 5, 10};
  const int each = pairs / static_cast<int>(aspect_ratios.size() + 1);
  Solved all;
  for (std::size_t row = 0; row <= aspect_ratios.size(); ++row) {
    Random random(1000 + row);
    Solved solved;
    for (int i = 0; i < each; ++i) {
      const bool biaxial = row == aspect_ratios.size();
      const Ellipsoid a = biaxial ? random.biaxial(10) : random.spheroid(aspect_ratios[row]);
      const Ellipsoid b = biaxial ? random.biaxial(10) : random.spheroid(aspect_ratios[row]);
      solve(a, b, random.log_uniform(1e-6, 10), seed_of, random, solved);
    }
    char shapes[24];
    std::snprintf(shapes, sizeof shapes, row < aspect_ratios.size() ? "X0 %g" : "biaxial",
                  row < aspect_ratios.size() ? aspect_ratios[row] : 0.0);
    print_row(name, shapes, solved);
    all.pairs += solved.pairs;
    all.seeds += solved.seeds;
    for (std::size_t k = 0; k < 2; ++k) {
      all.right[k] += solved.right[k];
      all.wrong[k] += solved.wrong[k];
    }
  }
  print_row(name, "all", all);
  for (std::size_t k = 0; k < 2; ++k) {
    EXPECT_EQ(all.wrong[k], 0) << name;
    EXPECT_GE(all.right[k], least_share[k] * all.pairs) << name;
  }
  return all;
}

TEST(SeedsOracle, NewtonSolvesSeparatedPairsFromEverySeed) {
  std::printf("%-8s %-8s %7s %9s %11s %11s %6s\n", "seed", "shapes", "pairs", "usable", "newton8", "newton5", "wrong");
  const auto fcl = [](auto&... pair) { return fcl_seed(pair...); };
  const auto ccd = [](auto&... pair) { return ccd_seed(pair...); };
  const auto centres = [](auto&... pair) { return centre_seed(pair...); };
  const auto dual = [](auto&... pair) { return dual_seed(pair...); };
  expect_solved("fcl", scaled(100'000, 100'000), {0.99, 0.99}, fcl);
#if HARDBODY_WITH_CGAL
  const auto cgal = [](auto&... pair) { return cgal_seed(pair...); };
  expect_solved("cgal", scaled(4'000, 100'000), {0.99, 0.99}, cgal);
#endif
  expect_solved("ccd", scaled(10'000, 100'000), {0.99, 0.99}, ccd);
  expect_solved("centres", scaled(10'000, 100'000), {0.99, 0.95}, centres);
  expect_solved("dual", scaled(10'000, 100'000), {1.0, 1.0}, dual);
}

}  // namespace
}  // namespace geom
