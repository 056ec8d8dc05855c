#pragma once

/// Distance of two bodies {x : N(x/a) <= 1} with N a nested norm (internal/nested_norm.h), whose surfaces may have flat
/// faces or edges: superellipsoids, and ellipsoids beside them.
///
/// Where a face is nearly flat its support point runs across it while n hardly turns, and Newton's step of n
/// overshoots. The remedies, each tried only where the one before has not ended:
///
/// 1. Dual Newton (see internal/dual_newton.h), each step of which may be a *retraction*: the step is made with the
///    support point of the flatter body, s + H delta, where the problem is well scaled, and the normal is read there.
/// 2. Primal Newton on |r + xB - xA|^2 in the two tangent planes, whose Hessian is positive semidefinite for bodies
///    apart.
/// 3. Continuation in the exponents, from nearly ellipsoids to the bodies.
/// 4. Branch and bound over all normals (internal/sphere_search.h), which cannot fail but is slow.
///
/// What is certified: g(n) is a lower bound of the distance for every n, and |r + xB - xA| an upper one for every two
/// points of the bodies.

#include <geom/ellipsoid.h>
#include <geom/internal/nested_norm.h>
#include <geom/internal/sphere_search.h>
#include <geom/superellipsoid.h>

#include <Eigen/Core>

#include <cmath>
#include <limits>

namespace geom::internal {

/// Support height and point in world axes about the body's centre, and the Hessian of the support function, t1 t1^T +
/// t2 t2^T.
struct RankedSupport {
  double height;
  Eigen::Vector3d point;
  Eigen::Vector3d t1, t2;

  double trace() const { return t1.squaredNorm() + t2.squaredNorm(); }
  Eigen::Vector3d hessian_times(const Eigen::Vector3d& v) const { return t1.dot(v) * t1 + t2.dot(v) * t2; }
};

/// A body in world axes about its own centre.
class NormBody {
 public:
  NormBody(const Superellipsoid& shape, const Eigen::Matrix3d& R)
      : axes_(shape.semi_axes()), norm_(shape.norm()), dual_(shape.dual_norm()), R_(R) {}
  NormBody(const Ellipsoid& shape, const Eigen::Matrix3d& R)
      : axes_(shape.semi_axes()), norm_(2, 2), dual_(2, 2), R_(R) {}
  /// The same body with exponents e' = 1 + share (e - 1), drawn towards those of an ellipsoid.
  NormBody softened(double share) const;

  RankedSupport support(const Eigen::Vector3d& n) const;
  double height(const Eigen::Vector3d& n) const {
    return dual_(axes_.cwiseProduct(R_.transpose() * n).cwiseAbs()).norm;
  }
  /// The outward normal of the surface at x, or at the surface point in the direction of x: N is homogeneous.
  Eigen::Vector3d normal(const Eigen::Vector3d& x) const;
  Eigen::Vector3d on_surface(const Eigen::Vector3d& x) const;
  /// grad N, and hess N = t1 t1^T + t2 t2^T, of a point of the surface.
  void derivatives(const Eigen::Vector3d& x, Eigen::Vector3d& gradient, Eigen::Vector3d& t1, Eigen::Vector3d& t2) const;

 private:
  NormBody(const Eigen::Vector3d& axes, const NestedNorm& norm, const NestedNorm& dual, const Eigen::Matrix3d& R)
      : axes_(axes), norm_(norm), dual_(dual), R_(R) {}

  Eigen::Vector3d axes_;
  NestedNorm norm_;  ///< of x/a
  NestedNorm dual_;  ///< of a n
  const Eigen::Matrix3d& R_;
};

/// g and all that goes with it at one normal.
struct DualSample {
  Eigen::Vector3d n;
  double g = -std::numeric_limits<double>::infinity();
  RankedSupport a, b;  ///< of A at n and of B at -n
  Eigen::Vector3d y;   ///< the gradient of g along the sphere: the mismatch of the support points
  double residual = std::numeric_limits<double>::infinity();  ///< |y|

  /// How far g can be below the distance: the support points are hypot(g, |y|) apart.
  double gap() const {
    const double upper = std::hypot(g, residual);
    return g > 0 ? residual * (residual / (upper + g)) : upper - g;
  }
};

class NormBodyPair {
 public:
  /// B's centre at r from A's. `scale`: the sum of both bounding radii; `least`: that of both inscribed ones.
  NormBodyPair(const NormBody& a, const NormBody& b, const Eigen::Vector3d& r, double scale, double least)
      : a_(a), b_(b), r_(r), scale_(scale), floor_(5e-4 * least) {}

  /// The answer of one method: a normal, and by how much g there can be below the distance.
  struct Answer {
    DualSample at;
    double gap = std::numeric_limits<double>::infinity();  ///< certified: at.g <= distance <= at.g + gap
    bool converged = false;                                ///< the gap is rounding, or at.n is stationary to rounding
  };

  Answer dual(const Eigen::Vector3d& start, int max_iterations, int& iterations) const;
  Answer primal(const DualSample& start, int max_iterations, int& iterations) const;
  /// A normal for bodies that grow from nearly ellipsoids to these.
  Eigen::Vector3d continued(Eigen::Vector3d n, int& iterations) const;
  DualSample sample(const Eigen::Vector3d& n) const;
  Tangent tangent(const Eigen::Vector3d& n) const;
  double scale() const { return scale_; }

 private:
  /// Points on both surfaces, from their centres, and the vector between them.
  struct Points {
    Eigen::Vector3d a, b, gap;
  };
  struct Step {
    Eigen::Vector3d delta;
    double decrement;
    bool lifted;  ///< the matrix had to be made definite: the step promises nothing
  };

  Step newton_step(const DualSample& s) const;
  bool advance(DualSample& s, const Step& step) const;
  bool retract(DualSample& s, const Step& step, double cap) const;
  bool improves(const DualSample& from, const DualSample& to) const;
  void bound(const Points& points, Answer& best) const;
  void primal_step(const Points& points, double mu, Eigen::Vector3d& d_a, Eigen::Vector3d& d_b) const;

  NormBody a_;
  NormBody b_;
  Eigen::Vector3d r_;
  double scale_;
  double floor_;  ///< least eigenvalue of Newton's matrix
};

}  // namespace geom::internal
