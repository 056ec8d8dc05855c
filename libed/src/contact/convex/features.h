#pragma once

/// Closest features of two cores that are apart, and how their normal turns.

#include "contact/convex/body.h"

#include <geom/kernel/core_simplex.h>

#include <Eigen/Core>

#include <array>
#include <cmath>
#include <cstddef>
#include <limits>

namespace ed::internal {

/// Face of the difference B - A that is closest to the origin: up to three vertices, and the weights of the closest
/// point. Points are those of the bodies, from their own centres.
struct ConvexFeatures {
  int count = 0;  ///< 0: not known
  std::array<Eigen::Vector3d, 3> a, b;
  std::array<double, 3> weight{};

  Eigen::Vector3d point_a() const { return mean(a); }
  Eigen::Vector3d point_b() const { return mean(b); }

 private:
  Eigen::Vector3d mean(const std::array<Eigen::Vector3d, 3>& x) const {
    Eigen::Vector3d sum = weight[0] * x[0];
    for (std::size_t k = 1; k < static_cast<std::size_t>(count); ++k) sum += weight[k] * x[k];
    return sum;
  }
};

/// Two cores at one time: orientations, and the vector from A's centre to B's.
struct PlacedPair {
  const ConvexBody& a;
  const ConvexBody& b;
  const Eigen::Matrix3d& R_a;
  const Eigen::Matrix3d& R_b;
  const Eigen::Vector3d& r;
  double size;

  /// Returns whether both cores are polytopes for certain, so that every search ends.
  bool finite() const { return a.polytope() && b.polytope(); }
  /// Returns whether bounds that agree are an answer. They leave an error of the square root of rounding in the normals
  /// of curved features; libgeom's distance knows better those of its smooth bodies, and of rims beside its own cores.
  bool may_close() const { return !a.smooth && !b.smooth && !(a.core && b.core && (a.rims() || b.rims())); }
  /// Returns whether both cores are points or segments.
  bool lines() const { return a.line() && b.line(); }
  /// Returns the point of B - A that is nearest along n; `gap`: between the tangent planes.
  geom::kernel::DifferenceVertex difference(const Eigen::Vector3d& n, double& gap) const {
    const geom::Support s_a = a.core_support(R_a, n);
    const geom::Support s_b = b.core_support(R_b, -n);
    geom::kernel::DifferenceVertex v;
    v.a = s_a.point;
    v.b = s_b.point;
    v.p = (r + v.b) - v.a;
    gap = n.dot(r) - (s_a.height + s_b.height);
    return v;
  }
};

/// Gap of two cores: the bounds that enclose it, the normal of the lower one, and the features of the upper one.
struct ClosestFeatures {
  enum class End {
    enough,  ///< condition of the caller
    closed,  ///< bounds that agree to rounding; n is the normal of the features
    open,    ///< bounds that improve no more
    inside,  ///< overlap of the cores, or cores too near each other to tell
  };
  End end = End::open;
  Eigen::Vector3d n = Eigen::Vector3d::Zero();
  double lower = -std::numeric_limits<double>::infinity();
  double upper = std::numeric_limits<double>::infinity();
  ConvexFeatures features;
  int evaluations = 0;
};

/// Steps after which the search is given up where smooth bodies, which are for Newton's method, may take many.
inline constexpr int kMostUnknownSteps = 12;

/// Searches for the closest features by the algorithm of Gilbert, Johnson and Keerthi from a normal on, until
/// enough(lower, upper) or the bounds agree. For polytopes it ends after finitely many steps, with these features.
/// `most_unknown`: number of steps where one of the bodies is no polytope for certain.
template <class Enough>
ClosestFeatures closest_features(const PlacedPair& pair, const Eigen::Vector3d& start, const Enough& enough,
                                 int most_unknown = kMostUnknownSteps) {
  using End = ClosestFeatures::End;
  constexpr int kMostSteps = 64;
  constexpr int kPatience = 4;
  constexpr double kSameLength = 1 + 1e-14;
  constexpr double kClosed = 1e-15;
  constexpr double kClosedUnknown = 4e-15;  // the cores of users' shapes are differences
  const double resolved = (pair.finite() ? kClosed : kClosedUnknown) * pair.size;
  ClosestFeatures answer;
  int idle = 0;
  geom::kernel::CoreSimplex simplex, best;
  Eigen::Vector3d n = start;
  for (int step = 0; step < (pair.finite() ? kMostSteps : most_unknown) && idle < kPatience; ++step) {
    double gap = 0;
    const geom::kernel::DifferenceVertex v = pair.difference(n, gap);
    ++answer.evaluations;
    if (gap > answer.lower) {
      answer.lower = gap;
      answer.n = n;
    }
    bool known = false;
    for (std::size_t k = 0; k < simplex.count; ++k) {
      known = known || (simplex.vertex[k].p - v.p).squaredNorm() <= resolved * resolved;
    }
    // Bounds of smooth bodies agree long before the normal is right.
    if (step > 0 && (pair.finite() || (known && pair.may_close())) && answer.upper - gap <= resolved) {
      // The gap across the closest point of the simplex: another normal whose gap is the same to rounding, as that at
      // the start, may be off by the square root of that.
      answer.lower = gap;
      answer.n = n;
      answer.end = End::closed;
    } else if (enough(answer.lower, answer.upper)) {
      answer.end = End::enough;
    }
    if (answer.end != End::open || known) break;
    simplex.vertex[simplex.count++] = v;
    geom::kernel::reduce_to_closest(simplex);
    const double length = std::sqrt(simplex.squared);
    if (simplex.inside || !(length > resolved)) {
      answer.end = End::inside;
      return answer;
    }
    // A better normal changes the length by the square of its change only: below rounding where the cores are much
    // nearer than they are large, while the gap across it still grows.
    if (!(length <= kSameLength * answer.upper)) break;
    idle = length < answer.upper || gap >= answer.lower ? 0 : idle + 1;
    answer.upper = length;
    best = simplex;
    n = simplex.closest / length;
  }
  answer.features.count = static_cast<int>(best.count);
  for (std::size_t k = 0; k < best.count; ++k) {
    answer.features.a[k] = best.vertex[k].a;
    answer.features.b[k] = best.vertex[k].b;
    answer.features.weight[k] = best.weight[k];
  }
  return answer;
}

/// Returns the closest features of points and segments in closed form: the closest points of the lines, brought back
/// into the segments one after the other. ClosestFeatures::End::open if they are nearly parallel, or the bounds do not
/// agree.
ClosestFeatures line_features(const PlacedPair& pair);

/// Returns the part across n of the angular velocity with which the normal of these features turns, if they stay the
/// closest ones: that of a face with its body, that of two edges with both.
///
/// p_k = r + b_k - a_k are the vertices, moving at p_k'. The closest point x of their plane, line or point is d n, so
/// that n is across e = p_k - p_1: n'.e = -n.e'. Along a direction b across both n and e it is x that turns: n'.b =
/// x'.b / d.
Eigen::Vector3d turning_of_normal(const ConvexFeatures& features, const Eigen::Vector3d& n, double distance,
                                  const Eigen::Vector3d& v, const Eigen::Vector3d& omega_a,
                                  const Eigen::Vector3d& omega_b);

/// Velocities of a placed pair: that of the centres, and both angular ones.
struct PairVelocity {
  Eigen::Vector3d v, omega_a, omega_b;
};

/// Returns the angular velocity across n of the normal of two bodies of which one has rims: points roll along rims as
/// the normal turns.
///
/// The support point of a body that turns with omega moves by H (n' - omega x n) in addition, H the Hessian of the
/// support function: along directions that no edge fixes, (d + H_A + H_B) n' = x' + H_A (omega_A x n) + H_B (omega_B x
/// n), x' of the points as if they were fixed to their bodies.
Eigen::Vector3d turning_with_rims(const PlacedPair& pair, const ConvexFeatures& features, const Eigen::Vector3d& n,
                                  double distance, const PairVelocity& velocity);

}  // namespace ed::internal
