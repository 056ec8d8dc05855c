#pragma once

/// The largest value of g(n) = n.r - hA(n) - hB(-n) over the whole sphere, between two bounds: branch and bound.
///
/// Deep overlaps have several local maxima, and nothing local tells which is the largest. But -g is the support
/// function of the Minkowski difference of the bodies, so that every point p(m) = r - sA(m) + sB(-m) of its boundary
/// bounds g everywhere: g(n) <= n.p(m), with equality at n = m. If a ball of radius rho rolls freely inside the
/// difference (rho: the sum of both smallest radii of curvature), -g - rho is a support function too, and
///
///     g(n) <= n.(p(m) + rho m) - rho
///
/// is sharper: its error is (R - rho) theta^2 / 2 at the angle theta from m, R the local radius of curvature.
///
/// The sphere is cut into spherical triangles. Over one with corners n_i, every unit n is a convex combination of them
/// divided by its length, which is between c, the distance of their plane from the origin, and 1; so n.q is at most max
/// n_i.q, divided by c if that is positive, and at most |q| anyway. A triangle whose bound, the least over the points p
/// of its corners and of the best normal found so far, is not above the best value is done; others are halved.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace geom::internal {

/// g at a unit normal, and the point of the Minkowski difference that bounds it elsewhere.
struct Tangent {
  Eigen::Vector3d n;
  Eigen::Vector3d p;
  double g;
};

/// The highest of some normals beside n along v, a unit vector across n; n itself if g is higher at none of them by
/// more than `rounding`.
template <class Sample>
Eigen::Vector3d highest_beside(const Sample& sample, const Tangent& at, const Eigen::Vector3d& v, double rounding) {
  Eigen::Vector3d best = at.n;
  double highest = at.g + rounding;
  for (const double angle : {1e-1, 1e-2, 1e-3, 1e-4, 1e-5, 1e-6}) {
    for (const double way : {angle, -angle}) {
      const Eigen::Vector3d n = (at.n + way * v).normalized();
      const double g = sample(n).g;
      if (!(g > highest)) continue;
      best = n;
      highest = g;
    }
  }
  return best;
}

/// The Tangent that climb(n) ends at, a stationary point; where that is a saddle, as between symmetric bodies, it goes
/// on from beside it. `upward(n)` is a unit vector across n along which g bends upwards, or zero.
template <class Sample, class Climb, class Upward>
Tangent climb_over_saddles(const Sample& sample, const Climb& climb, const Upward& upward, const Eigen::Vector3d& n,
                           double rounding) {
  constexpr int kMostSaddles = 5;
  Tangent top = climb(n);
  for (int k = 0; k < kMostSaddles; ++k) {
    const Eigen::Vector3d v = upward(top.n);
    if (v.isZero(0)) break;
    const Eigen::Vector3d aside = highest_beside(sample, top, v, rounding);
    if (aside == top.n) break;
    const Tangent next = climb(aside);
    if (!(next.g > top.g)) break;
    top = next;
  }
  return top;
}

/// `sample(n)` returns the Tangent at n; `polish(n)` one at a local maximum uphill of n, or at n.
template <class Sample, class Polish>
class SphereSearch {
 public:
  /// `start`: a local maximum; `rounding`: by how much g must grow to be called higher.
  SphereSearch(const Sample& sample, const Polish& polish, double rho, const Tangent& start, double rounding)
      : sample_(sample), polish_(polish), rho_(rho), rounding_(rounding), best_(start) {}

  /// Looks for a normal with g > best().g + tolerance until none is left or `budget` samples are spent; for larger
  /// tolerances first, so that what is spent is not spent on one corner of the sphere. After it, max g <= upper(), and
  /// best() is a local maximum, as high as any normal that was looked at.
  void run_to(double tolerance, int budget);

  const Tangent& best() const { return best_; }
  double upper() const { return upper_; }

 private:
  using Cell = std::array<Tangent, 3>;

  void run(double tolerance, int last_sample);
  double bound(const Cell& cell) const;
  void consider(const Tangent& t, double tolerance);
  void polish_best();
  void push(const Cell& cell, double tolerance);
  void halve(const Cell& cell, double tolerance);

  /// Halving n times makes a triangle's edges 2^(-n/2) as long, and leaves n siblings behind.
  static constexpr std::size_t kMostHalvings = 80;

  const Sample& sample_;
  const Polish& polish_;
  double rho_;
  double rounding_;
  Tangent best_;
  bool polished_ = true;  ///< best_ is a local maximum
  double upper_ = std::numeric_limits<double>::infinity();
  double pruned_ = 0;  ///< the largest bound among the triangles that are done
  int samples_ = 0;
  std::array<Cell, kMostHalvings + 8> open_;
  std::size_t count_ = 0;
};

template <class Sample, class Polish>
double SphereSearch<Sample, Polish>::bound(const Cell& cell) const {
  const Eigen::Vector3d& n0 = cell[0].n;
  const Eigen::Vector3d& n1 = cell[1].n;
  const Eigen::Vector3d& n2 = cell[2].n;
  double least = std::numeric_limits<double>::infinity();
  double inverse_c = 0;
  for (const Tangent* t : {&cell[0], &cell[1], &cell[2], &best_}) {
    const Eigen::Vector3d q = t->p + rho_ * t->n;
    double most = std::max({n0.dot(q), n1.dot(q), n2.dot(q)});
    if (most > 0) {
      if (inverse_c == 0) {
        const Eigen::Vector3d across = (n1 - n0).cross(n2 - n0);
        inverse_c = across.norm() / std::abs(across.dot(n0));
      }
      most = std::min(most * inverse_c, q.norm());
    }
    least = std::min(least, most - rho_);
  }
  return least;
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::consider(const Tangent& t, double tolerance) {
  if (!(t.g > best_.g + rounding_)) return;
  // What is higher by less than the tolerance is kept as it is: one ascent at the end is enough.
  polished_ = t.g > best_.g + tolerance;
  best_ = t;
  if (polished_) polish_best();
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::polish_best() {
  const Tangent polished = polish_(best_.n);
  if (polished.g > best_.g) best_ = polished;
  polished_ = true;
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::push(const Cell& cell, double tolerance) {
  const double above = bound(cell);
  if (above > best_.g + tolerance && count_ < open_.size()) {
    open_[count_++] = cell;
  } else {
    pruned_ = std::max(pruned_, above);
  }
}

/// Across the longest edge, so that triangles stay well shaped.
template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::halve(const Cell& cell, double tolerance) {
  int k = 0;  // the corner opposite to that edge
  double longest = -1;
  for (int i = 0; i < 3; ++i) {
    const double edge2 =
        (cell[static_cast<std::size_t>((i + 1) % 3)].n - cell[static_cast<std::size_t>((i + 2) % 3)].n).squaredNorm();
    if (edge2 > longest) {
      longest = edge2;
      k = i;
    }
  }
  const Tangent& apex = cell[static_cast<std::size_t>(k)];
  const Tangent& left = cell[static_cast<std::size_t>((k + 1) % 3)];
  const Tangent& right = cell[static_cast<std::size_t>((k + 2) % 3)];
  const Tangent middle = sample_((left.n + right.n).normalized());
  ++samples_;
  consider(middle, tolerance);
  push({apex, left, middle}, tolerance);
  push({apex, middle, right}, tolerance);
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::run_to(double tolerance, int budget) {
  const int last_sample = samples_ + budget;
  for (const double coarser : {1e6, 1e4, 1e2, 1.0}) {
    if (samples_ >= last_sample) break;
    if (upper_ <= best_.g + coarser * tolerance) continue;
    run(coarser * tolerance, last_sample);
    upper_ = std::min(upper_, pruned_);
  }
  if (!polished_) polish_best();
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::run(double tolerance, int last_sample) {
  std::array<Tangent, 6> corners;
  for (int k = 0; k < 6; ++k) {
    corners[static_cast<std::size_t>(k)] = sample_((k % 2 == 0 ? 1 : -1) * Eigen::Vector3d::Unit(k / 2));
    ++samples_;
    consider(corners[static_cast<std::size_t>(k)], tolerance);
  }
  pruned_ = best_.g;
  count_ = 0;
  for (unsigned octant = 0; octant < 8; ++octant) {
    const unsigned x = octant & 1U;
    const unsigned y = 2 + ((octant >> 1U) & 1U);
    const unsigned z = 4 + (octant >> 2U);
    push({corners[x], corners[y], corners[z]}, tolerance);
  }
  while (count_ > 0 && samples_ < last_sample) {
    const Cell cell = open_[--count_];
    const double above = bound(cell);  // with what has been found since
    if (above > best_.g + tolerance) {
      halve(cell, tolerance);
    } else {
      pruned_ = std::max(pruned_, above);
    }
  }
  while (count_ > 0) pruned_ = std::max(pruned_, bound(open_[--count_]));
}

}  // namespace geom::internal
