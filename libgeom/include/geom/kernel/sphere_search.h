#pragma once

/// Bounds of the largest value of g(n) = n.r - hA(n) - hB(-n) over the whole sphere, by branch and bound.
///
/// Deep overlaps have several local maxima, and no local property distinguishes the largest. But -g is the support
/// function of the Minkowski difference of the bodies, so that every point p of the difference bounds g everywhere:
/// g(n) <= n.p. The point p(m) = r - sA(m) + sB(-m) does so with equality at n = m. If a ball of radius rho rolls
/// freely inside the difference (rho: the sum of both smallest radii of curvature), -g - rho is a support function,
/// too:
///
///     g(n) <= n.(p(m) + rho m) - rho
///
/// is sharper: its error is (R - rho) theta^2 / 2 at the angle theta from m, R the local radius of curvature.
///
/// The sphere is divided into spherical triangles. In a triangle with corners n_i, every unit n is a convex combination
/// of them divided by its length, which is between c, the distance of their plane from the origin, and 1; so n.q is at
/// most max n_i.q, divided by c if that is positive, and at most |q| anyway. The bound of a triangle is the smallest
/// over the points q of its corners and of the best normal found so far. A triangle whose bound is not above the best
/// value is done; others are halved.
///
/// Across a ridge of g, which belongs to a face of the difference, p(m) jumps, and each of the points bounds one side
/// only. A point between two of them, or in the triangle of three, bounds both sides, because the difference is convex.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

namespace geom::kernel {

/// Value of g at a unit normal, and the point p that bounds it elsewhere: p(n), or any other for which the ball of
/// radius rho about p + rho n is in the Minkowski difference.
struct Tangent {
  Eigen::Vector3d n;
  Eigen::Vector3d p;
  double g;
};

/// Returns the highest of some normals near n along v, a unit vector across n; n itself if none of them has a g that is
/// higher by more than `rounding`.
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

/// Heights of a point above three planes through the origin, n_i.q.
using Heights = Eigen::Vector3d;

/// Returns the minimum over the points between two points of the largest height; infinite if one of the two is the
/// best.
inline double least_between(const Heights& a, const Heights& b) {
  const Heights rise = b - a;
  double least = std::numeric_limits<double>::infinity();
  for (int i = 0; i < 3; ++i) {
    const int j = (i + 1) % 3;
    const double t = (a[i] - a[j]) / (rise[j] - rise[i]);  // the two are equal there
    if (t > 0 && t < 1) least = std::min(least, (a + t * rise).maxCoeff());
  }
  return least;
}

/// Returns the largest height of the point of the triangle of three whose heights are all equal; infinite if there is
/// none.
inline double equal_within(const Heights& a, const Heights& b, const Heights& c) {
  const Eigen::Vector3d shares(b.cross(c).sum(), c.cross(a).sum(), a.cross(b).sum());
  const double all = shares.sum();
  if (!(shares.minCoeff() / all > 0) || !(shares.maxCoeff() / all > 0)) return std::numeric_limits<double>::infinity();
  return ((shares[0] * a + shares[1] * b + shares[2] * c) / all).maxCoeff();
}

/// Returns the Tangent at the stationary point where climb(n) ends. If that is a saddle, as between symmetric bodies,
/// the climb continues from a normal beside it. `upward(n)` is a unit vector across n along which g curves upwards, or
/// zero.
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

/// Branch and bound over all normals. `sample(n)` returns the Tangent at n; `polish(n)` one at a local maximum uphill
/// of n, or at n.
template <class Sample, class Polish>
class SphereSearch {
 public:
  /// Constructs the search. `start`: a local maximum; `rounding`: increase of g that counts as higher.
  SphereSearch(const Sample& sample, const Polish& polish, double rho, const Tangent& start, double rounding)
      : sample_(sample), polish_(polish), rho_(rho), rounding_(rounding), best_(start) {}

  /// Searches for a normal with g > best().g + tolerance until none is left or `budget` samples are spent; for larger
  /// tolerances first, so that the budget is not spent on one corner of the sphere. Afterwards max g <= upper(), and
  /// best() is a local maximum, at least as high as every normal that was sampled.
  void run_to(double tolerance, int budget);

  const Tangent& best() const { return best_; }
  double upper() const { return upper_; }

 private:
  using Corners = std::array<Tangent, 3>;
  struct Cell {
    Corners corners;
    double above;  ///< a bound of g
  };

  void run(double tolerance, int last_sample);
  /// Returns a bound of g in a triangle, by single points at first, by more points while it is above `enough`.
  double bound(const Corners& corners, double enough) const;
  void consider(const Tangent& t, double tolerance);
  void consider_rival(const Tangent& t, double tolerance);
  void polish_best();
  void push(const Corners& corners, double tolerance);
  void halve(const Corners& corners, double tolerance);

  /// Halving n times makes a triangle's edges 2^(-n/2) as long, and leaves n siblings behind.
  static constexpr std::size_t kMostHalvings = 80;

  const Sample& sample_;
  const Polish& polish_;
  double rho_;
  double rounding_;
  Tangent best_;
  bool polished_ = true;  ///< whether best_ is a local maximum
  double upper_ = std::numeric_limits<double>::infinity();
  double pruned_ = 0;  ///< the largest bound among the triangles that are done
  std::array<Eigen::Vector3d, 16> rivals_;
  std::size_t rival_count_ = 0;
  bool finest_ = false;  ///< whether the tolerance is the requested one
  int samples_ = 0;
  std::array<Cell, kMostHalvings + 8> open_;
  std::size_t count_ = 0;
};

template <class Sample, class Polish>
double SphereSearch<Sample, Polish>::bound(const Corners& corners, double enough) const {
  const Eigen::Vector3d& n0 = corners[0].n;
  const Eigen::Vector3d& n1 = corners[1].n;
  const Eigen::Vector3d& n2 = corners[2].n;
  double by_c = 0;
  const auto over_cell = [&](double most) {
    if (!(most > 0)) return most;
    if (by_c == 0) {
      const Eigen::Vector3d across = (n1 - n0).cross(n2 - n0);
      by_c = across.norm() / std::abs(across.dot(n0));
    }
    return most * by_c;
  };
  std::array<Heights, 4> of;
  double least = std::numeric_limits<double>::infinity();
  for (std::size_t k = 0; k < of.size(); ++k) {
    const Tangent& t = k < corners.size() ? corners[k] : best_;
    const Eigen::Vector3d q = t.p + rho_ * t.n;
    of[k] = {n0.dot(q), n1.dot(q), n2.dot(q)};
    const double most = over_cell(of[k].maxCoeff());
    least = std::min(least, most > 0 ? std::min(most, q.norm()) : most);
  }
  const auto take = [&](double most) { least = std::min(least, over_cell(most)); };
  for (std::size_t k = 0; k < of.size() && least - rho_ > enough; ++k) {
    for (std::size_t l = 0; l < k; ++l) take(least_between(of[k], of[l]));
  }
  if (least - rho_ > enough) take(equal_within(of[0], of[1], of[2]));
  return least - rho_;
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::consider(const Tangent& t, double tolerance) {
  if (finest_) consider_rival(t, tolerance);
  if (!(t.g > best_.g + rounding_)) return;
  // An increase by less than the tolerance is not polished: one ascent at the end is enough.
  polished_ = t.g > best_.g + tolerance;
  best_ = t;
  if (polished_) polish_best();
}

/// Handles two maxima that differ by less than the tolerance, of which the search may have found the lower one. If it
/// has seen samples nearly as high near the other, it climbs from a few of those; near a sharp maximum it need not have
/// seen any.
template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::consider_rival(const Tangent& t, double tolerance) {
  constexpr double kNearlyAsHigh = 10;  // in units of the tolerance
  constexpr double kBeside = 3e-3;      // rad
  if (rival_count_ == rivals_.size() || !(t.g > best_.g - kNearlyAsHigh * tolerance)) return;
  const auto beside = [&](const Eigen::Vector3d& n) { return (n - t.n).squaredNorm() < kBeside * kBeside; };
  const std::span<const Eigen::Vector3d> rivals(rivals_.data(), rival_count_);
  if (beside(best_.n) || std::any_of(rivals.begin(), rivals.end(), beside)) return;
  rivals_[rival_count_++] = t.n;
  const Tangent top = polish_(t.n);
  if (!(top.g > best_.g + rounding_)) return;
  best_ = top;
  polished_ = true;
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::polish_best() {
  const Tangent polished = polish_(best_.n);
  if (polished.g > best_.g) {
    best_ = polished;
  } else if (polished.g >= best_.g - rounding_) {
    // The same ball bounds g around a maximum on a face, where p(n) is lost to rounding.
    best_.p = polished.p + rho_ * (polished.n - best_.n);
  }
  polished_ = true;
}

template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::push(const Corners& corners, double tolerance) {
  const double above = bound(corners, best_.g + tolerance);
  if (above > best_.g + tolerance && count_ < open_.size()) {
    open_[count_++] = {corners, above};
  } else {
    pruned_ = std::max(pruned_, above);
  }
}

/// Halves a triangle across its longest edge, so that triangles stay well shaped.
template <class Sample, class Polish>
void SphereSearch<Sample, Polish>::halve(const Corners& corners, double tolerance) {
  int k = 0;  // the corner opposite to that edge
  double longest = -1;
  for (int i = 0; i < 3; ++i) {
    const double edge2 =
        (corners[static_cast<std::size_t>((i + 1) % 3)].n - corners[static_cast<std::size_t>((i + 2) % 3)].n)
            .squaredNorm();
    if (edge2 > longest) {
      longest = edge2;
      k = i;
    }
  }
  const Tangent& apex = corners[static_cast<std::size_t>(k)];
  const Tangent& left = corners[static_cast<std::size_t>((k + 1) % 3)];
  const Tangent& right = corners[static_cast<std::size_t>((k + 2) % 3)];
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
    finest_ = coarser == 1;
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
    // The best may have grown since.
    if (cell.above > best_.g + tolerance) {
      halve(cell.corners, tolerance);
    } else {
      pruned_ = std::max(pruned_, cell.above);
    }
  }
  while (count_ > 0) pruned_ = std::max(pruned_, open_[--count_].above);
}

}  // namespace geom::kernel
