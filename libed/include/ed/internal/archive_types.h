#pragma once

/// The members of libed's and libgeom's public types; see archive.h.

#include <ed/equilibration.h>
#include <ed/internal/archive.h>
#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/system.h>

#include <geom/any_shape.h>
#include <geom/obb.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <stdexcept>

namespace ed::internal {

// ---- Shapes and poses

template <>
struct Blank<geom::Ellipsoid> {
  static geom::Ellipsoid make() { return geom::Ellipsoid(Eigen::Vector3d::Ones()); }
};
template <>
struct Blank<geom::Superellipsoid> {
  static geom::Superellipsoid make() { return {Eigen::Vector3d::Ones(), 1, 1}; }
};
/// A user's own shape is code: what is written only tells it from others.
template <>
struct Blank<CustomShape> {
  static CustomShape make() { throw std::invalid_argument("state: a user's own shape cannot be read"); }
};

inline void fields(Writer& archive, const geom::Ellipsoid& shape) {
  archive(shape.semi_axes());
}
inline void fields(Reader& archive, geom::Ellipsoid& shape) {
  shape = geom::Ellipsoid(archive.value<Eigen::Vector3d>());
}

inline void fields(Writer& archive, const geom::Superellipsoid& shape) {
  archive(shape.semi_axes(), shape.e1(), shape.e2());
}
inline void fields(Reader& archive, geom::Superellipsoid& shape) {
  const auto semi_axes = archive.value<Eigen::Vector3d>();
  const auto e1 = archive.value<double>();
  const auto e2 = archive.value<double>();
  shape = geom::Superellipsoid(semi_axes, e1, e2);
}

inline void fields(Writer& archive, const CustomShape& shape) {
  archive(shape.name(), shape.volume(), shape.bounding_radius(), shape.inscribed_radius(), shape.symmetry_axis());
}
inline void fields(Reader& /*archive*/, CustomShape& /*shape*/) {}

inline void fields(Writer& archive, const geom::Pose& pose) {
  archive(pose.rotation(), pose.position());
}
inline void fields(Reader& archive, geom::Pose& pose) {
  const auto rotation = archive.value<Eigen::Matrix3d>();
  // Unchecked: the constructor would make it orthonormal again, in other bits.
  pose = geom::kernel::unchecked_pose(rotation, archive.value<Eigen::Vector3d>());
}

template <class Archive, Is<geom::OrientedBox> T>
void fields(Archive& archive, T& box) {
  archive(box.centre, box.axes, box.half_extents);
}

// ---- Systems

template <class Archive, Is<Species> T>
void fields(Archive& archive, T& species) {
  archive(species.shape, species.mass, species.inertia, species.spins);
}

template <class Archive, Is<Body> T>
void fields(Archive& archive, T& body) {
  archive(body.species, body.position, body.rotation, body.velocity, body.angular_velocity);
}

template <class Archive, Is<System> T>
void fields(Archive& archive, T& system) {
  archive(system.box, system.species, system.bodies);
}

template <class Archive, Is<KineticState> T>
void fields(Archive& archive, T& state) {
  archive(state.translational_energy, state.rotational_energy, state.spin_energy, state.translational_kT,
          state.rotational_kT, state.rotational_freedoms, state.spin_freedoms, state.axis_energy, state.momentum);
}

template <class Archive, Is<Motion> T>
void fields(Archive& archive, T& motion) {
  archive(motion.pose, motion.velocity, motion.angular_velocity, motion.inertia, motion.time);
}

// ---- Simulations

template <class Archive, Is<Counters> T>
void fields(Archive& archive, T& c) {
  archive(c.collisions, c.predictions, c.evaluations, c.kernel_calls, c.refinements, c.cold_restarts, c.rescues,
          c.neighbour_rebuilds, c.envelope_checks, c.candidate_tests, c.overlaps, c.declined, c.parting_contacts,
          c.unrecorded_failures);
}

template <class Archive, Is<Collision> T>
void fields(Archive& archive, T& collision) {
  archive(collision.time, collision.i, collision.j);
}

template <class Archive, Is<Snapshot> T>
void fields(Archive& archive, T& snapshot) {
  archive(snapshot.time, snapshot.position, snapshot.axis, snapshot.rotation, snapshot.phi_lab, snapshot.phi_body,
          snapshot.velocity, snapshot.angular_velocity);
}

template <class Archive, Is<geom::WitnessPair> T>
void fields(Archive& archive, T& pair) {
  archive(pair.point_a, pair.point_b, pair.status);
  expect(archive, pair.status <= geom::SeedStatus::declined, "a seed's status");
}

template <class Archive, Is<FailedDistance> T>
void fields(Archive& archive, T& call) {
  archive(call.method, call.status, call.shape_a, call.shape_b, call.X_WA, call.X_WB, call.seed);
  expect(archive, call.method <= DistanceMethod::newton5, "a distance's method");
  expect(archive, call.status <= geom::DistanceStatus::singular, "a distance's status");
}

/// All but the shapes, which may be a user's own.
template <class Archive, Is<FailedPair> T>
void fields_but_shapes(Archive& archive, T& pair) {
  archive(pair.reason, pair.motion_i, pair.motion_j, pair.time, pair.i, pair.j, pair.finder, pair.eps_d, pair.distance);
  expect(archive, pair.reason <= FailureReason::declined, "a failure's reason");
  expect(archive, pair.finder <= Finder::bracketing, "a failure's finder");
}

template <class Archive, Is<FailedPair> T>
void fields(Archive& archive, T& pair) {
  archive(pair.shape_i, pair.shape_j);
  fields_but_shapes(archive, pair);
}

/// Without the seed, which is code.
template <class Archive, Is<ContactOptions> T>
void fields(Archive& archive, T& options) {
  archive(options.finder, options.eps_d, options.distance, options.root);
}

// ---- Observables

template <class Archive, Is<BodyGroup> T>
void fields(Archive& archive, T& group) {
  archive(group.number, group.rotation_axes);
}

template <class Archive, Is<ObservablesOptions> T>
void fields(Archive& archive, T& options) {
  archive(options.number, options.duration, options.longest_lag, options.groups, options.wave_numbers);
}

template <class Archive, Is<Relaxation> T>
void fields(Archive& archive, T& r) {
  archive(r.q, r.c2, r.f_self, r.relaxations, r.relaxation_time, r.Z_change, r.S_change, r.reached);
}

}  // namespace ed::internal
