#include "cores/rims.h"

#include <geom/distance.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <limits>
#include <utility>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;

constexpr int kMostUnknowns = 8;  // n, d, two angles, two weights

/// Linear equations of up to kMostUnknowns unknowns.
class SmallSystem {
 public:
  explicit SmallSystem(std::size_t size) : size_(size) {
    for (std::size_t i = 0; i < size; ++i) row_[i].fill(0);
  }
  double& operator()(std::size_t i, std::size_t j) { return row_[i][j]; }
  double& right(std::size_t i) { return row_[i][kMostUnknowns]; }

  /// Solves by elimination with pivots, into right(); returns false if the equations are singular.
  bool solve() {
    for (std::size_t k = 0; k < size_; ++k) {
      std::size_t pivot = k;
      for (std::size_t i = k + 1; i < size_; ++i) {
        if (std::abs(row_[i][k]) > std::abs(row_[pivot][k])) pivot = i;
      }
      if (!(std::abs(row_[pivot][k]) > 0)) return false;
      if (pivot != k) std::swap(row_[pivot], row_[k]);
      for (std::size_t i = k + 1; i < size_; ++i) {
        const double factor = row_[i][k] / row_[k][k];
        if (factor == 0) continue;
        for (std::size_t j = k + 1; j < size_; ++j) row_[i][j] -= factor * row_[k][j];
        right(i) -= factor * right(k);
      }
    }
    for (std::size_t k = size_; k-- > 0;) {
      for (std::size_t j = k + 1; j < size_; ++j) right(k) -= row_[k][j] * right(j);
      right(k) /= row_[k][k];
    }
    return true;
  }

 private:
  std::size_t size_;
  std::array<std::array<double, kMostUnknowns + 1>, kMostUnknowns> row_;
};

/// Rims of one body of a simplex: their common direction, if they slide.
struct Rims {
  bool slides = false;
  Vector3d e = Vector3d::Zero();  // from the middle of the disc to the point of the rim
  Vector3d t = Vector3d::Zero();  // along the rim

  void turn(const RoundCore& core, double angle) {
    e = core.across(std::cos(angle) * e + std::sin(angle) * t);
    t = core.axis().cross(e);
  }
};

/// Returns the rims' direction: that of the weighted mean, unless a point is far from it.
Rims rims_of(const RoundCore& core, const CoreSimplex& s, Vector3d DifferenceVertex::*point,
             int DifferenceVertex::*id) {
  Rims rims;
  if (!core.round()) return rims;
  constexpr double kNear = 0.5;  // cosine
  Vector3d sum = Vector3d::Zero();
  for (std::size_t k = 0; k < s.count; ++k) {
    sum += std::max(s.weight[k], 1e-3) * (s.vertex[k].*point - core.middle(s.vertex[k].*id));
  }
  if (!(sum.squaredNorm() > 0)) return rims;
  rims.e = core.across(sum);
  for (std::size_t k = 0; k < s.count; ++k) {
    const double radius = core.radius(s.vertex[k].*id);
    if (radius == 0) continue;
    if (!((s.vertex[k].*point - core.middle(s.vertex[k].*id)).dot(rims.e) > kNear * radius)) return rims;
    rims.slides = true;
  }
  rims.t = core.axis().cross(rims.e);
  return rims;
}

/// The search of slide() for a given set of vertices.
class Slide {
 public:
  Slide(const RoundCore& a, const RoundCore& b, double size, const CoreSimplex& simplex, const Vector3d& n)
      : a_(a),
        b_(b),
        size_(size),
        rims_a_(rims_of(a, simplex, &DifferenceVertex::a, &DifferenceVertex::id_a)),
        rims_b_(rims_of(b, simplex, &DifferenceVertex::b, &DifferenceVertex::id_b)),
        n_(n) {
    for (std::size_t k = 0; k < simplex.count; ++k) add(simplex.vertex[k], simplex.weight[k]);
    place();
  }

  bool slides() const { return rims_a_.slides || rims_b_.slides; }

  /// Searches; drops a vertex whose weight becomes negative.
  bool run(Vector3d& rival) {
    while (true) {
      if (!converge()) return false;
      std::size_t least = 0;
      for (std::size_t k = 1; k < count_; ++k) {
        if (weight_[k] < weight_[least]) least = k;
      }
      if (weight_[least] >= -kNoWeight) break;
      if (weight_[least] >= -kLittleWeight) rival = n_;
      drop(least);
    }
    return !(rims_a_.slides && n_.dot(rims_a_.e) < -kAcross) && !(rims_b_.slides && n_.dot(rims_b_.e) > kAcross);
  }

  void take(CoreSimplex& simplex, Vector3d& n) const {
    simplex.count = count_;
    for (std::size_t k = 0; k < count_; ++k) {
      simplex.vertex[k] = vertex_[k];
      simplex.weight[k] = std::max(0.0, weight_[k]);
    }
    simplex.closest = closest();
    simplex.squared = simplex.closest.squaredNorm();
    n = n_;
  }

 private:
  static constexpr double kNoWeight = 1e-14;
  static constexpr double kLittleWeight = 1e-6;
  static constexpr double kAcross = 1e-9;

  void add(const DifferenceVertex& v, double weight) {
    for (std::size_t k = 0; k < count_; ++k) {
      const DifferenceVertex& w = vertex_[k];
      const bool same_a = v.id_a == w.id_a && (rims_a_.slides || v.a == w.a);
      const bool same_b = v.id_b == w.id_b && (rims_b_.slides || v.b == w.b);
      if (same_a && same_b) {
        weight_[k] += weight;
        return;
      }
    }
    vertex_[count_] = v;
    weight_[count_++] = weight;
  }

  void drop(std::size_t k) {
    --count_;
    for (; k < count_; ++k) {
      vertex_[k] = vertex_[k + 1];
      weight_[k] = weight_[k + 1];
    }
    double sum = 0;
    for (std::size_t i = 0; i < count_; ++i) {
      weight_[i] = std::max(0.0, weight_[i]);
      sum += weight_[i];
    }
    for (std::size_t i = 0; i < count_; ++i) {
      weight_[i] = sum > 0 ? weight_[i] / sum : 1.0 / static_cast<double>(count_);
    }
  }

  /// Moves the vertices to the present angles.
  void place() {
    for (std::size_t k = 0; k < count_; ++k) {
      DifferenceVertex& v = vertex_[k];
      if (rims_a_.slides) v.a = a_.middle(v.id_a) + a_.radius(v.id_a) * rims_a_.e;
      if (rims_b_.slides) v.b = b_.middle(v.id_b) + b_.radius(v.id_b) * rims_b_.e;
      v.p = v.b - v.a;
    }
  }

  Vector3d closest() const {
    Vector3d x = Vector3d::Zero();
    for (std::size_t k = 0; k < count_; ++k) x += weight_[k] * vertex_[k].p;
    return x;
  }

  bool converge() {
    constexpr int kMostSteps = 12;
    constexpr double kEnd = 1e-9;  // convergence is quadratic
    constexpr double kNoise = 1e-2;
    constexpr double kFar = 1e-3;
    d_ = closest().dot(n_);
    frozen_ = false;
    double change = std::numeric_limits<double>::infinity();
    for (int step = 0; step < kMostSteps && change > kEnd; ++step) {
      const double last = change;
      if (!newton_step(change)) return false;
      if (last < kNoise && !(change < 0.5 * last)) break;
    }
    // Of a rim nearly parallel to the plane of contact rounding hides the angle: points of one angle are consistent.
    if (change > kEnd && d_ > kFar * size_) {
      frozen_ = true;
      for (int step = 0; step < 2; ++step) {
        if (!newton_step(change)) return false;
      }
    }
    return std::isfinite(d_) && n_.allFinite();
  }

  /// Takes one step, shortened to kLongest; lengths are in units of the size.
  bool newton_step(double& change) {
    constexpr double kLongest = 0.6;
    const std::size_t at_a = 4;
    const bool turn_a = rims_a_.slides && !frozen_;
    const bool turn_b = rims_b_.slides && !frozen_;
    const std::size_t at_b = at_a + (turn_a ? 1 : 0);
    const std::size_t at_weight = at_b + (turn_b ? 1 : 0);
    const std::size_t unknowns = at_weight + count_ - 1;
    SmallSystem system(unknowns);
    const Vector3d rest = (closest() - d_ * n_) / size_;
    for (std::size_t i = 0; i < 3; ++i) {
      system(i, i) = -d_ / size_;
      system(i, 3) = -n_[static_cast<Eigen::Index>(i)];
      system.right(i) = -rest[static_cast<Eigen::Index>(i)];
      system(3, i) = n_[static_cast<Eigen::Index>(i)];
    }
    if (turn_a) add_rim(system, at_a, rims_a_, -mean_radius(a_, &DifferenceVertex::id_a));
    if (turn_b) add_rim(system, at_b, rims_b_, mean_radius(b_, &DifferenceVertex::id_b));
    for (std::size_t k = 1; k < count_; ++k) {
      const Vector3d edge = (vertex_[k].p - vertex_[0].p) / size_;
      const std::size_t at = at_weight + k - 1;
      for (std::size_t i = 0; i < 3; ++i) {
        system(i, at) = edge[static_cast<Eigen::Index>(i)];
        system(at, i) = edge[static_cast<Eigen::Index>(i)];
      }
      system.right(at) = -n_.dot(edge);
    }
    if (!system.solve()) return false;
    const Vector3d dn(system.right(0), system.right(1), system.right(2));
    double longest = dn.norm();
    for (std::size_t i = at_a; i < at_weight; ++i) longest = std::max(longest, std::abs(system.right(i)));
    if (!std::isfinite(longest)) return false;
    const double share = longest > kLongest ? kLongest / longest : 1;
    change = std::max(longest, std::abs(system.right(3)));
    n_ = (n_ + share * dn).normalized();
    d_ += share * size_ * system.right(3);
    if (turn_a) rims_a_.turn(a_, share * system.right(at_a));
    if (turn_b) rims_b_.turn(b_, share * system.right(at_b));
    weight_[0] = 1;
    for (std::size_t k = 1; k < count_; ++k) {
      const double more = share * system.right(at_weight + k - 1);
      change = std::max(change, std::abs(more));
      weight_[k] += more;
      weight_[0] -= weight_[k];
    }
    place();
    return true;
  }

  /// Adds the unknown angle of a rim, whose points move along `signed_radius` t with it.
  void add_rim(SmallSystem& system, std::size_t at, const Rims& rims, double signed_radius) {
    for (std::size_t i = 0; i < 3; ++i) {
      const double t = rims.t[static_cast<Eigen::Index>(i)];
      system(i, at) = signed_radius / size_ * t;
      system(at, i) = t;
    }
    system(at, at) = -n_.dot(rims.e);
    system.right(at) = -n_.dot(rims.t);
  }

  double mean_radius(const RoundCore& core, int DifferenceVertex::*id) const {
    double sum = 0;
    for (std::size_t k = 0; k < count_; ++k) sum += weight_[k] * core.radius(vertex_[k].*id);
    return sum;
  }

  const RoundCore& a_;
  const RoundCore& b_;
  double size_;
  Rims rims_a_, rims_b_;
  std::array<DifferenceVertex, 3> vertex_;
  std::array<double, 3> weight_{};
  std::size_t count_ = 0;
  Vector3d n_;
  double d_ = 0;
  bool frozen_ = false;  // whether the angles stay
};

/// Returns the point at the same height, in the direction that the outward normal n has across the axis; the same
/// point if it is not on the round side of a frustum, or n is too nearly along the axis to tell the direction.
Vector3d settled(const RoundCore& core, const Vector3d& x, const Vector3d& n) {
  constexpr double kAcross = 1e-3;  // least part of n across the axis
  constexpr double kNear = 1e-3;    // farthest move, in units of the body
  if (!core.round()) return x;
  const Vector3d axis = core.axis();
  if (!((n - n.dot(axis) * axis).norm() > kAcross)) return x;
  const Vector3d side = core.middle(1) - core.middle(0) + (core.radius(1) - core.radius(0)) * core.across(n);
  const CoreVertex rim = core.vertex(n);
  // Where the side is not across n, the point is on the rim that is furthest along n.
  if (std::abs(side.dot(n)) > kNear * side.norm()) return (rim.x - x).norm() <= kNear * side.norm() ? rim.x : x;
  const double height = (x - core.middle(0)).dot(axis);
  const double share = height / (core.middle(1) - core.middle(0)).dot(axis);
  const double radius = (1 - share) * core.radius(0) + share * core.radius(1);
  const Vector3d point = core.middle(0) + height * axis + radius * core.across(n);
  return (point - x).norm() <= kNear * radius ? point : x;
}

}  // namespace

double RoundCore::beyond(const Vector3d& x) const {
  CoreView bare = core_;
  bare.radius = 0;
  const Pose X_WP = Pose::translation(x - t_);
  return core_distance(bare, unchecked_pose(R_, Vector3d::Zero()), {}, X_WP, {}).distance;
}

bool slide(const RoundCore& a, const RoundCore& b, double size, CoreSimplex& simplex, Vector3d& n, Vector3d& rival) {
  Slide search(a, b, size, simplex, n);
  if (!search.slides() || !search.run(rival)) return false;
  search.take(simplex, n);
  return true;
}

void settle_points(const RoundCore& a, const RoundCore& b, double size, CoreContact& contact) {
  constexpr double kStays = 1e-15;
  constexpr double kOnSurface = 4e-15;
  const Vector3d point_a = settled(a, contact.a, contact.n);
  const Vector3d point_b = settled(b, contact.b, -contact.n);
  const bool moves_a = (point_a - contact.a).norm() > kStays * size;
  const bool moves_b = (point_b - contact.b).norm() > kStays * size;
  CoreContact moved = contact;
  moved.a = moves_b && !moves_a ? Vector3d(point_b - contact.lower * contact.n) : point_a;
  moved.b = moves_a && !moves_b ? Vector3d(point_a + contact.lower * contact.n) : point_b;
  if (!moves_a && !moves_b) return;
  const bool as_good = bound_of(moved) <= std::max(bound_of(contact), kStays * size) &&
                       mismatch_of(moved) <= std::max(mismatch_of(contact), kStays * size);
  if (as_good && a.beyond(moved.a) <= kOnSurface * size && b.beyond(moved.b) <= kOnSurface * size) contact = moved;
}

}  // namespace geom::kernel
