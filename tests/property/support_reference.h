#pragma once

/// Pairs of superellipsoids in motion, and the reference search for their contacts (support_contact_test.cpp).

#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <contact/certified.h>
#include <contact/support_gap.h>

#include <geom/geom.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>

namespace ed::internal {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::Superellipsoid;
using geom_test::PairSet;
using geom_test::Random;

inline constexpr double kShortest = 2e-5;   ///< the least step of the reference, in units of size over the largest rate
inline constexpr int kHalvings = 4;         ///< halvings of such a step
inline constexpr double kGrazing = 1e-2;    ///< normal velocity below this share of the relative one
inline constexpr double kResolved = 1e-12;  ///< overlaps below this, in units of the size, are rounding
inline constexpr double kHorizon = 3;

struct MovingPair {
  Superellipsoid shape_a, shape_b;
  RigidMotion a, b;
  bool touching = false;  ///< true if they touch at the start, and part

  double size() const { return shape_a.bounding_radius() + shape_b.bounding_radius(); }
  geom::DistanceResult distance(double t, const Vector3d& start = Vector3d::Zero()) const {
    const geom::Pose X_WA(a.top.at(t).R, a.position_at(t));
    const geom::Pose X_WB(b.top.at(t).R, b.position_at(t));
    return geom::distance(shape_a, X_WA, shape_b, X_WB, {.start = start});
  }
  /// A bound of |dd/dt|.
  double rate() const {
    return (b.velocity - a.velocity).norm() + shape_a.bounding_radius() * a.top.max_omega() +
           shape_b.bounding_radius() * b.top.max_omega();
  }
};

inline double exponent(Random& random) {
  constexpr std::array kExponents{0.25, 0.3, 0.5, 0.7, 0.9, 1.3, 1.6};
  return kExponents[static_cast<std::size_t>(random.uniform() * kExponents.size())];
}

inline Superellipsoid random_shape(Random& random) {
  constexpr std::array<std::array<double, 3>, 4> kAxes{{{1, 1, 1}, {1, 1, 2}, {1, 1, 0.5}, {1, 0.8, 0.6}}};
  const auto& a = kAxes[static_cast<std::size_t>(random.uniform() * kAxes.size())];
  const double e1 = exponent(random);
  return Superellipsoid({a[0], a[1], a[2]}, e1, random.coin() ? e1 : exponent(random));
}

inline Vector3d thermal(Random& random) {
  return random.uniform(0.2, 3) * random.direction();
}

/// A body of a pair: shape and moments of inertia.
struct Kind {
  Superellipsoid shape;
  Vector3d inertia;
};

inline Kind of_uniform_density(const Superellipsoid& shape) {
  return {shape, shape.inertia(1)};
}

/// A gap to start with: of bodies in touch a rounding error.
inline double first_gap(Random& random, bool touching, bool grazes, double size) {
  if (touching) return std::floor(random.uniform(-1, 2)) * 1e-15 * size;
  return grazes ? random.log_uniform(1e-9, 1e-2) : random.log_uniform(1e-6, 1);
}

/// A face of B on one of A, parallel to the last bit but one, as in lattices; turned about the normal or not.
inline geom_test::Orientation parallel_faces(Random& random) {
  geom_test::Orientation o{random.pose(0).rotation(), Matrix3d::Identity(), Vector3d::Zero()};
  const int k = static_cast<int>(3 * random.uniform());
  o.n = o.R_a.col(k);
  const double angle = random.coin() ? 0 : random.uniform(0, 3);
  o.R_b = Eigen::AngleAxisd(angle, o.n).toRotationMatrix() * o.R_a;
  return o;
}

/// Draws bodies near each other. Grazing ones have a normal relative velocity of 1e-6 to 1e-1.
inline MovingPair random_pair(Random& random, const Kind& A, const Kind& B) {
  const auto set = static_cast<PairSet>(static_cast<int>(5 * random.uniform()));
  const bool parallel = set == PairSet::faces && random.uniform() < 0.3;
  const geom_test::Orientation o = parallel ? parallel_faces(random) : geom_test::choose(set, A.shape, B.shape, random);
  geom::Pose X_WA, X_WB;
  const bool touching = random.uniform() < 0.2;
  const bool grazes = random.uniform() < 0.7;
  const double size = A.shape.bounding_radius() + B.shape.bounding_radius();
  geom_test::place(o, A.shape, B.shape, first_gap(random, touching, grazes, size), X_WA, X_WB);
  MovingPair pair{A.shape, B.shape, {}, {}, touching};
  Vector3d v = thermal(random);
  const double turning = random.coin() ? 1.0 : random.log_uniform(1e-3, 1);
  pair.a.position = X_WA.position();
  pair.b.position = X_WB.position();
  const auto spin = [&](const Matrix3d& R, const Vector3d& inertia) {
    const Vector3d w = thermal(random).cwiseQuotient(inertia.cwiseSqrt());
    return Vector3d(turning * (R * w));
  };
  pair.a.top = FreeTop(A.inertia, X_WA.rotation(), spin(X_WA.rotation(), A.inertia));
  pair.b.top = FreeTop(B.inertia, X_WB.rotation(), spin(X_WB.rotation(), B.inertia));
  if (grazes || touching) {
    // The contact points approach each other slowly, or part.
    const Vector3d p_a = o.R_a * A.shape.support(o.R_a.transpose() * o.n).point;
    const Vector3d p_b = o.R_b * B.shape.support(o.R_b.transpose() * -o.n).point;
    const Vector3d relative = v + pair.b.top.at(0).omega.cross(p_b) - pair.a.top.at(0).omega.cross(p_a);
    const double parting = touching        ? random.log_uniform(1e-5, 1) * relative.norm()
                           : random.coin() ? random.log_uniform(1e-6, 1e-1)
                                           : -random.log_uniform(1e-6, 1e-1);
    v += (parting - relative.dot(o.n)) * o.n;
  }
  pair.b.velocity = v;
  return pair;
}

inline MovingPair random_pair(Random& random, const Superellipsoid& shape) {
  return random_pair(random, of_uniform_density(shape), of_uniform_density(shape));
}

inline MovingPair random_equal_pair(Random& random) {
  return random_pair(random, random_shape(random));
}

inline MovingPair random_pair_apart(Random& random) {
  MovingPair pair = random_equal_pair(random);
  while (pair.touching) pair = random_equal_pair(random);
  return pair;
}

/// An ellipsoid or a superellipsoid of any size, with the moments of some distribution of mass.
inline Kind random_kind(Random& random, double smallest) {
  const double size = random.log_uniform(smallest, 1);
  const double e1 = random.uniform() < 0.4 ? 1 : exponent(random);
  const double e2 = e1 == 1 || random.coin() ? e1 : exponent(random);
  const Superellipsoid shape(size * Vector3d(1, random.log_uniform(0.25, 1), random.log_uniform(0.25, 4)), e1, e2);
  const Vector3d uniform = shape.inertia(1);
  // Mean squares along the axes; moments of any of these are those of a body.
  Vector3d squares = Vector3d::Constant(0.5 * uniform.sum()) - uniform;
  for (int k = 0; k < 3; ++k) squares[k] *= random.uniform(0.3, 1.5);
  return {shape, Vector3d::Constant(squares.sum()) - squares};
}

/// The least distance near t, by golden sections of [t - h, t + h]; `at` is where.
inline double least_distance(const MovingPair& pair, double begin, double end, double& at) {
  constexpr double kGolden = 0.61803398874989485;
  double m = end - kGolden * (end - begin);
  double p = begin + kGolden * (end - begin);
  double d_m = pair.distance(m).distance;
  double d_p = pair.distance(p).distance;
  for (int k = 0; k < 40; ++k) {
    if (d_m < d_p) {
      end = p;
      p = m;
      d_p = d_m;
      m = end - kGolden * (end - begin);
      d_m = pair.distance(m).distance;
    } else {
      begin = m;
      m = p;
      d_m = d_p;
      p = begin + kGolden * (end - begin);
      d_p = pair.distance(p).distance;
    }
  }
  at = m;
  return std::min(d_m, d_p);
}

/// The first time in (begin, end) that bisection finds at which the bodies overlap, or infinity: intervals are halved
/// kHalvings times as long as the distances at their ends, which change by no more than `rate`, leave room for it.
inline double dip(const MovingPair& pair, double rate, double begin, double d_begin, double end, double d_end,
                  int halvings = kHalvings) {
  const double overlap = -kResolved * pair.size();
  if (halvings == 0 || 0.5 * (d_begin + d_end - rate * (end - begin)) >= overlap) {
    return std::numeric_limits<double>::infinity();
  }
  const double middle = 0.5 * (begin + end);
  const double d = pair.distance(middle).distance;
  const double before = dip(pair, rate, begin, d_begin, middle, d, halvings - 1);
  if (before < end) return before;
  return d < overlap ? middle : dip(pair, rate, middle, d, end, d_end, halvings - 1);
}

/// A time at which the bodies overlap by more than kResolved, or infinity: the first that steps of the distance over
/// its largest rate find, which are never shorter than kShortest; where one was that long, bisection of it; or a
/// minimum between three of them.
inline double reference(const MovingPair& pair, double t_end) {
  const double rate = pair.rate();
  const double overlap = -kResolved * pair.size();
  const double shortest = kShortest * pair.size() / rate;
  double t = 0, t1 = 0, t2 = 0, d1 = 0, d2 = 0;
  while (t < t_end) {
    const double d = pair.distance(t).distance;
    if (t > 0) {
      const double between = dip(pair, rate, t1, d1, t, d);
      if (between < t) return between;
    }
    if (d < overlap) return t;
    double at;
    const bool near = d1 < 2 * rate * shortest;
    if (d1 < d2 && d1 <= d && near && least_distance(pair, t2, t, at) < overlap) return at;
    t2 = t1;
    d2 = d1;
    t1 = t;
    d1 = d;
    t += std::max(0.999 * d / rate, shortest);
  }
  return std::numeric_limits<double>::infinity();
}

}  // namespace ed::internal
