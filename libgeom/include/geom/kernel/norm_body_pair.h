#pragma once

/// Distance of two bodies {x : N(x/a) <= 1} with N a nested norm (kernel/nested_norm.h), whose surfaces may have flat
/// faces or edges: superellipsoids, or one of them with an ellipsoid.
///
/// Where a face is nearly flat its support point moves across it while n hardly changes, and Newton's step of n
/// overshoots. The methods follow each other; each is tried only if the one before has not converged:
///
/// 1. If both bodies may have faces, by an exponent of about 1 or less: Newton's method of both bodies' contact
///    elements (src/norm/contact_elements.h), points of the surfaces with their normals. The normals need not be n
///    before it has converged: on a face a step is made by the point, on an edge by the normal. Nearly all pairs end
///    here.
/// 2. Dual Newton (see kernel/dual_newton.h) while its steps are good. Some of them are made with the support point of
///    the flatter body, s + H delta, from which n is computed: a *retraction*. Then elements from the point reached.
/// 3. Dual Newton to its end, and elements in shorter steps. After that, from another start if there is one.
/// 4. Branch and bound over all normals (kernel/sphere_search.h), from the highest local maximum found: slow, and with
///    whatever bounds it has at its limit of evaluations.
///
/// Certificates: g(n) is a lower bound of the distance for every n, and |r + xB - xA| an upper one for every two points
/// of the bodies. Overlaps: if balls of radii rho_A, rho_B, no larger than the smallest radii of curvature, lie in the
/// bodies about c_A, c_B (Blaschke: about x - rho n for each point x of a surface with the normal n), then g(m) <=
/// m.(r + c_B - c_A) - rho_A - rho_B for every m, so that |r + c_B - c_A| - rho_A - rho_B is an upper bound. At the
/// nearest stationary normal of depth -g < rho_A + rho_B it is g again: no search is needed.

#include <geom/distance.h>
#include <geom/export.h>
#include <geom/kernel/lanes.h>
#include <geom/kernel/norm_bodies.h>
#include <geom/kernel/sphere_search.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom::kernel {

/// Sum S of the Hessians of both bodies' support functions across a normal, each t1 t1^T + t2 t2^T: determinant and
/// adjugate. With t_k the four vectors and p_k = n x t_k: det S = sum over k < l of (p_k.t_l)^2,
/// all terms positive, so that nothing cancels if one body is flat and the other is not; the smallest eigenvalue is det
/// S over the largest.
struct HessianSum {
  LaneVector p1, p2;  ///< n x t1, n x t2
  Lanes within;       ///< p1.t2 of each body; the next members: of A with B's and of B with A's
  Lanes across11, across12, across22;
  double determinant;
  double trace;

  HessianSum(const Eigen::Vector3d& normal, const LaneVector& t1, const LaneVector& t2) {
    const LaneVector n = LaneVector::same(normal);
    p1 = n.cross(t1);
    p2 = n.cross(t2);
    within = p1.dot(t2);
    across11 = p1.dot(swapped(t1));
    across12 = p1.dot(swapped(t2));
    across22 = p2.dot(swapped(t2));
    determinant = sum(within * within + across12 * across12) + across11[0] * across11[0] + across22[0] * across22[0];
    trace = sum(p1.dot(p1) + p2.dot(p2));
  }

  double smallest() const {
    const double largest = 0.5 * trace + std::sqrt(std::max(0.0, 0.25 * trace * trace - determinant));
    return largest > 0 ? determinant / largest : 0;
  }
  /// Returns 1 / det(S + identity I); for two points without a gap at most the largest number.
  double by_determinant(double identity) const {
    return 1 / (identity * (identity + trace) + determinant + std::numeric_limits<double>::min());
  }
  /// Returns the adjugate of S + identity I times y, which is across n.
  Eigen::Vector3d adjugate_times(const Eigen::Vector3d& y, double identity) const {
    const LaneVector up = p1.dot(y) * p1 + p2.dot(y) * p2;
    return identity * y + up.a() + up.b();
  }
};

/// Values of g and its derivatives at one normal.
struct DualSample {
  Eigen::Vector3d n;
  double g = -std::numeric_limits<double>::infinity();
  NormBodies::Support support;
  Eigen::Vector3d y;  ///< gradient of g along the sphere: the mismatch of the support points
  double residual = std::numeric_limits<double>::infinity();  ///< |y|

  /// Returns a bound of the distance minus g, by the support points, which are hypot(g, |y|) apart.
  double gap() const {
    const double upper = std::hypot(g, residual);
    return g > 0 ? residual * (residual / (upper + g)) : upper - g;
  }
  /// Returns the traces of the Hessians of both support functions.
  Lanes traces() const { return support.t1.dot(support.t1) + support.t2.dot(support.t2); }
};

class GEOM_EXPORT NormBodyPair {
 public:
  /// Constructs the pair with B's centre at r from A's. `scale`: the sum of both bounding radii; `least`: that of both
  /// inscribed ones; `rolling`: lower bounds of both bodies' smallest radii of curvature, which shorten queries of
  /// overlaps.
  NormBodyPair(const NormBodies& bodies, const Eigen::Vector3d& r, double scale, double least, Lanes rolling = both(0))
      : bodies_(bodies),
        r_(r),
        rolling_(rolling),
        scale_(scale),
        floor_(kFloor * least),
        flat_(any(low_exponents(bodies))),
        both_flat_(!any(~low_exponents(bodies) | ellipsoids(bodies))) {}

  /// Answer of one method: a normal, and a bound of the distance minus g there.
  struct Answer {
    DualSample at;      ///< sample at the normal; the normal itself may be better by Newton's last step
    LaneVector points;  ///< points nearly on both surfaces and as close as they come there, from the centres
    double gap = std::numeric_limits<double>::infinity();  ///< certified: at.g <= distance <= at.g + gap
    /// True if the gap is rounding or as promised (kBoundGap; after a search kWidestGap, kWidestDepthGap). For an
    /// overlap that was not searched: at.n is stationary to rounding.
    bool converged = false;
  };

  /// Newton step of the normal, not applied yet.
  struct Step {
    Eigen::Vector3d delta;
    double decrement;
    bool lifted;  ///< the matrix had to be made definite: the step predicts nothing
  };

  DualSample sample(const Eigen::Vector3d& n) const;
  Step newton_step(const DualSample& s) const;
  /// Takes one step uphill: retractions first if a face is flat, then Newton's step, shortened. Near the maximum a step
  /// is accepted that neither raises g nor lowers it by more than rounding, but reduces the mismatch as predicted.
  /// Returns false if no step was found.
  bool advance(DualSample& s, const Step& step) const;
  /// Returns the support points displaced according to the step's change of the normal: the closest points to first
  /// order. On a flat face the support point itself is lost to rounding, which this corrects. Returns the support
  /// points if the step cannot be used: lifted, in an overlap.
  static LaneVector moved_points(const DualSample& s, const Step& step);
  /// Returns points of both bodies, from their centres, each moved by half of their deviation from being g n apart.
  LaneVector joined(const LaneVector& points, const DualSample& at) const;
  /// Returns x across s.n with (S + g I) x = y, S the sum of the Hessians, made definite as in a Newton step.
  Eigen::Vector3d tangent_solve(const DualSample& s, const Eigen::Vector3d& y) const;

  enum class Patience {
    little,  ///< only while each step reduces the mismatch of the support points well
    all
  };
  Answer dual(const Eigen::Vector3d& start, Patience patience, int max_iterations, int& iterations) const;
  enum class Pace {
    brisk,   ///< step lengths that take the least time on average
    careful  ///< shorter steps, which mostly converge where brisk ones have not
  };
  enum class FirstElements {
    supports,  ///< the bodies' support points at a nearly correct normal
    /// Points about where the support points of the ellipsoids with the same semi-axes are, and a normal between
    /// theirs.
    ellipsoids
  };
  /// Runs Newton's method of contact elements. The answer's sample contains its normal and g alone, which belong
  /// together even if it has not converged.
  Answer by_elements(const Eigen::Vector3d& start, FirstElements first, Pace pace, int max_iterations,
                     int& iterations) const;
  /// Runs all methods, each if the one before has not converged; `cold`: the value of cold_normal().
  Answer solve(const Eigen::Vector3d& start, const Eigen::Vector3d& cold, Penetration penetration, int max_iterations,
               int& iterations) const;

  /// Returns a first normal along (QA + QB)^-1 r, Q = R diag(a^2) R^T: exact for ellipsoids whose axes are parallel.
  Eigen::Vector3d cold_normal() const;
  double scale() const { return scale_; }
  const NormBodies& bodies() const { return bodies_; }
  const Eigen::Vector3d& between() const { return r_; }

 private:
  /// A method ends when its bounds are this close, in units of the scale: they cannot be improved further.
  static constexpr double kTightGap = 1e-14;
  /// Smallest eigenvalue that is kept in Newton's matrix, over the sum of both inscribed radii. Faces and edges have
  /// zero eigenvalues; with a larger value steps towards them are too short, with a smaller one they diverge.
  static constexpr double kFloor = 5e-4;
  /// Bodies whose exponents are all above this have no faces, only vertices: Newton's own step is as good as a
  /// retraction, and cheaper.
  static constexpr double kRound = 1.01;

  static LaneBits low_exponents(const NormBodies& bodies) {
    return below(bodies.e1(), both(kRound)) | below(bodies.e2(), both(kRound));
  }
  static LaneBits ellipsoids(const NormBodies& bodies) {
    return ~below(both(0), abs(bodies.e1() - 1) + abs(bodies.e2() - 1));
  }

  /// Matrix S + g I across n, its smallest eigenvalue kept above a floor.
  struct TangentMatrix {
    HessianSum S;
    double identity;  ///< coefficient of I: g, or more
    bool lifted;

    Eigen::Vector3d solve(const Eigen::Vector3d& y) const {
      return S.by_determinant(identity) * S.adjugate_times(y, identity);
    }
  };

  TangentMatrix tangent_matrix(const DualSample& s) const;
  /// Returns a unit vector across s.n along which g curves upwards by more than `rounding` / rad^2; zero if there is
  /// none.
  Eigen::Vector3d upward(const DualSample& s, double rounding) const;
  /// Runs all methods except branch and bound; `first` applies to the elements that go first.
  Answer newton(const Eigen::Vector3d& start, FirstElements first, int limit, int& iterations) const;
  void place_points(const Step& step, Answer& answer) const;
  /// Returns the vector from A to B between the centres of the balls that roll inside them, at two points (as always
  /// from the bodies' centres) of their surfaces.
  Eigen::Vector3d between_balls(const LaneVector& on_surface) const;
  void bound_depth(Answer& answer) const;
  bool ends(Answer& answer, Penetration penetration) const;
  /// Returns whether a point inside both bodies is found, between the witness points or the centres.
  bool shares_a_point(const Answer& answer) const;
  Tangent tangent(const Eigen::Vector3d& n) const;
  Tangent climbed(const Eigen::Vector3d& n, double rounding, int& iterations) const;
  Answer search(const Eigen::Vector3d& start, int& iterations) const;
  Answer polished(const Answer& answer, int& iterations) const;
  bool retract(DualSample& s, const Step& step, double cap) const;
  static LaneVector moves(const DualSample& s, const Step& step);
  bool keeps_promise(const DualSample& from, const Step& step, const DualSample& to) const;
  bool improves(const DualSample& from, const DualSample& to) const;

  NormBodies bodies_;
  Eigen::Vector3d r_;
  Lanes rolling_;  ///< radii of balls that roll freely inside the bodies
  double scale_;
  double floor_;    ///< smallest eigenvalue of Newton's matrix
  bool flat_;       ///< a body may be flat somewhere, a disc too: retractions save steps
  bool both_flat_;  ///< both may have faces, which excludes ellipsoids: elements go first
};

}  // namespace geom::kernel
