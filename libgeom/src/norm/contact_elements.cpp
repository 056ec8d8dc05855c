#include "norm/contact_elements.h"

#include <geom/kernel/dual_newton.h>
#include <geom/kernel/norm_body_pair.h>
#include <geom/tolerances.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <limits>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;
using Element = ContactElements::Element;

LaneVector signs(const LaneVector& v) {
  const Lanes one = both(1);
  return {with_sign(one, v.x), with_sign(one, v.y), with_sign(one, v.z)};
}

/// Changes the description of an element, of the bodies marked, to the equivalent one beyond the pole of w2, so that a
/// step through the pole goes straight on.
void turn(Element& e, LaneBits through) {
  const Lanes flip = select(through, both(-1), both(1));
  e.sign = {flip * e.sign.x, flip * e.sign.y, e.sign.z};
  e.w = {flip * e.w.x, flip * e.w.y, e.w.z};
}

constexpr LaneBits kNone{0, 0};
constexpr ArcBits kOfPoints{~kNone, ~kNone};
constexpr ArcBits kOfNormals{kNone, kNone};

}  // namespace

ContactElements::Element ContactElements::element(const Arcs& arcs, const LaneVector& sign) const {
  Element e;
  set(e, arcs, sign);
  return e;
}

void ContactElements::set(Element& e, const Arcs& arcs, const LaneVector& sign) const {
  const Lanes w0 = arcs.w0.outer;
  const Lanes m0 = arcs.m0.outer;
  e.arcs = arcs;
  e.sign = sign;
  e.w = {w0 * arcs.w0.inner, w0 * arcs.w1.inner, arcs.w1.outer};
  const LaneVector m{m0 * arcs.m0.inner, m0 * arcs.m1.inner, arcs.m1.outer};  // grad N without signs
  const LaneVector axes = product(bodies_.semi_axes(), sign);
  const LaneVector along_n = product(product(bodies_.inverse_semi_axes(), sign), m);
  const Lanes by_height = sqrt(along_n.dot(along_n));
  e.normal = bodies_.rotation() * ((1 / by_height) * along_n);
  e.point = bodies_.rotation() * product(axes, e.w);
  // t1 and t2 of the dual norm as in LaneNorm::curved, at m, where the norm is 1; its Hessian scales with 1/|m|.
  const Lanes scale = by_height * arcs.flat0.outer;
  const ArcLanes k = sqrt(ArcLanes(scale * arcs.flat0.inner, scale) * family_.by_minus_one() * arcs.flat1);
  e.t1 = bodies_.rotation() * product(axes, {k.inner * arcs.m1.inner, -k.inner * arcs.m0.inner, both(0)});
  const Lanes k_z = k.outer * arcs.m1.outer;
  e.t2 = bodies_.rotation() * product(axes, {k_z * arcs.w0.inner, k_z * arcs.w1.inner, -k.outer * m0});
}

ContactElements::Element ContactElements::at(const Vector3d& n) const {
  const LaneVector v = bodies_.in_norm(n);
  const LaneVector m = abs(v);
  // The outer arc needs the inner one's norm, m.w; only that is used of the first pass.
  const Arcs inner = family_.arcs({m.x, m.x}, {m.y, m.y}, kOfNormals);
  const Lanes rho = m.x * inner.w0.inner + m.y * inner.w1.inner;
  return element(family_.arcs({m.x, rho}, {m.y, m.z}, kOfNormals), signs(v));
}

ContactElements::Element ContactElements::at_ellipsoids(const Vector3d& n) const {
  const LaneVector v = bodies_.in_norm(n);
  const LaneVector w = abs(v);
  const Lanes rho = select(below(w.x, w.y), w.y, w.x);  // the limit of high exponents, for N2
  return element(family_.arcs({w.x, rho}, {w.y, w.z}, kOfPoints), signs(v));
}

void ContactElements::move(Element& e, const LaneVector& step, const Vector3d& n) const {
  const LaneVector dw = product(bodies_.inverse_semi_axes(), bodies_.rotation().transposed_times(step));
  const LaneVector w = e.w + product(dw, e.sign);
  const LaneVector m = product(bodies_.in_norm(n), e.sign);
  const LaneBits second = below(e.arcs.w0.inner, e.arcs.w1.inner);
  const LaneBits through = below(select(second, w.y, w.x), both(0)) & below(select(second, m.y, m.x), both(0));
  if (any(through)) [[unlikely]] {
    turn(e, through);
    return move(e, step, n);
  }
  const Lanes rho = w.x * e.arcs.m0.inner + w.y * e.arcs.m1.inner;
  const Lanes dual_rho = m.x * e.arcs.w0.inner + m.y * e.arcs.w1.inner;
  const ArcFamily::Moved to = family_.moved(e.arcs, {w.x, rho}, {w.y, w.z}, {m.x, dual_rho}, {m.y, m.z});
  const LaneVector crossed{to.sign0.inner * to.sign0.outer, to.sign1.inner * to.sign0.outer, to.sign1.outer};
  set(e, to.arcs, product(e.sign, crossed));
}

namespace {

/// Newton's step of two contact elements towards a common normal n + delta along which their points are apart: with y
/// the mismatch of the points that both would have at n, (S + g I) delta = y across n, as in the dual method.
struct ElementStep {
  Vector3d delta;    ///< step of n
  LaneVector moves;  ///< steps of the points
  double energy;     ///< length; about the difference of the bounds of the distance at the elements
  bool lifted;       ///< the matrix had to be made definite: the step predicts nothing
};

/// Normals that differ by less are treated as equal: on a flat face the point that belongs to the difference would be
/// noise.
constexpr double kEqualNormals = 4e-15;

/// Returns t.difference, or 0 if that is rounding.
Lanes clear_dot(const LaneVector& t, const LaneVector& difference) {
  const Lanes dot = t.dot(difference);
  const Lanes rounding2 = kEqualNormals * kEqualNormals * t.dot(t);
  return select(below(dot * dot, rounding2), both(0), dot);
}

/// Lower limit of the smallest eigenvalue of S + g I for overlapping bodies, relative to |g|: on vertices that barely
/// touch S vanishes, and that eigenvalue is of the order of g at the best normals around the vertices' own.
constexpr double kFloorOfDepth = 0.1;

/// Computes the step. `gap`: vector from A's point to B's. `floor`: lower limit of that eigenvalue if it is less than
/// kFloorOfDepth |g|.
ElementStep element_step(const Element& at, const Vector3d& n, const Vector3d& gap, double floor) {
  const double g = gap.dot(n);
  const LaneVector difference = LaneVector::of(n, -n) - at.normal;
  const Lanes d1 = clear_dot(at.t1, difference);
  const Lanes d2 = clear_dot(at.t2, difference);
  const LaneVector resynced = d1 * at.t1 + d2 * at.t2;
  Vector3d y = gap - resynced.a() + resynced.b();
  y -= y.dot(n) * n;
  const HessianSum S(n, at.t1, at.t2);
  double identity = g;
  ElementStep step;
  step.lifted = false;
  if (g < 0) {
    floor = std::min(floor, kFloorOfDepth * -g);
    const double smallest = S.smallest();
    step.lifted = g + smallest < floor;
    if (step.lifted) identity = floor - smallest;
  }
  const double by_determinant = S.by_determinant(identity);
  step.delta = by_determinant * S.adjugate_times(y, identity);
  // t_k.delta without the terms of t_k itself, which vanish: for huge t_k they would be noise.
  const Lanes py1 = S.p1.dot(y);
  const Lanes py2 = S.p2.dot(y);
  const Lanes oy1 = swapped(py1);
  const Lanes oy2 = swapped(py2);
  const Lanes turn1 = identity * at.t1.dot(y) - S.within * py2 - S.across11 * oy1 - S.across12 * oy2;
  const Lanes turn2 = identity * at.t2.dot(y) + S.within * py1 + swapped(S.across12) * oy1 - S.across22 * oy2;
  const Lanes share{by_determinant, -by_determinant};  // B's normal is -n
  const Lanes c1 = d1 + share * turn1;
  const Lanes c2 = d2 + share * turn2;
  step.moves = c1 * at.t1 + c2 * at.t2;
  step.energy = std::abs(step.delta.dot(y)) + sum(abs(c1 * d1) + abs(c2 * d2));
  return step;
}

/// Longest steps: of the normal (radian), and of a point over the sum of both bounding radii.
struct Caps {
  double turn;
  double move;

  /// Returns the fraction of a step whose turn and longest move have these squares. It avoids roots, which wait for
  /// each other: most steps need none.
  double fraction(double turn2, double move2) const {
    if (turn2 <= turn * turn && move2 <= move * move) return 1;
    return std::min({1.0, turn / std::sqrt(turn2), move / std::sqrt(move2)});
  }
};
constexpr Caps kBrisk{0.35, 0.15};  // half or twice these values take the same time
constexpr Caps kCareful{0.1, 0.03};
/// Energy relative to the sum of both bounding radii: after a step with less, the remaining error is mostly rounding.
constexpr double kSmallEnergy = 1e-7;
/// Energy relative to the sum of both bounding radii that agreeing bounds can hide.
constexpr double kRoundingGain = 1e-16;

/// Returns whether the remaining error after the step is of second order and rounding.
bool last(const ElementStep& step, double largest_move2, double off, double scale) {
  const double length2 = std::max(step.delta.squaredNorm(), largest_move2 / (scale * scale));
  return length2 < kNormalTolerance2 && step.energy < off + kRoundingGain * scale;
}

}  // namespace

/// Runs Newton's method of contact elements. It has no line search: it converges or it does not, which the bounds show.
/// If the bounds agree before the points do, one more step is made for the points, whose error along the tangent planes
/// is of the order of sqrt(g off).
NormBodyPair::Answer NormBodyPair::by_elements(const Vector3d& start, FirstElements first, Pace pace,
                                               int max_iterations, int& iterations) const {
  const Caps caps = pace == Pace::brisk ? kBrisk : kCareful;
  const ContactElements elements(bodies_);
  Answer best{.at = {.n = start, .support = {}, .y = Vector3d::Zero()}, .points = {}};
  double best_off = std::numeric_limits<double>::infinity();  // bound of its error
  const bool from_supports = first == FirstElements::supports;
  Element e = from_supports ? elements.at(start) : elements.at_ellipsoids(start);
  Vector3d n = from_supports ? start : unit_or_x(e.normal.a() - e.normal.b());
  bool near = false;
  bool agreed = false;
  for (int k = 0; k < max_iterations; ++k) {
    ++iterations;
    const Vector3d gap = r_ + e.point.b() - e.point.a();
    const ElementStep step = element_step(e, n, gap, floor_);
    const Lanes moves2 = step.moves.dot(step.moves);
    const double largest_move2 = std::max(moves2[0], moves2[1]);
    if (near) {
      const double g = r_.dot(n) - sum(bodies_.heights(LaneVector::of(n, -n)));
      const double upper = gap.norm();
      // For overlaps there is no upper bound: the criterion is the gain of the step, and whether the points are as far
      // apart as the tangent planes.
      const double off = g > 0 ? std::max(upper - g, 0.0) : std::max(step.energy, std::abs(upper + g));
      const bool valid = g > 0 || !step.lifted;
      const bool agree = valid && off < kTightGap * scale_;
      const bool is_last = agree && last(step, largest_move2, off, scale_);
      if (is_last || (valid && off < best_off)) {
        best_off = off;
        best.at.g = g;
        best.at.n = is_last ? Vector3d((n + step.delta).normalized()) : n;
        best.points = is_last ? e.point + step.moves : e.point;
        best.gap = std::max(upper - g, 0.0);
      }
      if (is_last || (agree && agreed)) break;
      agreed = agree;
    }
    near = step.energy < kSmallEnergy * scale_;
    const double fraction = caps.fraction(step.delta.squaredNorm(), largest_move2 / (scale_ * scale_));
    n += fraction * step.delta;
    elements.move(e, both(fraction) * step.moves, n);  // does not wait for its length
    n.normalize();
  }
  // Around tips that nearly touch Newton's method can go in circles, with bounds that are as close as promised.
  const bool to_promise = pace == Pace::careful && best.at.g > 0;
  best.converged = best_off < (to_promise ? kBoundGap : kTightGap) * scale_;
  return best;
}

}  // namespace geom::kernel
