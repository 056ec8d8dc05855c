#pragma once

/// Point of a convex set closest to the origin, by the algorithm of Gilbert, Johnson and Keerthi (IEEE J. Robotics
/// Autom. 4 (1988) 193), for bodies that are apart but whose support points jump: cylinders side by side, flat faces.
///
/// The set is B - A. Each step takes the closest point x of the convex hull of up to four of its points, and adds the
/// point of the set that has the smallest component along x. |x| is an upper bound of the distance, because the hull is
/// inside the set; the gap across n = x / |x| is a lower one.

#include <geom/kernel/dual_newton.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <initializer_list>
#include <limits>

namespace geom::kernel {

/// Point of B - A and the points of A and B that it comes from, both relative to A's centre.
struct DifferencePoint {
  Eigen::Vector3d a = Eigen::Vector3d::Zero();
  Eigen::Vector3d b = Eigen::Vector3d::Zero();
  Eigen::Vector3d p() const { return b - a; }
};

/// Convex combination of up to three points.
struct Simplex {
  std::array<DifferencePoint, 4> point;
  std::array<double, 4> weight{};
  int count = 0;

  DifferencePoint closest() const {
    DifferencePoint x;
    for (std::size_t k = 0; k < static_cast<std::size_t>(count); ++k) {
      x.a += weight[k] * point[k].a;
      x.b += weight[k] * point[k].b;
    }
    return x;
  }
};

/// Computes the weights of the point of a triangle's plane closest to the origin; returns false if one is negative, or
/// the triangle is degenerate.
inline bool foot(const Eigen::Vector3d& p, const Eigen::Vector3d& q, const Eigen::Vector3d& r, double& u, double& v,
                 double& w) {
  const Eigen::Vector3d d = q - p;
  const Eigen::Vector3d e = r - p;
  const Eigen::Vector3d normal = d.cross(e);
  const double area2 = normal.squaredNorm();
  if (!(area2 > 1e-28 * d.squaredNorm() * e.squaredNorm())) return false;
  v = -p.cross(e).dot(normal) / area2;
  w = -d.cross(p).dot(normal) / area2;
  u = 1 - v - w;
  return u >= 0 && v >= 0 && w >= 0;
}

/// Keeps the points that span the face closest to the origin, by trying all faces of up to three points.
inline void reduce(Simplex& s) {
  Simplex best;
  double least = std::numeric_limits<double>::infinity();
  const auto consider = [&](std::initializer_list<int> chosen, std::initializer_list<double> weights) {
    Simplex face;
    auto weight = weights.begin();
    for (const int k : chosen) {
      face.point[static_cast<std::size_t>(face.count)] = s.point[static_cast<std::size_t>(k)];
      face.weight[static_cast<std::size_t>(face.count++)] = *weight++;
    }
    const double distance2 = face.closest().p().squaredNorm();
    if (!(distance2 < least)) return;
    least = distance2;
    best = face;
  };
  const auto p = [&s](int k) { return s.point[static_cast<std::size_t>(k)].p(); };
  for (int i = 0; i < s.count; ++i) {
    consider({i}, {1.0});
    for (int j = i + 1; j < s.count; ++j) {
      const Eigen::Vector3d d = p(j) - p(i);
      const double t = -p(i).dot(d) / d.squaredNorm();
      if (t > 0 && t < 1) consider({i, j}, {1 - t, t});
      for (int k = j + 1; k < s.count; ++k) {
        double u, v, w;
        if (foot(p(i), p(j), p(k), u, v, w)) consider({i, j, k}, {u, v, w});
      }
    }
  }
  s = best;
}

struct SimplexAnswer {
  DifferencePoint closest;                      ///< closest point, with the points of both bodies
  Eigen::Vector3d n = Eigen::Vector3d::Zero();  ///< normal of the best lower bound
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  int iterations = 0;
};

/// Runs the algorithm; `pair.support_pair(n)` and `pair.r()` are as for solve_dual. Ends when the bounds are
/// `tolerance` apart or improve no more; upper = 0: the bodies overlap. Where each step brings the bounds ten times
/// closer, as on flat faces, it goes on to `fine` <= tolerance.
template <class Pair>
SimplexAnswer descend(const Pair& pair, const Eigen::Vector3d& start, double tolerance, double fine) {
  constexpr int kMostSteps = 300;
  constexpr int kPatience = 8;
  constexpr double kFast = 0.1;
  SimplexAnswer answer;
  Simplex simplex;
  Eigen::Vector3d n = start;
  int idle = 0;
  double last = std::numeric_limits<double>::infinity();
  while (answer.iterations < kMostSteps && idle < kPatience) {
    ++answer.iterations;
    ++idle;
    const SupportPair s = pair.support_pair(n);
    const double g = (n.dot(pair.r()) - s.h_a) - s.h_b;
    if (g > answer.lower) {
      answer.lower = g;
      answer.n = n;
      idle = 0;
    }
    simplex.point[static_cast<std::size_t>(simplex.count++)] = {s.s_a, pair.r() + s.s_b};
    reduce(simplex);
    const DifferencePoint closest = simplex.closest();
    const double length = closest.p().norm();
    if (length < answer.upper) {
      answer.upper = length;
      answer.closest = closest;
      idle = 0;
    }
    const double open = answer.upper - answer.lower;
    if (!(length > 0) || open <= fine || (open <= tolerance && !(open <= kFast * last))) break;
    last = open;
    n = closest.p() / length;
  }
  return answer;
}

/// Pair whose body B is somewhere else.
template <class Pair>
struct MovedPair {
  const Pair& pair;
  Eigen::Vector3d moved;

  SupportPair support_pair(const Eigen::Vector3d& n) const { return pair.support_pair(n); }
  const Eigen::Vector3d& r() const { return moved; }
};

/// Normal of overlapping bodies, the gap across it, and points that belong to it, to a mismatch.
struct MatchingPoints {
  Eigen::Vector3d n;
  double gap;
  DifferencePoint at;
  double mismatch = std::numeric_limits<double>::infinity();
};

/// Returns the points of overlapping bodies, where support points jump, that are apart along the normal by the gap.
/// `n`: a normal that is nearly the best one.
///
/// Moved apart along the normal, the bodies have the same closest features (the proximal point method for the largest
/// gap). Bounds that agree to rounding leave an error of its square root in the points, the less the nearer the bodies
/// are, and in the normal, the less the further apart they are.
template <class Pair>
MatchingPoints match_points(const Pair& pair, double size, const Eigen::Vector3d& n, int& iterations) {
  constexpr int kMostMoves = 12;
  constexpr double kNearer = 1e-2;
  constexpr double kSlow = 0.1;
  constexpr double kRounding = 1e-15;
  const auto gap_across = [&](const Eigen::Vector3d& m) {
    const SupportPair s = pair.support_pair(m);
    ++iterations;
    return (m.dot(pair.r()) - s.h_a) - s.h_b;
  };
  MatchingPoints best{n, gap_across(n), {}};
  Eigen::Vector3d normal = n;
  double gap = best.gap;
  double distance = 0.5 * size;
  double last = best.mismatch;
  for (int move = 0; move < kMostMoves && distance > kRounding * size; ++move) {
    const Eigen::Vector3d way = (distance - gap) * normal;
    const SimplexAnswer far =
        descend(MovedPair<Pair>{pair, pair.r() + way}, normal, kRounding * size, kRounding * size);
    iterations += far.iterations;
    const double length = far.closest.p().norm();
    if (!(length > 0)) break;
    const Eigen::Vector3d turned = far.closest.p() / length;
    const double across = gap_across(turned);
    if (across >= gap - kRounding * size) {
      normal = turned;
      gap = across;
    }
    const double mismatch = (far.closest.p() - way - gap * normal).norm();
    if (mismatch < best.mismatch) best = {normal, gap, {far.closest.a, far.closest.b - way}, mismatch};
    if (mismatch <= kRounding * size) break;
    if (!(mismatch < kSlow * last)) distance *= kNearer;
    last = mismatch;
  }
  return best;
}

}  // namespace geom::kernel
