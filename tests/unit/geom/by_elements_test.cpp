// Newton's method by contact elements: that it converges, to what, and in how few steps.

#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <geom/geom.h>
#include <geom/kernel/norm_body_pair.h>

#include <gtest/gtest.h>

#include <Eigen/Eigenvalues>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

namespace geom::kernel {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom_test::any_exponent;
using geom_test::PairSet;
using geom_test::Random;

/// One pair of a set, `gap` apart along o.n.
struct Query {
  geom_test::Orientation o;
  NormBodyPair pair;
  double g;  ///< gap along o.n as rounding has left it
};

Query query(PairSet set, double e1, double e2, double gap, Random& random) {
  const Superellipsoid shape({1, random.uniform(0.6, 1.6), random.uniform(0.4, 2.4)}, e1, e2);
  const geom_test::Orientation o = geom_test::choose(set, shape, random);
  Pose X_WA, X_WB;
  geom_test::place(o, shape, gap, X_WA, X_WB);
  const NormBodyPair pair(NormBodies(NormShape(shape), X_WA.rotation(), NormShape(shape), X_WB.rotation()),
                          X_WB.position(), 2 * shape.bounding_radius(), 2 * shape.inscribed_radius());
  return {o, pair, pair.sample(o.n).g};
}

constexpr std::array kSets{PairSet::random_normal, PairSet::random_point, PairSet::aligned, PairSet::edges,
                           PairSet::faces};

using FirstElements = NormBodyPair::FirstElements;
constexpr std::array kFirsts{FirstElements::supports, FirstElements::ellipsoids};

struct PaceTraits {
  NormBodyPair::Pace pace;
  int steps;
  int mean_steps;    ///< largest mean number of steps
  double bound;      ///< largest certified error, relative to the scale
  double tolerance;  ///< error of g, relative to the scale
};
constexpr std::array kPaces{PaceTraits{NormBodyPair::Pace::brisk, 24, 9, 1e-14, 4e-14},
                            PaceTraits{NormBodyPair::Pace::careful, 100, 30, kBoundGap, kBoundGap}};

/// Finds distances from cold, in few steps: where edges or faces meet the dual method takes tens of them, or none
/// helps. Adds up steps.
void expect_distances(PairSet set, FirstElements first, const PaceTraits& traits, int& all_iterations) {
  Random random(5);
  int declined = 0;
  int iterations = 0;
  int rounds = 0;  // pairs whose normals are well determined
  int sharp = 0;
  constexpr int kPairs = 4000;
  for (int k = 0; k < kPairs; ++k) {
    const double e1 = any_exponent(random);
    const double e2 = any_exponent(random);
    const bool round = std::max(e1, e2) <= 1 && std::min(e1, e2) >= 0.7;
    const double gap = random.log_uniform(1e-6, 1);
    const Query q = query(set, e1, e2, gap, random);
    const NormBodyPair::Answer answer =
        q.pair.by_elements(q.pair.cold_normal(), first, traits.pace, traits.steps, iterations);
    if (!answer.converged) {
      ++declined;
      continue;
    }
    const double scale = q.pair.scale();
    ASSERT_NEAR(answer.at.g, q.g, answer.gap + 4e-15 * scale);
    ASSERT_LT(answer.gap, traits.bound * scale);
    ASSERT_NEAR(q.pair.sample(answer.at.n).g, answer.at.g, traits.tolerance * scale);
    // The points are apart by g n, but for some of the square root of what g may be off by.
    const Vector3d mismatch = q.pair.between() + answer.points.b() - answer.points.a() - answer.at.g * answer.at.n;
    ASSERT_LT(mismatch.norm(), std::sqrt(4 * traits.tolerance * scale * (answer.at.g + traits.tolerance * scale)));
    rounds += round;
    sharp += round && (answer.at.n - q.o.n).norm() < 1e-12 && mismatch.norm() < 1e-12;
  }
  EXPECT_LE(declined, kPairs / 50);
  EXPECT_LE(iterations, traits.mean_steps * kPairs);
  all_iterations += iterations;
  EXPECT_GE(sharp, 0.9 * rounds) << "the last step takes normals and points from 1e-8 to rounding";
}

TEST(ByElements, ConvergeToTheDistance) {
  for (const PairSet set : kSets) {
    std::array<int, kFirsts.size()> iterations{};
    for (const FirstElements first : kFirsts) {
      for (const PaceTraits& traits : kPaces) {
        SCOPED_TRACE(testing::Message() << "set " << static_cast<int>(set) << ", first " << static_cast<int>(first)
                                        << ", up to " << traits.steps << " steps");
        expect_distances(set, first, traits, iterations[static_cast<std::size_t>(first)]);
      }
    }
    // What the start at the ellipsoids' points is for.
    const bool flat = set == PairSet::aligned || set == PairSet::faces;
    const auto [supports, ellipsoids] = iterations;
    EXPECT_LT(ellipsoids, (flat ? 0.9 : 1.2) * supports) << "set " << static_cast<int>(set);
  }
}

/// Returns by how much g is higher than the answer's, relative to the scale, at the best of 20 normals up to `reach`
/// from it; NaN if one of them is.
double gain_nearby(const Query& q, const NormBodyPair::Answer& answer, double reach, Random& random) {
  double gain = -1;
  for (int t = 0; t < 20; ++t) {
    const double turn = random.log_uniform(1e-3 * reach, reach);
    const Vector3d n = (answer.at.n + turn * random.direction()).normalized();
    const double here = (q.pair.sample(n).g - answer.at.g) / q.pair.scale();
    if (!(here <= gain)) gain = here;
  }
  return gain;
}

/// The least eigenvalue of -hess g along the sphere, relative to the scale: positive at a local maximum to second
/// order.
double curvature(const Query& q, const Vector3d& n) {
  const DualSample s = q.pair.sample(n);
  const LaneVector &t1 = s.support.t1, &t2 = s.support.t2;
  Matrix3d M = t1.a() * t1.a().transpose() + t2.a() * t2.a().transpose() + t1.b() * t1.b().transpose() +
               t2.b() * t2.b().transpose();
  // M vanishes along n: there the eigenvalue is made larger than those across.
  M += (1 + M.trace()) * n * n.transpose();
  return (Eigen::SelfAdjointEigenSolver<Matrix3d>(M).eigenvalues()[0] + s.g) / q.pair.scale();
}

/// Returns how far n is from the axis planes of both bodies. Beyond such a plane a vertex has another curvature.
double plane_distance(const geom_test::Orientation& o, const Vector3d& n) {
  return std::min((o.R_a.transpose() * n).cwiseAbs().minCoeff(), (o.R_b.transpose() * n).cwiseAbs().minCoeff());
}

/// No normal nearby is better: the depth is a local minimum. Where vertices meet (`faces` for exponents above 1) a few
/// pairs have a lower one within 1e-3, across an axis plane; theirs are local minima all the same, to second order and
/// as far as the plane.
void expect_local_depths(PairSet set, FirstElements first) {
  Random random(1);
  int declined = 0;
  int beside_others = 0;
  int iterations = 0;
  constexpr int kPairs = 8000;
  for (int k = 0; k < kPairs; ++k) {
    const double e1 = any_exponent(random);
    const double e2 = any_exponent(random);
    const double depth = random.log_uniform(1e-6, 0.1);
    const Query q = query(set, e1, e2, -depth, random);
    const NormBodyPair::Answer answer =
        q.pair.by_elements(q.pair.cold_normal(), first, NormBodyPair::Pace::brisk, 24, iterations);
    if (!answer.converged) {
      ++declined;
      continue;
    }
    ASSERT_LT(answer.at.g, 0);
    const double gain = gain_nearby(q, answer, 1e-3, random);
    ASSERT_FALSE(std::isnan(gain));
    if (gain <= 4e-14) continue;
    ++beside_others;
    const double to_plane = plane_distance(q.o, answer.at.n);
    ASSERT_GT(to_plane, 1e-6);
    ASSERT_LE(gain_nearby(q, answer, 0.3 * to_plane, random), 4e-15);
    ASSERT_GT(curvature(q, answer.at.n), 1e-6);
  }
  EXPECT_LE(declined, kPairs / 50) << "set " << static_cast<int>(set);
  EXPECT_LE(beside_others, set == PairSet::faces ? 3 : 0) << "set " << static_cast<int>(set);
}

TEST(ByElements, ConvergeToALocalDepth) {
  for (const PairSet set : kSets) {
    for (const FirstElements first : kFirsts) {
      SCOPED_TRACE(testing::Message() << "first " << static_cast<int>(first));
      expect_local_depths(set, first);
    }
  }
}

/// Whether it has converged or not, an answer's g is that of its normal.
TEST(ByElements, GiveANormalWithEveryBound) {
  for (const FirstElements first : kFirsts) {
    Random random(8);
    int unconverged = 0;
    int iterations = 0;
    for (int k = 0; k < 4000; ++k) {
      const double e2 = any_exponent(random);
      const double gap = random.log_uniform(1e-6, 1);
      const Query q = query(PairSet::edges, 0.2, e2, gap, random);
      const NormBodyPair::Answer answer =
          q.pair.by_elements(q.pair.cold_normal(), first, NormBodyPair::Pace::brisk, 4 + k % 8, iterations);
      ASSERT_NEAR(answer.at.n.norm(), 1, 1e-15);
      if (answer.converged || std::isinf(answer.at.g)) continue;
      ++unconverged;
      ASSERT_NEAR(q.pair.sample(answer.at.n).g, answer.at.g, 1e-14 * q.pair.scale());
    }
    EXPECT_GT(unconverged, 20) << "first " << static_cast<int>(first);
  }
}

/// A ball in an octahedron, on its axis: the way out along that, over the vertex, is stationary by symmetry, and the
/// longest.
TEST(ByElements, DoNotStopOnASaddle) {
  const Ellipsoid ball({1, 1, 1});
  const Superellipsoid octahedron({1, 1, 1}, 1.6, 1.6);
  const Vector3d r(0, 0, 0.3);
  const NormBodyPair pair(
      NormBodies(NormShape(ball), Matrix3d::Identity(), NormShape(octahedron), Matrix3d::Identity()), r, 2,
      1 + octahedron.inscribed_radius());
  for (const FirstElements first : kFirsts) {
    int iterations = 0;
    EXPECT_FALSE(pair.by_elements(Vector3d::UnitZ(), first, NormBodyPair::Pace::brisk, 24, iterations).converged);
  }
  const DistanceResult result =
      distance(ball, Pose(), octahedron, Pose::translation(r), {.penetration = Penetration::local});
  EXPECT_EQ(result.status, DistanceStatus::overlapping);
  EXPECT_GT(result.distance, -1.69);
}

/// Shorter steps mostly end where the fast ones have not.
TEST(ByElements, ConvergeInShorterSteps) {
  Random random(7);
  int hard = 0;
  int declined = 0;
  int iterations = 0;
  for (int k = 0; k < 20000; ++k) {
    const Query q = query(PairSet::edges, 0.2, 0.2, random.log_uniform(1e-6, 1), random);
    const Vector3d start = q.pair.cold_normal();
    if (q.pair.by_elements(start, FirstElements::supports, NormBodyPair::Pace::brisk, 24, iterations).converged)
      continue;
    ++hard;
    declined +=
        !q.pair.by_elements(start, FirstElements::supports, NormBodyPair::Pace::careful, 100, iterations).converged;
  }
  EXPECT_GT(hard, 50);
  EXPECT_LE(declined, hard / 4);
}

}  // namespace
}  // namespace geom::kernel
