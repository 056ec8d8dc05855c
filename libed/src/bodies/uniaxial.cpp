#include "bodies/uniaxial.h"

#include "bodies/rotations.h"
#include "contact/rods/gap.h"
#include "contact/rods/spheroid_gap.h"
#include "contact/sphere_contact.h"
#include "contact/uniaxial_gap.h"
#include "motion/checks.h"
#include "system/uniaxial.h"
#include "vectors/choose.h"

#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <utility>
#include <variant>

namespace ed::internal {
namespace {

using Eigen::Vector3d;
using geom::kernel::evaluate_uniaxial;
using geom::kernel::support_point;
using geom::kernel::UniaxialEvaluation;

template <int kNumber>
void set_column(RotationRows::Row* rows, int lane, const Eigen::Matrix<double, kNumber, 1>& v) {
  for (int k = 0; k < kNumber; ++k) rows[k][lane] = v[k];
}

Vector3d column(const RotationRows::Row* rows, int lane) {
  return {rows[0][lane], rows[1][lane], rows[2][lane]};
}

void set_column(RotationRows& rows, int lane, double dt, const UniaxialInertia& inertia, const AxisMotion& motion,
                const BodyFrame& frame) {
  rows.dt[lane] = dt;
  rows.rate[lane] = motion.rate;
  rows.perpendicular[lane] = inertia.perpendicular;
  rows.axial[lane] = inertia.axial;
  rows.spin[lane] = frame.spin;
  set_column(rows.e0, lane, motion.e0);
  set_column(rows.e1, lane, motion.e1);
  set_column(rows.e2, lane, motion.e2);
  set_column(rows.momentum_dir, lane, frame.momentum_dir);
  set_column(rows.x_axis, lane, frame.x_axis);
  set_column(rows.phi_lab, lane, frame.phi_lab);
  set_column(rows.phi_body, lane, frame.phi_body);
}

/// Returns whether the kernel has the rotation.
bool is_set(const RotationRows& rows, int lane) {
  const double rate = std::abs(rows.rate[lane]) + std::abs(rows.spin[lane]);
  return rows.dt[lane] != 0 && rate * std::abs(rows.dt[lane]) <= kLargestAngle;
}

UniaxialKind rod_kind(const Species& species) {
  const auto* const capsule = std::get_if<geom::Capsule>(&species.shape);
  const int axis = *symmetry_axis(species);
  UniaxialKind kind;
  if (capsule != nullptr) {
    kind.rod = {capsule->half_length(), capsule->radius()};
  } else {
    const auto& sphere = std::get<geom::Sphere>(species.shape);
    kind.rod = {0, sphere.radius()};
    kind.upright = sphere.ellipsoid();
  }
  kind.axis = axis;
  kind.inertia = {species.mass, species.inertia[(axis + 1) % 3], species.inertia[axis], species.spins};
  kind.bounding_radius = bounding_radius(species.shape);
  kind.inscribed_radius = inscribed_radius(species.shape);
  kind.is_rod = true;
  kind.sphere = kind.rod.half_length == 0;
  if (kind.sphere) kind.shape = geom::kernel::Spheroid(kind.rod.radius, kind.rod.radius);
  return kind;
}

/// Returns what contact_scale does, of two rods: the bound by the best normal of the rods moved to where it says.
double rod_contact_scale(const Rod& A, const Rod& B, const Vector3d& r, const Vector3d& u_a, const Vector3d& u_b,
                         double enough) {
  constexpr int kSteps = 20;
  constexpr double kLeastGain = 1e-6;
  double best = 1;
  for (int step = 0; step < kSteps && best > enough; ++step) {
    const Vector3d moved = best * r;
    const RodPointsOf<double> at = closest_on_rods(A.half_length, B.half_length, moved, u_a, u_b);
    const Vector3d n = (moved + at.t * u_b - at.s * u_a).normalized();
    if (!(n.dot(r) > 0)) break;
    const double heights = A.half_length * std::abs(n.dot(u_a)) + B.half_length * std::abs(n.dot(u_b));
    const double scale = (heights + A.radius + B.radius) / n.dot(r);
    if (!(scale < best * (1 - kLeastGain))) break;
    best = scale;
  }
  return best;
}

UniaxialKind spheroid_kind(const Species& species) {
  const auto* sphere = std::get_if<geom::Sphere>(&species.shape);
  const geom::Ellipsoid shape = sphere != nullptr ? sphere->ellipsoid() : std::get<geom::Ellipsoid>(species.shape);
  const int axis = *symmetry_axis(species);
  const Vector3d& a = shape.semi_axes();
  const double b = a[(axis + 1) % 3];
  return {.shape = geom::kernel::Spheroid(a[axis], b),
          .rod = {},
          .upright = geom::Ellipsoid({b, a[(axis + 2) % 3], a[axis]}),
          .axis = axis,
          .inertia = {species.mass, species.inertia[(axis + 1) % 3], species.inertia[axis], species.spins},
          .bounding_radius = shape.bounding_radius(),
          .inscribed_radius = shape.inscribed_radius()};
}

UniaxialFamily family_of_all(const std::vector<Species>& species) {
  if (!has_rods(species)) return UniaxialFamily::spheroids;
  const auto is_ellipsoid = [](const Species& one) { return std::holds_alternative<geom::Ellipsoid>(one.shape); };
  return std::any_of(species.begin(), species.end(), is_ellipsoid) ? UniaxialFamily::mixed : UniaxialFamily::rods;
}

UniaxialKind kind_of_family(const Species& species, UniaxialFamily family) {
  const bool is_rod = family != UniaxialFamily::spheroids && !std::holds_alternative<geom::Ellipsoid>(species.shape);
  return is_rod ? rod_kind(species) : spheroid_kind(species);
}

}  // namespace

bool UniaxialBodies::can_hold(const System& system) {
  return are_uniaxial(system.species);
}

UniaxialBodies::UniaxialBodies(const System& system)
    : entries_(at(system.size())), frames_(at(system.size())), family_(family_of_all(system.species)) {
  for (const Species& species : system.species) {
    kinds_.push_back(kind_of_family(species, family_));
    bounding_radius_ = std::max(bounding_radius_, kinds_.back().bounding_radius);
    inscribed_radius_ = std::min(inscribed_radius_, kinds_.back().inscribed_radius);
    spins_ = spins_ || species.spins;
  }
  for (int i = 0; i < system.size(); ++i) {
    const Body& body = system.bodies[at(i)];
    kind_.push_back(body.species);
    const UniaxialKind& kind = kind_of(i);
    AxisMotion& motion = entries_[at(i)].motion;
    BodyFrame& frame = frames_[at(i)];
    const Vector3d u = body.rotation.col(kind.axis);
    motion.position = body.position;
    motion.velocity = body.velocity;
    motion.time = 0;
    frame.x_axis = body.rotation.col((kind.axis + 1) % 3);
    const double spin = body.angular_velocity.dot(u);
    frame.spin = kind.inertia.spins ? spin : 0;
    set_rotation(kind.inertia, u, body.angular_velocity - spin * u, motion, frame);
  }
}

Motion UniaxialBodies::motion(int i, double t) const {
  const UniaxialKind& kind = kind_of(i);
  AxisMotion m = rotation_of(i);
  BodyFrame f = frames_[at(i)];
  advance(kind.inertia, t, m, f);
  const Vector3d u = m.axis();
  Eigen::Matrix3d R;
  R.col(kind.axis) = u;
  R.col((kind.axis + 1) % 3) = f.x_axis;
  R.col((kind.axis + 2) % 3) = u.cross(f.x_axis);
  Vector3d inertia = Vector3d::Constant(kind.inertia.perpendicular);
  inertia[kind.axis] = kind.inertia.axial;
  const Vector3d position = kind.sphere ? position_at(i, t) : m.position;
  return {geom::Pose(R, position), m.velocity, omega_across(m) + f.spin * u, inertia, t};
}

void UniaxialBodies::sample(int i, double t, Snapshot& snapshot) const {
  const AxisMotion motion = rotation_of(i);
  const SampledRotation rotation = sampled(kind_of(i).inertia, t, motion, frames_[at(i)]);
  snapshot.axis[at(i)] = rotation.axis;
  snapshot.phi_lab[at(i)] = rotation.phi_lab;
  snapshot.phi_body[at(i)] = {rotation.phi_body.x(), rotation.phi_body.y(), 0};
  snapshot.velocity[at(i)] = motion.velocity;
  snapshot.angular_velocity[at(i)] = rotation.omega;
}

void UniaxialBodies::sample(double t, Snapshot& snapshot) const {
  RotationKernel& kernel = *find_rotation_kernel();
  RotationRows rows{};
  for (int begin = 0; begin < number(); begin += kRotationsAtATime) {
    const int bodies = std::min(kRotationsAtATime, number() - begin);
    for (int lane = 0; lane < bodies; ++lane) {
      const AxisMotion motion = rotation_of(begin + lane);
      set_column(rows, lane, t - motion.time, kind_of(begin + lane).inertia, motion, frames_[at(begin + lane)]);
    }
    kernel(rows, spins_);
    for (int lane = 0; lane < bodies; ++lane) {
      const int i = begin + lane;
      if (!is_set(rows, lane) || kind_of(i).inertia.spins != spins_) {
        sample(i, t, snapshot);
        continue;
      }
      snapshot.axis[at(i)] = column(rows.axis, lane);
      snapshot.phi_lab[at(i)] = column(rows.phi_lab, lane);
      snapshot.phi_body[at(i)] = {rows.phi_body[0][lane], rows.phi_body[1][lane], 0};
      snapshot.velocity[at(i)] = velocity(i);
      snapshot.angular_velocity[at(i)] = column(rows.omega, lane);
    }
  }
}

void UniaxialBodies::rotate_sphere(int i, double t) {
  AxisMotion& m = entries_[at(i)].motion;
  AxisMotion turned = rotation_of(i);
  advance(kind_of(i).inertia, t, turned, frames_[at(i)]);
  m.e0 = turned.e0;
  m.e1 = turned.e1;
  m.e2 = turned.e2;
  m.rate = turned.rate;
}

template <bool kSpin>
Finding UniaxialBodies::find_mixed_contact(int i, int j, const Vector3d& r, double now, double end, int max_evaluations,
                                           Vector3d& n, FinderCounters& count) const {
  const UniaxialKind& A = kind_of(i);
  const MixedGap<kSpin> gap({A.shape, A.bounding_radius, A.inscribed_radius}, entries_[at(i)].motion, kind_of(j).rod,
                            entries_[at(j)].motion, r, now);
  return certified_contact(gap, now, end, max_evaluations, n, count);
}

template <bool kSpin>
Finding UniaxialBodies::find_contact(int i, int j, const Vector3d& r, double now, double end, int max_evaluations,
                                     Vector3d& n, FinderCounters& count) const {
  const UniaxialKind& A = kind_of(i);
  const UniaxialKind& B = kind_of(j);
  const AxisMotion& a = entries_[at(i)].motion;
  const AxisMotion& b = entries_[at(j)].motion;
  const UniaxialFamily pairs = family_of(i, j);
  if (pairs == UniaxialFamily::rods) {
    const RodGap<kSpin> gap(A.rod, a, B.rod, b, r, now);
    return certified_contact(gap, now, end, max_evaluations, n, count);
  }
  if (pairs == UniaxialFamily::mixed) [[unlikely]] {
    if (!A.is_rod) return find_mixed_contact<kSpin>(i, j, r, now, end, max_evaluations, n, count);
    n = -n;
    const Finding finding = find_mixed_contact<kSpin>(j, i, -r, now, end, max_evaluations, n, count);
    n = -n;
    return finding;
  }
  const UniaxialGap<kSpin> gap(A.shape, a, B.shape, b, r, now, A.bounding_radius + B.bounding_radius);
  return certified_contact(gap, now, end, max_evaluations, n, count);
}

Finding UniaxialBodies::find_contact(int i, int j, const Vector3d& r, double now, double end, int max_evaluations,
                                     const ContactOptions& options, Vector3d& n, FinderCounters& count,
                                     std::optional<Unsolved>& unsolved) const {
  if (options.finder == Finder::bracketing) {
    return bracketing_contact(
        {*kind_of(i).upright, *kind_of(j).upright, entries_[at(i)].motion, entries_[at(j)].motion, r, now}, now, end,
        options, n, count, unsolved);
  }
  if (family_ != UniaxialFamily::spheroids && are_spheres(i, j)) {
    const double reach = kind_of(i).rod.radius + kind_of(j).rod.radius;
    return sphere_contact(r, velocity(j) - velocity(i), reach, now, end, n, count);
  }
  return spins_ ? find_contact<true>(i, j, r, now, end, max_evaluations, n, count)
                : find_contact<false>(i, j, r, now, end, max_evaluations, n, count);
}

/// Least share of the square of a rate that a collision must leave for its rounding errors to be corrected: below, they
/// would be scaled up.
constexpr double kLeastLeft = 1e-4;

double UniaxialBodies::point_beside_spheroid(int rod, int spheroid, const Vector3d& r, const Vector3d& n) const {
  const Rod& shape = kind_of(rod).rod;
  const Vector3d point = support_point(kind_of(spheroid).shape, entries_[at(spheroid)].motion.axis(), n);
  const double along = (point + shape.radius * n - r).dot(entries_[at(rod)].motion.axis());
  return smaller(shape.half_length, larger(-shape.half_length, along));
}

UniaxialBodies::Contact UniaxialBodies::contact(int i, int j, const Vector3d& r, const Vector3d& n,
                                                double /*now*/) const {
  RodPointsOf<double> points{};
  const UniaxialFamily pairs = family_of(i, j);
  if (pairs == UniaxialFamily::rods) {
    points = closest_on_rods(kind_of(i).rod.half_length, kind_of(j).rod.half_length, r, entries_[at(i)].motion.axis(),
                             entries_[at(j)].motion.axis());
  } else if (pairs == UniaxialFamily::mixed) {
    const bool first = kind_of(i).is_rod;
    (first ? points.s : points.t) = first ? point_beside_spheroid(i, j, -r, -n) : point_beside_spheroid(j, i, r, n);
  }
  const auto contact_body = [&](int body, const Vector3d& outward, double along) -> ContactBody {
    const AxisMotion& m = entries_[at(body)].motion;
    const UniaxialKind& kind = kind_of(body);
    const Vector3d u = m.axis();
    const Vector3d point = kind.is_rod && pairs != UniaxialFamily::spheroids
                               ? Vector3d(along * u + kind.rod.radius * outward)
                               : support_point(kind.shape, u, outward);
    // The impulse of a body of revolution has no moment along the axis: any multiple of the identity with 1/I_perp
    // does.
    return {1 / kind.inertia.mass, Eigen::Matrix3d::Identity() / kind.inertia.perpendicular, point, m.velocity,
            omega_across(m)};
  };
  return {contact_body(i, n, points.s), contact_body(j, -n, points.t)};
}

void UniaxialBodies::leave(int i, int j, const Contact& contact, double /*now*/) {
  for (const auto& [body, state] : {std::pair<int, const ContactBody&>{i, contact.a}, {j, contact.b}}) {
    AxisMotion& m = entries_[at(body)].motion;
    m.velocity = state.velocity;
    if (kind_of(body).sphere) continue;
    const Vector3d u = m.axis();
    const Vector3d before = omega_across(m);
    const double rate2 = m.rate * m.rate;
    const Vector3d omega = state.angular_velocity - state.angular_velocity.dot(u) * u;
    const UniaxialInertia& inertia = kind_of(body).inertia;
    set_rotation(inertia, u, omega, m, frames_[at(body)]);
    // e2 and u are unit vectors but for rounding that has a sign, and omega is made of them: |omega| instead of the
    // rate would gain energy with every collision. What they lack is given back, where it is small against the rest.
    const double omega2 = omega.squaredNorm();
    if (!inertia.spins && omega2 > kLeastLeft * rate2) m.rate = std::sqrt(omega2 + (rate2 - before.squaredNorm()));
  }
}

/// Computed by normals: for every n with n.r > 0 the pair is apart for scales above (hA + hB) / n.r = 1 - g / n.r; the
/// best n is near the one that maximises g, which is improved until the pair is out of the question or converged.
double UniaxialBodies::contact_scale(int i, int j, const Vector3d& r, const Vector3d& start, double now,
                                     double enough) const {
  const UniaxialKind& A = kind_of(i);
  const UniaxialKind& B = kind_of(j);
  const Vector3d u_a = entries_[at(i)].motion.axis_at(now);
  const Vector3d u_b = entries_[at(j)].motion.axis_at(now);
  switch (family_of(i, j)) {
    case UniaxialFamily::rods:
      return rod_contact_scale(A.rod, B.rod, r, u_a, u_b, enough);
    case UniaxialFamily::mixed:
      return A.is_rod ? mixed_contact_scale(j, i, -r, -start, now, enough)
                      : mixed_contact_scale(i, j, r, start, now, enough);
    case UniaxialFamily::spheroids:
      break;
  }
  Vector3d n = start.isZero(0) ? geom::kernel::cold_normal(A.shape, B.shape, r, u_a, u_b) : start;
  double best = 1;
  const auto evaluate = [&](const Vector3d& m) { return evaluate_uniaxial(A.shape, B.shape, r, u_a, u_b, m); };
  const auto done = [&](const UniaxialEvaluation& e) {
    if (n.dot(r) > 0) best = std::min(best, 1 - e.g / n.dot(r));
    return best <= enough || e.step2 < geom::kNormalTolerance2;
  };
  UniaxialEvaluation e = evaluate(n);
  int budget = geom::kMaxIterations;
  const double scale = geom::kRoundingFactor * (A.bounding_radius + B.bounding_radius);
  (void)geom::kernel::ascend(evaluate, scale, done, budget, n, e);
  return best;
}

double UniaxialBodies::mixed_contact_scale(int i, int j, const Vector3d& r, const Vector3d& start, double now,
                                           double enough) const {
  const UniaxialKind& A = kind_of(i);
  const Rod& B = kind_of(j).rod;
  MixedGap<true>::Pair pair{};
  pair.shape = A.shape;
  pair.l = B.half_length;
  pair.radius = B.radius;
  pair.r = r;
  pair.u_a = entries_[at(i)].motion.axis_at(now);
  pair.u_b = entries_[at(j)].motion.axis_at(now);
  Vector3d n = start.isZero(0) ? mixed_cold_normal(pair) : start;
  double best = 1;
  const auto evaluate = [&](const Vector3d& m) { return complete_mixed(pair, pair.sample(m), m); };
  const auto done = [&](const MixedEvaluation& e) {
    if (n.dot(r) > 0) best = std::min(best, 1 - e.g / n.dot(r));
    return best <= enough || e.step2 < geom::kNormalTolerance2;
  };
  MixedEvaluation e = evaluate(n);
  int budget = geom::kMaxIterations;
  const double scale = geom::kRoundingFactor * (A.bounding_radius + B.half_length + B.radius);
  (void)geom::kernel::ascend(evaluate, scale, done, budget, n, e);
  return best;
}

bool UniaxialBodies::all_spheres() const {
  return std::all_of(kinds_.begin(), kinds_.end(), [](const UniaxialKind& kind) { return kind.sphere; });
}

FamilyKernels UniaxialBodies::kernels(const std::optional<geom::InstructionSet>& batches, UniaxialFamily pairs) const {
  // Most pairs of near spheres are told apart by their bounding spheres, without what the kernels are good at
  // (bench_engine, vectors/).
  constexpr double kNearSphere = 0.9;
  const UniaxialKernels found = find_uniaxial_kernels(batches);
  if (all_spheres()) return found.spheres;
  if (pairs == UniaxialFamily::rods) return found.rods;
  if (pairs == UniaxialFamily::mixed) return {};
  const bool near_spheres = inscribed_radius_ > kNearSphere * bounding_radius_;
  return near_spheres && batches == geom::InstructionSet::best ? FamilyKernels() : found.spheroids;
}

}  // namespace ed::internal
