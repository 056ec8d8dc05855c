#include "contact/support_gap.h"

#include "contact/least_step.h"

#include <algorithm>
#include <array>

namespace ed::internal {

using Eigen::Vector3d;
using geom::kernel::both;
using geom::kernel::sqrt;
using geom::kernel::sum;

namespace {

/// Share of g that each body may be made larger by to keep its majorant flat.
constexpr double kAllowance = 0.0125;

geom::kernel::Lanes norm(const geom::kernel::LaneVector& v) {
  return sqrt(v.dot(v));
}

/// Sum over i of D2_i b_i^2.
geom::kernel::Lanes weighted(const geom::kernel::LaneVector& D2, const geom::kernel::LaneVector& b) {
  return D2.x * b.x * b.x + D2.y * b.y * b.y + D2.z * b.z * b.z;
}

geom::kernel::Lanes larger_of(geom::kernel::Lanes a, geom::kernel::Lanes b) {
  return geom::kernel::select(geom::kernel::below(a, b), b, a);
}

geom::kernel::Lanes smaller_of(geom::kernel::Lanes a, geom::kernel::Lanes b) {
  return geom::kernel::select(geom::kernel::below(a, b), a, b);
}

}  // namespace

SupportGap::Evaluation SupportGap::evaluation(const State& s, const DualSample& sample) const {
  Evaluation e;
  e.sample = sample;
  e.newton = s.pair.newton_step(sample);
  e.g = sample.g;
  e.decrement = e.newton.decrement;
  geom::kernel::set_step(e, e.newton.delta, e.newton.delta.squaredNorm());
  return e;
}

double SupportGap::Certificate::curvature(double tau) const {
  const Lanes omega{gap.a_.top.max_omega(), gap.b_.top.max_omega()};
  const Lanes alpha{gap.a_.top.max_alpha(), gap.b_.top.max_alpha()};
  const Lanes jerk{gap.a_.top.max_jerk(), gap.b_.top.max_jerk()};
  const Lanes both_turn = angular_speed + omega;
  const Lanes most_slip = smaller_of(slip + alpha * tau, both_turn);
  const Lanes M3 = most_slip * both_turn * both_turn + 3 * alpha * both_turn + jerk;
  const Lanes change = d1 + tau * (d2 + (tau / 6) * d_max * M3);
  const Lanes bodies = reach * M3 * (tau / 3) + change * change / height;
  const double centres =
      angular_speed * angular_speed_across * (angular_speed * (distance + speed * tau) / 3 + speed) * tau;
  const Lanes radii{gap.A_.bounding_radius, gap.B_.bounding_radius};
  const double hidden = direction * (sum(radii * (both_turn * both_turn + alpha) + bodies) +
                                     angular_speed * (angular_speed * distance + 2 * speed) + centres);
  return gap.curvature_share_ * (bend + centres + sum(bodies) + hidden);
}

SupportGap::Certificate SupportGap::certificate(const State& s, const DualSample& at,
                                                const NormBodies::Majorant& majorant, const Vector3d& Omega) const {
  const Vector3d& r = s.pair.between();
  const Vector3d turned = Omega.cross(at.n);
  const LaneVector n = LaneVector::of(at.n, -at.n);
  const LaneVector W = LaneVector::same(Omega);
  const LaneVector slip = W - s.omega;
  const LaneVector mu1 = slip.cross(n);
  const LaneVector mu2 = slip.cross(W.cross(n)) - s.omega.cross(mu1) - s.alpha.cross(n);
  const NormBodies& bodies = s.pair.bodies();
  const double angular_speed = Omega.norm();
  const double distance = r.norm();
  const double speed = v_.norm();
  Certificate c{.gap = *this,
                .rate = turned.dot(r) + at.n.dot(v_) - sum(majorant.gradient.dot(mu1)),
                .angular_speed = angular_speed,
                .angular_speed_across = turned.norm(),
                .distance = distance,
                .speed = speed,
                .bend = -Omega.cross(turned).dot(r) - 2 * turned.dot(v_) + sum(majorant.gradient.dot(mu2)),
                .slip = norm(slip),
                .reach = norm(majorant.gradient),
                .height = majorant.height,
                .d1 = sqrt(weighted(majorant.D2, bodies.to_body(mu1))),
                .d2 = 0.5 * sqrt(weighted(majorant.D2, bodies.to_body(mu2))),
                .d_max = sqrt(larger_of(majorant.D2.x, larger_of(majorant.D2.y, majorant.D2.z))),
                .direction = s.rounding.direction,
                .hidden_rate = s.rounding.direction *
                               (angular_speed * distance + speed + angular_speed * size() + scales_.surface_speed)};
  return c;
}

/// Returns the longest step of one choice for a gap that is certainly g, or less than `best` if it is certainly no
/// longer than that.
double SupportGap::longest_step(const State& s, const DualSample& at, const NormBodies::Majorant& majorant, double g,
                                const Vector3d& Omega, double horizon, double best) const {
  const Certificate c = certificate(s, at, majorant, Omega);
  const double gap = g - sum(majorant.offset);
  if (!(gap >= 0)) return 0;
  const double rate = c.rate - c.hidden_rate;
  double tau = smaller(horizon, first_root(gap, rate, c.curvature(horizon)));
  for (int attempt = 0; attempt < 4 && tau < horizon; ++attempt) {
    const double reach = smaller(horizon, attempt < 2 ? larger(3 * tau, 1.2 * best) : 2 * tau);
    if (!(reach > tau)) break;
    tau = larger(tau, smaller(reach, first_root(gap, rate, c.curvature(reach))));
  }
  return tau;
}

/// n x dn/dt of the normal that stays the best, by (M + g I) dn/dt = P d(r - sA - sB)/dt at fixed n.
Vector3d SupportGap::angular_velocity_of_best_normal(const State& s, const DualSample& at) const {
  const LaneVector n = LaneVector::of(at.n, -at.n);
  const LaneVector turned = s.omega.cross(n);
  const auto& support = at.support;
  const LaneVector seen = support.t1.dot(turned) * support.t1 + support.t2.dot(turned) * support.t2;
  const LaneVector moved = s.omega.cross(support.point) - seen;  // d s(n)/dt at fixed n
  const Vector3d y = v_ - moved.a() + moved.b();
  const Vector3d rate = s.pair.tangent_solve(at, y);
  const Vector3d mean = 0.5 * (s.omega.a() + s.omega.b());
  return at.n.cross(rate) + mean.dot(at.n) * at.n;
}

double SupportGap::certified_step(const State& s, const Evaluation& e, const Vector3d& /*n*/, double g, double /*gp*/,
                                  double horizon) const {
  const NormBodies& bodies = s.pair.bodies();
  const Vector3d fixed = Vector3d::Zero();
  const Vector3d best_rotation = angular_velocity_of_best_normal(s, e.sample);
  const double least_g = larger(0.0, g - s.rounding.gap);
  double tau = 0;
  const auto try_all = [&](const NormBodies::Majorant& majorant) {
    for (const Vector3d* Omega : {&fixed, &best_rotation}) {
      if (tau >= horizon) return;
      tau = larger(tau, longest_step(s, e.sample, majorant, least_g, *Omega, horizon, tau));
    }
  };
  const NormBodies::Majorant raised = bodies.majorant(e.sample.support, kAllowance * least_g);
  try_all(raised);
  if (raised.raised && tau < horizon) try_all(bodies.majorant(e.sample.support, 0));
  return tau;
}

/// Returns whether the tilted end leaves more than `least`.
bool SupportGap::tilted_end_clears(const State& s, const Vector3d& n, const Vector3d& Omega, double least,
                                   double tau) const {
  const Vector3d& r = s.pair.between();
  const LaneVector n2 = LaneVector::of(n, -n);
  const LaneVector tilted = n2 + both(tau) * (LaneVector::same(Omega) - s.omega).cross(n2);
  const double end = n.dot(r + tau * v_) + tau * Omega.cross(n).dot(r) - sum(s.pair.bodies().heights(tilted));
  const double angular_speed = Omega.norm();
  const auto bend = [angular_speed](const NormBodyShape& shape, const FreeTop& top) {
    const double both_turn = angular_speed + top.max_omega();
    return shape.bounding_radius * (both_turn * both_turn + top.max_alpha());
  };
  const double centres = angular_speed * (angular_speed * (r.norm() + tau * v_.norm()) + 2 * v_.norm());
  return end - 0.5 * tau * tau * (bend(A_, a_.top) + bend(B_, b_.top) + centres) > least;
}

double SupportGap::least_step(const State& s, const Evaluation& e, const Vector3d& n, bool touching, double tau) const {
  const double unit = size() / speed();
  if (tau > kShortStep * unit) return tau;
  // g of bodies that touch is not known: it may fall by what rounding hides.
  const auto least = [&](double trial) { return touching ? 0 : s.rounding.gap + scales_.later(trial); };
  const std::array<Vector3d, 4> turns{Vector3d::Zero(), angular_velocity_of_best_normal(s, e.sample), s.omega.a(),
                                      s.omega.b()};
  return longest_clear_step(touching ? kTouching * unit : tau, unit, [&](double trial) {
    return std::any_of(turns.begin(), turns.end(),
                       [&](const Vector3d& Omega) { return tilted_end_clears(s, n, Omega, least(trial), trial); });
  });
}

bool SupportGap::falls_since(const State& s, const Evaluation& e, const Vector3d& /*n*/, double rate,
                             double span) const {
  if (!(rate < -kResting * speed())) return false;
  if (!(span > 0)) return true;
  // Backwards omega, v and Omega change sign, and with them g' and mu1; mu2, alpha and K do not.
  const NormBodies::Majorant majorant = s.pair.bodies().majorant(e.sample.support, 0);
  for (const Vector3d& Omega : {Vector3d(Vector3d::Zero()), angular_velocity_of_best_normal(s, e.sample)}) {
    const Certificate c = certificate(s, e.sample, majorant, Omega);
    if (-c.rate - c.hidden_rate > 0.5 * span * c.curvature(span)) return true;
  }
  return false;
}

Separation SupportGap::separating_normal(const State& s, Vector3d& n) const {
  int iterations = 0;
  const NormBodyPair::Answer answer = s.pair.solve(s.pair.cold_normal(), s.pair.cold_normal(),
                                                   geom::Penetration::global, geom::kMaxIterations, iterations);
  n = answer.at.n;
  if (answer.at.g >= -kOverlap * size()) return Separation::apart;
  return answer.at.g + answer.gap < -kOverlap * size() ? Separation::overlapping : Separation::declined;
}

}  // namespace ed::internal
