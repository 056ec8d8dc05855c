#pragma once

/// Contact elements: points of the surfaces of two bodies {x : N(x/a) <= 1} (kernel/norm_bodies.h) with their normals,
/// and their change by a Newton step.
///
/// On a flat face the point determines the normal, which hardly changes; on an edge the normal determines the point. N
/// is nested, N1(N2(w0, w1), w2), so that an element is two arcs: the position of (w0, w1) on the unit curve of N2, and
/// that of (N2, w2) on the unit curve of N1. On u^p + v^p = 1 the gradient is m = (u^(p-1), v^(p-1)), and the ratio of
/// its components is the (p-1)th power of that of w.
///
/// A step is linear in the ratio of w near an axis, in that of m around the diagonal (the other way round for p < 2,
/// where faces are between the axes and vertices on them). It ends where it crosses from one to the other: only that
/// part of it is good. The value of N2 that the outer arc uses after a step is from the tangent of N2 at the old inner
/// arc, correct to first order as the whole step is: neither arc waits for the other.

#include "norm/arc_lanes.h"

#include <geom/kernel/lanes.h>
#include <geom/kernel/norm_bodies.h>

#include <Eigen/Core>

namespace geom::kernel {

/// Position on each arc: the point (w0, w1) >= 0 of u^p + v^p = 1, p > 1, with the gradient (m0, m1) there, which is on
/// the curve of the dual exponent: w0 m0 + w1 m1 = 1.
struct Arcs {
  ArcLanes w0, w1;
  ArcLanes m0, m1;
  /// Ratios w0 / m0 and w1 / m1, from which the Hessian of the dual norm is computed. If they vanish: 1 for p = 2, huge
  /// for larger p, on a flat face, tiny for smaller p, on a vertex.
  ArcLanes flat0, flat1;
};

class ArcFamily {
 public:
  /// Ratio of beta at which the two variables change over. Of values from 0.1 to 0.3, queries take the fewest steps.
  static constexpr double kKnee = 0.2;
  static constexpr double kLogKnee = -1.6094379124341003;

  /// Constructs the family with p = 2/e.
  explicit ArcFamily(const ArcLanes& e)
      : minus_one_(2 / e - 1),
        by_minus_one_(1 / minus_one_),
        inverse_(0.5 * e),
        steep_(~below(minus_one_, 1)),
        knee_(exp(kLogKnee * select(steep_, by_minus_one_, minus_one_))) {}

  /// Returns 1/(p - 1).
  ArcLanes by_minus_one() const { return by_minus_one_; }

  /// Returns the arcs from the ratio of `first` and `second`: a ratio of w if `of_points`, else of m.
  Arcs arcs(const ArcLanes& first, const ArcLanes& second, const ArcBits& of_points) const {
    const ArcBits swapped = below(first, second);
    const ArcLanes ratio = select(swapped, first, second) / positive(select(swapped, second, first));
    const ArcLanes powered = exp(select(of_points, minus_one_, by_minus_one_) * log(ratio));
    const ArcLanes w = select(of_points, ratio, powered);
    const ArcLanes m = select(of_points, powered, ratio);
    const ArcLanes s = 1 + w * m;
    const ArcLanes root = exp(inverse_ * log(s));
    const ArcLanes by_both = 1 / (s * root);
    const ArcLanes w_larger = s * by_both;            // s^(-1/p)
    const ArcLanes m_larger = root * root * by_both;  // s^(1/p - 1)
    const ArcLanes flat_larger = w_larger * w_larger * s;
    const ArcLanes flat_smaller = flat_larger * flatness(w, m);
    const ArcLanes w_smaller = w * w_larger, m_smaller = m * m_larger;
    return {select(swapped, w_smaller, w_larger),       select(swapped, w_larger, w_smaller),
            select(swapped, m_smaller, m_larger),       select(swapped, m_larger, m_smaller),
            select(swapped, flat_smaller, flat_larger), select(swapped, flat_larger, flat_smaller)};
  }

  struct Moved {
    Arcs arcs;
    ArcLanes sign0, sign1;  ///< 1, or -1 if the step has crossed an axis
  };
  /// Returns the arcs after a step to points along (w0, w1) and gradients along (m0, m1), which agree to first order.
  Moved moved(const Arcs& from, const ArcLanes& w0, const ArcLanes& w1, const ArcLanes& m0, const ArcLanes& m1) const {
    // alpha: the variable near an axis; beta = alpha^k, k >= 1: the variable around the diagonal. Each a1/a0, b1/b0.
    const ArcLanes beta0 = select(steep_, from.m0, from.w0);
    const ArcLanes beta1 = select(steep_, from.m1, from.w1);
    const ArcBits swapped = below(beta0, beta1);
    const auto ordered = [&swapped](const ArcLanes& u, const ArcLanes& v) { return select(swapped, v, u); };
    const ArcLanes a0 = positive(ordered(select(steep_, w0, m0), select(steep_, w1, m1)));
    const ArcLanes a1 = ordered(select(steep_, w1, m1), select(steep_, w0, m0));
    const ArcLanes b0 = positive(ordered(select(steep_, m0, w0), select(steep_, m1, w1)));
    const ArcLanes b1 = ordered(select(steep_, m1, w1), select(steep_, m0, w0));
    const ArcBits by_axis = below(ordered(beta1, beta0), kKnee * ordered(beta0, beta1));
    const ArcBits keeps_alpha = by_axis & below(abs(a1), knee_ * a0);
    const ArcBits crosses = by_axis & below(a1, 0);
    // A little beyond the knee, so that the next step uses the other variable.
    const ArcLanes least = select(by_axis, ArcLanes(kKnee * (1 + kBeyond)), ArcLanes(kKnee * (1 - kBeyond)));
    const ArcLanes towards = select(crosses, -b1, b1);
    const ArcLanes low = least * b0;
    const ArcLanes beta = select(below(towards, low), low, towards);
    const ArcLanes high = least * beta;  // factor of b0 if beta is above 1 / least
    const ArcLanes numerator = select(keeps_alpha, abs(a1), beta);
    const ArcLanes denominator = select(keeps_alpha, a0, select(below(b0, high), high, b0));
    const ArcLanes one = 1;
    const ArcLanes sign = select(crosses, -one, one);
    return {arcs(ordered(denominator, numerator), ordered(numerator, denominator), ~(keeps_alpha ^ steep_)),
            select(swapped, sign, one), select(swapped, one, sign)};
  }

 private:
  static constexpr double kBeyond = 1e-3;
  /// Lower limit of the smaller of w (p >= 2) or m (p < 2), which avoids 0/0 in w / m. Its square is the smallest m:
  /// flat faces give huge numbers whose fourth powers are finite.
  static constexpr double kLeast = 1e-20;
  /// Lower limit that keeps quotients of two vanishing numbers finite.
  static constexpr double kTiny = 1e-300;

  static ArcLanes larger(const ArcLanes& a, const ArcLanes& b) { return select(below(a, b), b, a); }
  static ArcLanes positive(const ArcLanes& v) { return larger(v, kTiny); }
  ArcLanes flatness(const ArcLanes& w, const ArcLanes& m) const {
    const ArcLanes least = kLeast;
    const ArcLanes quotient = w / larger(m, least * least);
    const ArcBits lost = below(select(steep_, w, m), least);
    if (!any(lost)) return quotient;
    const ArcLanes other = exp(select(steep_, minus_one_, by_minus_one_) * log(least));
    return select(lost, select(steep_, least / larger(other, least * least), other / least), quotient);
  }

  ArcLanes minus_one_;     ///< p - 1
  ArcLanes by_minus_one_;  ///< 1/(p - 1)
  ArcLanes inverse_;       ///< 1/p
  ArcBits steep_;          ///< p >= 2
  ArcLanes knee_;          ///< alpha where beta = kKnee
};

/// Elements of both bodies, each about its own centre, in world axes.
class ContactElements {
 public:
  /// Constructs the elements of `bodies`, which must outlive it.
  explicit ContactElements(const NormBodies& bodies) : bodies_(bodies), family_({bodies.e2(), bodies.e1()}) {}

  struct Element {
    LaneVector point;
    LaneVector normal;  ///< outward unit normal
    LaneVector t1, t2;  ///< vectors of the Hessian of the support function at the normal, t1 t1^T + t2 t2^T
    LaneVector w;       ///< x/a, body axes, without signs
    LaneVector sign;    ///< signs of w, and of grad N there
    Arcs arcs;
  };

  /// Returns the elements at the support points of A at n and of B at -n, n a unit vector.
  Element at(const Eigen::Vector3d& n) const;
  /// Returns elements about where the support points of the ellipsoids with the same semi-axes are: on faces, where
  /// support points of superellipsoids are near the edges.
  Element at_ellipsoids(const Eigen::Vector3d& n) const;
  /// Moves the point of `e` by `step` and turns its normal towards n (A), -n (B); n of any length.
  void move(Element& e, const LaneVector& step, const Eigen::Vector3d& n) const;

 private:
  void set(Element& e, const Arcs& arcs, const LaneVector& sign) const;
  Element element(const Arcs& arcs, const LaneVector& sign) const;

  const NormBodies& bodies_;
  ArcFamily family_;
};

}  // namespace geom::kernel
