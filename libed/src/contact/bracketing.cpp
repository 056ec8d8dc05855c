#include "contact/bracketing.h"

#include "contact/body_shapes.h"

#include "contact/sphere_window.h"
#include "contact/uniaxial_gap.h"

#include <ed/tolerances.h>

#include <geom/any_shape.h>
#include <geom/distance.h>
#include <geom/kernel/any_body.h>
#include <geom/newton.h>

#include <Eigen/Geometry>
#include <Eigen/LU>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <type_traits>
#include <utility>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

/// A search that takes more distances than this ends with a bound and goes on from there when the bound comes up.
constexpr int kMaxDistances = 1'000'000;

constexpr int kMaxRootSteps = 100;
constexpr int kMaxNewtonSteps = 30;

/// Newton on eqs. (contime) ends when its last step of the point is below this share of the pair's size: convergence is
/// quadratic, so that what is left is rounding.
constexpr double kNewtonStep = 1e-11;

/// Calls f with a shape, or with the one inside.
template <class F>
decltype(auto) with(const geom::Ellipsoid& shape, F&& f) {
  return f(shape);
}
template <class F>
decltype(auto) with(const geom::Shape& shape, F&& f) {
  return geom::kernel::with_equations("finder \"bracketing\"", shape, std::forward<F>(f));
}
template <class Shape, class F>
decltype(auto) with_both(const Shape& a, const Shape& b, F&& f) {
  return with(a, [&](const auto& A) { return with(b, [&](const auto& B) { return f(A, B); }); });
}

/// One body at one time. Frame: the world's axes, the origin at A's centre.
struct MovingBody {
  geom::Pose pose;
  Vector3d velocity;
  /// Angular velocity; of bodies of revolution without the spin about their axis, which moves no surface.
  Vector3d omega;

  Vector3d velocity_at(const Vector3d& x) const { return velocity + omega.cross(x - pose.position()); }
};

MovingBody moving_body(const AxisMotion& m, double t, const Vector3d& position, const Vector3d& velocity) {
  Vector3d u, du;
  turn<true>(m, t, u, du);
  u.normalize();
  Eigen::Matrix3d R;
  R.col(0) = u.unitOrthogonal();
  R.col(1) = u.cross(R.col(0));
  R.col(2) = u;
  return {geom::kernel::unchecked_pose(R, position), velocity, u.cross(du)};
}

MovingBody moving_body(const RigidMotion& m, double t, const Vector3d& position, const Vector3d& velocity) {
  const TopState top = m.top.at(t - m.time);
  return {geom::kernel::unchecked_pose(top.R, position), velocity, top.omega};
}

/// f, f_x, f_xx of a body's surface at a point, and the time derivatives of f and f_x there: the surface moves with the
/// body, so that df/dt = -f_x.w and d(f_x)/dt = omega x f_x - f_xx w, w the velocity of the body at that point.
struct MovingSurface {
  double f;
  double f_t;
  Vector3d f_x;
  Vector3d f_xt;
  Eigen::Matrix3d f_xx;

  template <class Shape>
  MovingSurface(const Shape& shape, const MovingBody& body, const Vector3d& x) {
    const geom::kernel::LocalSurface local = with(shape, [&](const auto& inside) {
      constexpr double kUnitLength = 1;
      const geom::kernel::WorldSurface<std::decay_t<decltype(inside)>> surface{inside, body.pose.rotation(),
                                                                               kUnitLength};
      return surface(x - body.pose.position());
    });
    const Vector3d w = body.velocity_at(x);
    f = local.value;
    f_x = local.gradient;
    f_xx = local.hessian;
    f_t = -f_x.dot(w);
    f_xt = body.omega.cross(f_x) - f_xx * w;
  }
};

/// Returns a bound of how much turning can change the distance in a unit of time: eq. (distOver) has |w| L here, L the
/// bounding radius; the speed of the axis times |a - b|, the largest slope of the support function, is an overestimate
/// too, and makes longer steps.
double turning_speed(const geom::Ellipsoid& shape, const AxisMotion& motion) {
  return turning_lever(shape) * motion.rate * motion.e2.norm();
}

double turning_speed(const geom::Shape& shape, const RigidMotion& motion) {
  return turning_lever(shape) * motion.top.max_omega();
}

template <class Shape>
double bounding_radius_of(const Shape& shape) {
  return with(shape, [](const auto& s) { return s.bounding_radius(); });
}

/// Returns whether the second derivatives of the shape's implicit function have no bound: Newton's method on eqs.
/// (contime) creeps there, and ends up to 1e-7 from the contact.
template <class Shape>
bool has_vertices(const Shape& shape) {
  return with(shape, [](const auto& s) { return s.has_vertices(); });
}

template <class Pair>
class Search {
 public:
  Search(const Pair& pair, const ContactOptions& options, Vector3d& n, FinderCounters& count,
         std::optional<Unsolved>& unsolved)
      : pair_(pair),
        options_(options),
        n_(n),
        count_(count),
        unsolved_(unsolved),
        v_(pair.b.velocity - pair.a.velocity),
        size_(bounding_radius_of(pair.shape_a) + bounding_radius_of(pair.shape_b)),
        fastest_(v_.norm() + turning_speed(pair.shape_a, pair.a) + turning_speed(pair.shape_b, pair.b)) {}

  Finding run(double t_begin, double t_end);

 private:
  /// Both bodies at one time, with their distance and its rate.
  struct PairAtTime {
    double time;
    MovingBody a, b;
    double d;
    double rate;  ///< dd/dt
    Vector3d point_a, point_b;
    Vector3d normal;
  };

  PairAtTime look(double t);
  geom::DistanceResult distance(double t, const MovingBody& a, const MovingBody& b);
  geom::DistanceResult dual_distance(const MovingBody& a, const MovingBody& b) const;
  geom::WitnessPair seed(const MovingBody& a, const MovingBody& b);
  // Bodies in axes that move with A's centre.
  MovingBody body_a(double t) const { return moving_body(pair_.a, t, Vector3d::Zero(), Vector3d::Zero()); }
  MovingBody body_b(double t) const { return moving_body(pair_.b, t, pair_.r_now + (t - pair_.now) * v_, v_); }

  bool grazes(const PairAtTime& from, const PairAtTime& to, Finding& finding);
  bool refine(const PairAtTime& outside, const PairAtTime& inside, double guess, Finding& finding);
  bool refine_by_newton(const PairAtTime& outside, double t_last, double guess, Finding& finding);
  bool refine_in_one_dimension(PairAtTime outside, PairAtTime inside, Finding& finding);
  bool touches(const PairAtTime& at) const { return at.d <= kTouching * size_; }
  bool approaches(const PairAtTime& at) const { return at.rate < -kResting * fastest_; }

  const Pair& pair_;
  const ContactOptions& options_;
  Vector3d& n_;
  FinderCounters& count_;
  std::optional<Unsolved>& unsolved_;
  Vector3d v_;
  double size_;
  double fastest_;     ///< an overestimate of |dd/dt|
  bool first_ = true;  ///< no distance has been asked for yet
};

template <class Pair>
geom::DistanceResult Search<Pair>::dual_distance(const MovingBody& a, const MovingBody& b) const {
  return geom::distance(pair_.shape_a, a.pose, pair_.shape_b, b.pose,
                        {.start = n_, .penetration = geom::Penetration::local});
}

/// Returns the points from which Newton's method starts. The normal that a search begins with may be crude, or old: the
/// first distance starts from the user's points or the dual's, later ones from the support points along the normal
/// before.
template <class Pair>
geom::WitnessPair Search<Pair>::seed(const MovingBody& a, const MovingBody& b) {
  const bool first = first_;
  first_ = false;
  if (!first) {
    return with_both(pair_.shape_a, pair_.shape_b,
                     [&](const auto& A, const auto& B) { return geom::normal_seed(A, a.pose, B, b.pose, n_); });
  }
  if (options_.seed) {
    geom::WitnessPair users = options_.seed(pair_.shape_a, a.pose, pair_.shape_b, b.pose);
    if (users.status == geom::SeedStatus::usable) return users;
  }
  const geom::DistanceResult dual = dual_distance(a, b);
  count_.kernel_calls += static_cast<std::uint64_t>(dual.iterations);
  if (!is_answer(dual)) return {};
  return {dual.point_a, dual.point_b, geom::SeedStatus::usable};
}

template <class Pair>
geom::DistanceResult Search<Pair>::distance(double t, const MovingBody& a, const MovingBody& b) {
  const auto counted = [&](const geom::DistanceResult& result) {
    count_.kernel_calls += static_cast<std::uint64_t>(result.iterations);
    return result;
  };
  if (options_.distance == DistanceMethod::dual) return counted(dual_distance(a, b));
  const geom::WitnessPair start = seed(a, b);
  const auto system =
      options_.distance == DistanceMethod::newton8 ? geom::NewtonSystem::eight : geom::NewtonSystem::five;
  geom::DistanceResult result = counted(with_both(pair_.shape_a, pair_.shape_b, [&](const auto& A, const auto& B) {
    return geom::kernel::newton_distance_unchecked(A, a.pose, B, b.pose, system, start);
  }));
  if (is_answer(result)) return result;
  ++count_.rescues;
  unsolved_ = Unsolved{t, {options_.distance, result.status, pair_.shape_a, pair_.shape_b, a.pose, b.pose, start}};
  return counted(dual_distance(a, b));
}

template <class Pair>
typename Search<Pair>::PairAtTime Search<Pair>::look(double t) {
  ++count_.evaluations;
  PairAtTime at;
  at.time = t;
  at.a = body_a(t);
  at.b = body_b(t);
  const geom::DistanceResult result = distance(t, at.a, at.b);
  if (!is_answer(result)) {
    // Neither way answers: the overlap is deep (separated bodies are always answered). The centres part or approach.
    const Vector3d& r = at.b.pose.position();
    at.d = -std::numeric_limits<double>::infinity();
    at.normal = r.isZero(0) ? Vector3d(Vector3d::UnitX()) : Vector3d(r.stableNormalized());
    at.rate = at.normal.dot(v_);
    at.point_a = at.point_b = 0.5 * r;
    n_ = at.normal;
    return at;
  }
  at.d = result.distance;
  at.normal = result.normal;
  at.point_a = result.point_a;
  at.point_b = result.point_b;
  at.rate = result.normal.dot(at.b.velocity_at(result.point_b) - at.a.velocity_at(result.point_a));
  n_ = result.normal;
  return at;
}

/// The paper's steps; step 1 is the window.
template <class Pair>
Finding Search<Pair>::run(double t_begin, double t_end) {
  ++count_.predictions;
  const Window window = sphere_window(pair_.r_now, v_, size_, pair_.now, t_begin, t_end);
  Finding finding{Outcome::clear, t_end};
  if (!(window.begin < window.end)) return finding;
  PairAtTime here = look(window.begin);  // step 2
  for (int distances = 0; distances < kMaxDistances; ++distances) {
    if (here.d < -kOverlap * size_) return {Outcome::overlapping, here.time, approaches(here)};
    if (touches(here)) {
      if (approaches(here)) return {Outcome::contact, here.time};
      here.d = std::numeric_limits<double>::min();  // they have just collided, and part
    }
    if (!(here.time < window.end) || fastest_ == 0) return finding;   // step 8
    const double step = std::max(here.d, options_.eps_d) / fastest_;  // step 3
    const PairAtTime next =
        look(std::max(std::nextafter(here.time, window.end), std::min(here.time + step, window.end)));
    if (next.d < 0 && here.d > 0) {  // step 5
      const double guess = here.time + (next.time - here.time) * here.d / (here.d - next.d);
      if (refine(here, next, guess, finding)) return finding;
    } else if (here.d < options_.eps_d && next.d < options_.eps_d) {  // step 6
      if (grazes(here, next, finding)) return finding;
    }
    here = next;  // step 7
  }
  return {Outcome::bound, here.time};
}

/// Step 6: both distances are in (0, eps_d); the parabola through them and the distance half way may have zeros.
template <class Pair>
bool Search<Pair>::grazes(const PairAtTime& from, const PairAtTime& to, Finding& finding) {
  // Distances that fall at the end, or rise at the start, have no minimum between: nothing to look for.
  if (from.rate >= 0 || to.rate <= 0) return false;
  const double span = to.time - from.time;
  const PairAtTime middle = look(from.time + 0.5 * span);
  if (middle.d < 0) return refine(from, middle, from.time + 0.25 * span, finding);
  // d = c0 + c1 s + c2 s^2, s in [0, 1].
  const double c0 = from.d;
  const double c1 = 4 * middle.d - 3 * from.d - to.d;
  const double c2 = 2 * (from.d + to.d) - 4 * middle.d;
  const double discriminant = c1 * c1 - 4 * c0 * c2;
  if (!(c2 > 0) || !(c1 < 0) || !(discriminant >= 0)) return false;
  const double smallest_zero = 2 * c0 / (std::sqrt(discriminant) - c1);
  if (!(smallest_zero <= 1)) return false;
  const PairAtTime lowest = look(from.time + span * std::min(1.0, -c1 / (2 * c2)));
  if (lowest.d < 0) return refine(from, lowest, from.time + smallest_zero * span, finding);
  return refine_by_newton(from, to.time, from.time + smallest_zero * span, finding);
}

template <class Pair>
bool Search<Pair>::refine(const PairAtTime& outside, const PairAtTime& inside, double guess, Finding& finding) {
  const bool by_newton =
      options_.root == ContactRoot::newton && !has_vertices(pair_.shape_a) && !has_vertices(pair_.shape_b);
  if (by_newton && refine_by_newton(outside, inside.time, guess, finding)) return true;
  return refine_in_one_dimension(outside, inside, finding);
}

/// Newton's method on eqs. (contime), f_x + alpha^2 g_x = 0, f = 0, g = 0, in the contact point, alpha and time.
template <class Pair>
bool Search<Pair>::refine_by_newton(const PairAtTime& outside, double t_last, double guess, Finding& finding) {
  Vector3d x = 0.5 * (outside.point_a + outside.point_b);
  double t = guess;
  double alpha = 0;
  for (int step = 0; step < kMaxNewtonSteps; ++step) {
    const MovingBody a = body_a(t);
    const MovingBody b = body_b(t);
    const MovingSurface f(pair_.shape_a, a, x);
    const MovingSurface g(pair_.shape_b, b, x);
    if (step == 0) alpha = std::sqrt(f.f_x.norm() / g.f_x.norm());
    const double alpha2 = alpha * alpha;
    Eigen::Matrix<double, 5, 5> J;
    J.topLeftCorner<3, 3>() = f.f_xx + alpha2 * g.f_xx;
    J.block<3, 1>(0, 3) = 2 * alpha * g.f_x;
    J.block<3, 1>(0, 4) = f.f_xt + alpha2 * g.f_xt;
    J.row(3) << f.f_x.transpose(), 0, f.f_t;
    J.row(4) << g.f_x.transpose(), 0, g.f_t;
    Eigen::Matrix<double, 5, 1> F;
    F << f.f_x + alpha2 * g.f_x, f.f, g.f;
    const Eigen::Matrix<double, 5, 1> delta = J.partialPivLu().solve(F);
    if (!delta.allFinite()) return false;
    x -= delta.head<3>();
    alpha -= delta[3];
    t -= delta[4];
    // Far outside the bracket: another contact, or none.
    const double margin = 0.5 * (t_last - outside.time) + kTouching * size_ / fastest_;
    if (t < outside.time - margin || t > t_last + margin || !(x.norm() < 2 * size_)) return false;
    if (delta.head<3>().norm() > kNewtonStep * size_ || std::abs(delta[4]) * fastest_ > kNewtonStep * size_) continue;
    if (t > t_last + kTouching * size_ / fastest_) return false;
    const MovingBody a_end = body_a(t);
    const Vector3d n = MovingSurface(pair_.shape_a, a_end, x).f_x.normalized();
    const double rate = n.dot(body_b(t).velocity_at(x) - a_end.velocity_at(x));
    if (!(rate < -kResting * fastest_)) return false;
    n_ = n;
    finding = {Outcome::contact, std::max(t, outside.time)};
    return true;
  }
  return false;
}

/// Newton's method on d(t), kept between a time outside and one inside by bisection.
template <class Pair>
bool Search<Pair>::refine_in_one_dimension(PairAtTime outside, PairAtTime inside, Finding& finding) {
  PairAtTime best = outside;
  for (int step = 0; step < kMaxRootSteps; ++step) {
    double t = best.time - best.d / best.rate;
    if (!(t > outside.time && t < inside.time)) t = 0.5 * (outside.time + inside.time);
    if (!(t > outside.time && t < inside.time)) break;  // neighbouring doubles
    best = look(t);
    if (std::abs(best.d) <= kTouching * size_) break;
    (best.d > 0 ? outside : inside) = best;
  }
  if (!approaches(best)) return false;
  n_ = best.normal;
  finding = {Outcome::contact, best.time};
  return true;
}

}  // namespace

Finding bracketing_contact(const UniaxialPair& pair, double t_begin, double t_end, const ContactOptions& options,
                           Vector3d& n, FinderCounters& count, std::optional<Unsolved>& unsolved) {
  return Search(pair, options, n, count, unsolved).run(t_begin, t_end);
}

Finding bracketing_contact(const GeneralPair& pair, double t_begin, double t_end, const ContactOptions& options,
                           Vector3d& n, FinderCounters& count, std::optional<Unsolved>& unsolved) {
  return Search(pair, options, n, count, unsolved).run(t_begin, t_end);
}

}  // namespace ed::internal
