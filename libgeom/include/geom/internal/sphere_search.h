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

/// `sample(n)` returns the Tangent at n; `polish(n)` one at a local maximum uphill of n, or at n.
template <class Sample, class Polish>
class SphereSearch {
 public:
  SphereSearch(const Sample& sample, const Polish& polish, double rho, const Tangent& start)
      : sample_(sample), polish_(polish), rho_(rho), best_(start) {}

  /// Looks for a normal with g > best().g + tolerance until none is left or `budget` samples are spent; for larger
  /// tolerances first, so that what is spent is not spent on one corner of the sphere. After it, max g <= upper().
  void run_to(double tolerance, int budget);

  const Tangent& best() const { return best_; }
  double upper() const { return upper_; }
  int samples() const { return samples_; }

 private:
  using Cell = std::array<Tangent, 3>;

  void run(double tolerance, int last_sample);
  double bound(const Cell& cell) const;
  void consider(const Tangent& t, double tolerance);
  void push(const Cell& cell, double tolerance);
  void halve(const Cell& cell, double tolerance);

  /// Halving n times makes a triangle's edges 2^(-n/2) as long, and leaves n siblings behind.
  static constexpr std::size_t kMostHalvings = 80;

  const Sample& sample_;
  const Polish& polish_;
  double rho_;
  Tangent best_;
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
  if (!(t.g > best_.g + tolerance)) return;
  const Tangent polished = polish_(t.n);
  best_ = polished.g > t.g ? polished : t;
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
    if (samples_ >= last_sample) return;
    if (upper_ <= best_.g + coarser * tolerance) continue;
    run(coarser * tolerance, last_sample);
    upper_ = std::min(upper_, pruned_);
  }
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
