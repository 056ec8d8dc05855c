#include "bodies/general.h"

#include "contact/body_shapes.h"
#include "contact/sphere_contact.h"
#include "motion/checks.h"

#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

GeneralKind general_kind(const Species& species) {
  const int axis = symmetry_axis(species).value_or(-1);
  Vector3d inertia = species.inertia;
  // Irrelevant, and maybe no number; spherical tops turn uniformly.
  if (axis >= 0 && !species.spins) inertia[axis] = inertia[(axis + 1) % 3];
  return {.body = GapShape(species.shape),
          .bounding_radius = bounding_radius(species.shape),
          .inscribed_radius = inscribed_radius(species.shape),
          .half_extents = half_extents(species.shape),
          .lever = turning_lever(species.shape),
          .mass = species.mass,
          .inertia = inertia,
          .symmetry_axis = axis,
          .spins = species.spins,
          .sphere = std::holds_alternative<geom::Sphere>(species.shape),
          .axis = axis < 0 ? 2 : axis};
}

/// Returns the angular velocity, without spin where the species has none: it is across the axis of revolution then and
/// stays so.
Vector3d allowed_omega(const GeneralKind& kind, const Matrix3d& R, const Vector3d& omega) {
  if (kind.spins) return omega;
  const Vector3d u = R.col(kind.symmetry_axis);
  return omega - omega.dot(u) * u;
}

}  // namespace

GeneralBodies::GeneralBodies(const System& system)
    : motions_(at(system.size())), turned_(at(system.size())), events_(at(system.size())) {
  for (const Species& species : system.species) {
    kinds_.push_back(general_kind(species));
    bounding_radius_ = std::max(bounding_radius_, kinds_.back().bounding_radius);
    inscribed_radius_ = std::min(inscribed_radius_, kinds_.back().inscribed_radius);
  }
  for (int i = 0; i < system.size(); ++i) {
    const Body& body = system.bodies[at(i)];
    kind_.push_back(body.species);
    const GeneralKind& kind = kind_of(i);
    const Vector3d omega = allowed_omega(kind, body.rotation, body.angular_velocity);
    motions_[at(i)] = {body.position, body.velocity, FreeTop(kind.inertia, body.rotation, omega), 0};
  }
}

Motion GeneralBodies::motion(int i, double t) const {
  const RigidMotion& m = motions_[at(i)];
  const TopState top = m.top.at(t - m.time);
  return {geom::Pose(top.R, m.position_at(t)), m.velocity, top.omega, kind_of(i).inertia, t};
}

TurnedAngles GeneralBodies::turned_at(int i, double t) const {
  const RigidMotion& m = motions_[at(i)];
  const GeneralKind& kind = kind_of(i);
  TurnedAngles turned = turned_[at(i)];
  if (kind.symmetry_axis < 0) {
    const TurnedAngles flight = m.top.turned(t - m.time);
    turned.world += flight.world;
    turned.body += flight.body;
    return turned;
  }
  // Spin excluded: what a body of revolution makes of it.
  TopMotion top = top_motion(motion(i, m.time), kind.symmetry_axis);
  advance(top.inertia, t, top.axis, top.frame);
  turned.world += top.frame.phi_lab;
  turned.body[(kind.symmetry_axis + 1) % 3] += top.frame.phi_body.x();
  turned.body[(kind.symmetry_axis + 2) % 3] += top.frame.phi_body.y();
  return turned;
}

void GeneralBodies::sample(double t, Snapshot& snapshot) const {
  for (int i = 0; i < number(); ++i) {
    const TurnedAngles turned = turned_at(i, t);
    const GeneralKind& kind = kind_of(i);
    const RigidMotion& m = motions_[at(i)];
    const TopState top = m.top.at(t - m.time);
    snapshot.axis[at(i)] = top.R.col(kind.axis);
    snapshot.rotation[at(i)] = top.R;
    snapshot.phi_lab[at(i)] = turned.world;
    snapshot.phi_body[at(i)] = turned.body;
    snapshot.velocity[at(i)] = m.velocity;
    snapshot.angular_velocity[at(i)] = top.omega;
    if (kind.symmetry_axis < 0) continue;
    const Vector3d u = top.R.col(kind.symmetry_axis);
    snapshot.angular_velocity[at(i)] -= top.omega.dot(u) * u;
  }
}

void GeneralBodies::scale_positions(double factor, double now) {
  for (RigidMotion& m : motions_) m.position = factor * m.position_at(now) - (now - m.time) * m.velocity;
}

template <class F>
decltype(auto) GeneralBodies::with_gap(int i, int j, const Vector3d& r, double now, F&& f) const {
  return with_pair_gap(kind_of(i).body, motions_[at(i)], kind_of(j).body, motions_[at(j)], r, now, std::forward<F>(f));
}

Finding GeneralBodies::find_contact(int i, int j, const Vector3d& r, double now, double end, int max_evaluations,
                                    const ContactOptions& options, Vector3d& n, FinderCounters& count,
                                    std::optional<Unsolved>& unsolved) const {
  if (options.finder == Finder::bracketing) {
    return bracketing_contact(
        {*kind_of(i).body.implicit, *kind_of(j).body.implicit, motions_[at(i)], motions_[at(j)], r, now}, now, end,
        options, n, count, unsolved);
  }
  if (kind_of(i).sphere && kind_of(j).sphere) {
    const Vector3d v = velocity(j) - velocity(i);
    return sphere_contact(r, v, kind_of(i).bounding_radius + kind_of(j).bounding_radius, now, end, n, count);
  }
  return with_gap(i, j, r, now,
                  [&](const auto& gap) { return certified_contact(gap, now, end, max_evaluations, n, count); });
}

void GeneralBodies::start_flight(int i, double now, const TopState& state, const Vector3d& velocity,
                                 const Vector3d& omega) {
  turned_[at(i)] = turned_at(i, now);
  RigidMotion& m = motions_[at(i)];
  m.position = m.position_at(now);
  m.velocity = velocity;
  m.top = FreeTop(kind_of(i).inertia, state.R, allowed_omega(kind_of(i), state.R, omega));
  m.time = now;
}

GeneralBodies::Contact GeneralBodies::contact(int i, int j, const Vector3d& r, const Vector3d& n, double now) const {
  const ContactPoints points =
      with_gap(i, j, r, now, [&](const auto& gap) { return gap.contact_points(gap.at(now), n); });
  const auto top = [&](int body) { return motions_[at(body)].top.at(now - motions_[at(body)].time); };
  // The spin of a body of revolution has no part in it, so that energy is kept however well its contact point is known.
  const auto spin = [this](int body, const TopState& at_contact) -> Vector3d {
    const int axis = kind_of(body).symmetry_axis;
    if (axis < 0) return Vector3d::Zero();
    const Vector3d u = at_contact.R.col(axis);
    return at_contact.omega.dot(u) * u;
  };
  const auto contact_body = [&](int body, const TopState& at_contact, const Vector3d& arm,
                                const Vector3d& spinning) -> ContactBody {
    const GeneralKind& kind = kind_of(body);
    Vector3d inverse = kind.inertia.cwiseInverse();
    if (kind.symmetry_axis >= 0) inverse[kind.symmetry_axis] = 0;
    Matrix3d inverse_inertia = Matrix3d::Zero();
    for (int k = 0; k < 3; ++k) {
      inverse_inertia += inverse[k] * at_contact.R.col(k) * at_contact.R.col(k).transpose();
    }
    return {1 / kind.mass, inverse_inertia, arm, motions_[at(body)].velocity, at_contact.omega - spinning};
  };
  const TopState top_i = top(i);
  const TopState top_j = top(j);
  const Vector3d spin_i = spin(i, top_i);
  const Vector3d spin_j = spin(j, top_j);
  return {
      contact_body(i, top_i, points.a, spin_i), contact_body(j, top_j, points.b, spin_j), top_i, top_j, spin_i, spin_j};
}

void GeneralBodies::leave(int i, int j, const Contact& contact, double now) {
  start_flight(i, now, contact.top_a, contact.a.velocity, contact.a.angular_velocity + contact.spin_a);
  start_flight(j, now, contact.top_b, contact.b.velocity, contact.b.angular_velocity + contact.spin_b);
}

void GeneralBodies::set_velocity(int i, const Vector3d& velocity, double now) {
  RigidMotion& motion = motions_[at(i)];
  motion.position += (now - motion.time) * (motion.velocity - velocity);
  motion.velocity = velocity;
}

double GeneralBodies::contact_scale(int i, int j, const Vector3d& r, const Vector3d& start, double now,
                                    double enough) const {
  return with_gap(i, j, r, now, [&](const auto& gap) {
    const auto state = gap.at(now);
    Vector3d n = start.isZero(0) ? gap.cold_normal(state) : start;
    double best = 1;
    const auto done = [&](const auto& e) {
      if (n.dot(r) > 0) best = std::min(best, 1 - e.g / n.dot(r));
      return best <= enough || e.step2 < geom::kNormalTolerance2;
    };
    auto e = gap.evaluate(state, n);
    int budget = geom::kMaxIterations;
    if (gap.ascend(state, done, budget, n, e) == geom::kernel::Ascent::converged) (void)done(e);
    return best;
  });
}

}  // namespace ed::internal
