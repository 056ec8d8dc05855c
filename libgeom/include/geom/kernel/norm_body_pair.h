#pragma once

/// Distance of two bodies {x : N(x/a) <= 1} with N a nested norm (kernel/nested_norm.h), whose surfaces may have flat
/// faces or edges: superellipsoids, and ellipsoids beside them.
///
/// Where a face is nearly flat its support point runs across it while n hardly turns, and Newton's step of n
/// overshoots. The methods, each tried only where the one before has not ended:
///
/// 1. Where both bodies may have faces, by an exponent of about 1 or less: Newton's method of both bodies' contact
///    elements (src/contact_elements.h), points of the surfaces with their normals, which need not be those of n before
///    it has converged: on a face a step is made by the point, on an edge by the normal. Nearly all end here.
/// 2. Dual Newton (see kernel/dual_newton.h) while its steps are good, some of which are made with the support point
///    of the flatter body, s + H delta, and n read there: a *retraction*. Then elements from where it is.
/// 3. Dual Newton to its end, and elements in shorter steps. After that, from another start if there is one.
/// 4. Branch and bound over all normals (kernel/sphere_search.h), from the highest local maximum found: slow, and
///    with whatever bounds it has at its limit of evaluations.
///
/// What is certified: g(n) is a lower bound of the distance for every n, and |r + xB - xA| an upper one for every two
/// points of the bodies.

#include <geom/distance.h>
#include <geom/export.h>
#include <geom/kernel/hessian_sum.h>
#include <geom/kernel/norm_bodies.h>
#include <geom/kernel/sphere_search.h>

#include <Eigen/Core>

#include <cmath>
#include <limits>

namespace geom::kernel {

/// g and all that goes with it at one normal.
struct DualSample {
  Eigen::Vector3d n;
  double g = -std::numeric_limits<double>::infinity();
  NormBodies::Support support;
  Eigen::Vector3d y;  ///< the gradient of g along the sphere: the mismatch of the support points
  double residual = std::numeric_limits<double>::infinity();  ///< |y|

  /// How far g can be below the distance by the support points, which are hypot(g, |y|) apart.
  double gap() const {
    const double upper = std::hypot(g, residual);
    return g > 0 ? residual * (residual / (upper + g)) : upper - g;
  }
  /// Traces of the Hessians of both support functions.
  Lanes traces() const { return support.t1.dot(support.t1) + support.t2.dot(support.t2); }
};

class GEOM_EXPORT NormBodyPair {
 public:
  /// B's centre at r from A's. `scale`: the sum of both bounding radii; `least`: that of both inscribed ones.
  NormBodyPair(const NormBodies& bodies, const Eigen::Vector3d& r, double scale, double least)
      : bodies_(bodies),
        r_(r),
        scale_(scale),
        floor_(kFloor * least),
        flat_(any(low_exponents(bodies))),
        both_flat_(!any(~low_exponents(bodies) | ellipsoids(bodies))) {}

  /// The answer of one method: a normal, and by how much g there can be below the distance.
  struct Answer {
    DualSample at;      ///< the normal may be nearer to the best one than that of the sample, by Newton's last step
    LaneVector points;  ///< nearly on both surfaces and as close as they come there, from the centres
    double gap = std::numeric_limits<double>::infinity();  ///< certified: at.g <= distance <= at.g + gap
    /// The gap is rounding or as promised (kBoundGap; of a search kWidestGap, kWidestDepthGap); of an overlap that was
    /// not searched: at.n is stationary to rounding.
    bool converged = false;
  };

  /// One Newton step of the normal; not taken yet.
  struct Step {
    Eigen::Vector3d delta;
    double decrement;
    bool lifted;  ///< the matrix had to be made definite: the step promises nothing
  };

  DualSample sample(const Eigen::Vector3d& n) const;
  Step newton_step(const DualSample& s) const;
  /// One step uphill: retractions first where a face is flat, then Newton's step, shortened; near the maximum one that
  /// neither raises g nor lowers it by more than rounding, but keeps what it promises. False: none was found.
  bool advance(DualSample& s, const Step& step) const;
  /// The support points moved by what the step turns the normal: the closest points to first order. On a flat face the
  /// support point itself is lost to rounding, which this takes back. The support points where the step is of no use:
  /// lifted, in an overlap.
  static LaneVector moved_points(const DualSample& s, const Step& step);
  /// Points of both bodies, from their centres, each moved by half of what keeps them from being g n apart.
  LaneVector joined(const LaneVector& points, const DualSample& at) const;
  /// x across s.n with (S + g I) x = y, S the sum of the Hessians, made definite as in a Newton step.
  Eigen::Vector3d tangent_solve(const DualSample& s, const Eigen::Vector3d& y) const;

  enum class Patience {
    little,  ///< only while each step shrinks the mismatch of the support points well
    all
  };
  Answer dual(const Eigen::Vector3d& start, Patience patience, int max_iterations, int& iterations) const;
  enum class Pace {
    brisk,   ///< the steps that take the least time on average
    careful  ///< shorter ones, which mostly end where those have not
  };
  enum class FirstElements {
    supports,   ///< the bodies' support points at a normal that is nearly right
    ellipsoids  ///< about where those of their ellipsoids are, and a normal between theirs
  };
  /// The answer's sample is its normal and g alone, which belong together also where it has not converged.
  Answer by_elements(const Eigen::Vector3d& start, FirstElements first, Pace pace, int max_iterations,
                     int& iterations) const;
  /// All methods, each where the one before has not ended; `cold`: of cold_normal().
  Answer solve(const Eigen::Vector3d& start, const Eigen::Vector3d& cold, Penetration penetration, int max_iterations,
               int& iterations) const;

  /// Exact for ellipsoids whose axes are parallel: along (QA + QB)^-1 r, Q = R diag(a^2) R^T.
  Eigen::Vector3d cold_normal() const;
  double scale() const { return scale_; }
  const NormBodies& bodies() const { return bodies_; }
  const Eigen::Vector3d& between() const { return r_; }

 private:
  /// Bounds this close, in units of the scale, are as good as it gets: a method ends.
  static constexpr double kTightGap = 1e-14;
  /// Least eigenvalue that is kept in Newton's matrix, over the sum of both inscribed radii. Faces and edges leave
  /// none; with more than this steps towards them are too short, with less they run away.
  static constexpr double kFloor = 5e-4;
  /// Bodies whose exponents are all above have no faces, only vertices: Newton's own step is as good as a retraction,
  /// and cheaper.
  static constexpr double kRound = 1.01;

  static LaneBits low_exponents(const NormBodies& bodies) {
    return below(bodies.e1(), both(kRound)) | below(bodies.e2(), both(kRound));
  }
  static LaneBits ellipsoids(const NormBodies& bodies) {
    return ~below(both(0), abs(bodies.e1() - 1) + abs(bodies.e2() - 1));
  }

  /// S + g I across n, its smallest eigenvalue kept above a floor.
  struct TangentMatrix {
    HessianSum S;
    double identity;  ///< g, or more
    bool lifted;

    Eigen::Vector3d solve(const Eigen::Vector3d& y) const {
      return S.by_determinant(identity) * S.adjugate_times(y, identity);
    }
  };

  TangentMatrix tangent_matrix(const DualSample& s) const;
  /// A unit vector across s.n along which g bends upwards by more than `rounding` / rad^2; zero if there is none.
  Eigen::Vector3d upward(const DualSample& s, double rounding) const;
  /// All but branch and bound; `first` is of the elements that go first.
  Answer newton(const Eigen::Vector3d& start, FirstElements first, int limit, int& iterations) const;
  void place_points(const Step& step, Answer& answer) const;
  bool ends(const Answer& answer, Penetration penetration) const;
  /// Whether a point that both bodies hold is found, between the witness points or the centres.
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
  double scale_;
  double floor_;    ///< least eigenvalue of Newton's matrix
  bool flat_;       ///< a body may be flat somewhere, a disc too: retractions save steps
  bool both_flat_;  ///< both may have faces, which ellipsoids have not: elements go first
};

}  // namespace geom::kernel
