#pragma once

/// @file
/// Serialisation of what a simulation returns (archive.h).

#include <ed/archive_system.h>
#include <ed/simulation.h>

namespace ed::archive {

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

/// Archives all members except the shapes, which may be user-defined.
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

/// Archives all members except the seed, which is code.
template <class Archive, Is<ContactOptions> T>
void fields(Archive& archive, T& options) {
  archive(options.finder, options.eps_d, options.distance, options.root);
}

}  // namespace ed::archive
