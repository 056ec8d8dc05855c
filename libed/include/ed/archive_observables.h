#pragma once

/// @file
/// Serialisation of the options of observables and of equilibration (archive.h).

#include <ed/archive.h>
#include <ed/equilibration.h>
#include <ed/observables.h>

namespace ed::archive {

template <class Archive, Is<BodyGroup> T>
void fields(Archive& archive, T& group) {
  archive(group.number, group.rotation_axes, group.oriented);
}

template <class Archive, Is<ObservablesOptions> T>
void fields(Archive& archive, T& options) {
  archive(options.number, options.duration, options.longest_lag, options.groups, options.wave_numbers,
          options.collective, options.bonds.steinhardt, options.bonds.neighbours, options.bonds.hexatic);
}

template <class Archive, Is<Order> T>
void fields(Archive& archive, T& o) {
  archive(o.S, o.S_octants, o.bragg, o.Z_change, o.S_change, o.bragg_change, o.nematic, o.crystal, o.uniform,
          o.stationary);
}

template <class Archive, Is<Relaxation> T>
void fields(Archive& archive, T& r) {
  archive(r.q, r.c2, r.f_self, r.relaxations, r.relaxation_time, r.Z_change, r.S_change, r.reached, r.by, r.order);
}

}  // namespace ed::archive
