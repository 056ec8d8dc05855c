#pragma once

/// Envelopes: the regions, fixed in space, in which bodies stay while their neighbour lists are valid.
///
/// Two bodies are neighbours while their envelopes overlap; a body that leaves its envelope gets a new one and a new
/// list. Three kinds, one list code: the dilated body, the paper's oriented box, and the cell of the paper's plain
/// algorithm.

#include "base/archive.h"
#include "base/periodic.h"
#include "cells/near_body.h"

#include <geom/batch.h>

#include <Eigen/Core>

#include <span>
#include <vector>

namespace ed::internal {

/// A body whose envelope may overlap that of another, and the normal to start a contact search from.
struct OverlappingEnvelope {
  int body;
  Eigen::Vector3d normal;
};

/// `Bodies`: UniaxialBodies or GeneralBodies.
template <class Bodies>
class Envelopes {
 public:
  virtual ~Envelopes() = default;

  /// Thickness by which the cost of the lists is tuned (length); 0 for envelopes that have no such parameter.
  virtual double thickness() const = 0;

  /// Largest distance of neighbours, between their positions when their envelopes were made.
  virtual double reach() const = 0;

  /// Returns how far from its position, when it was made, the envelope of a body of this bounding radius extends: two
  /// are neighbours within the sum of both.
  virtual double extent(double /*bounding_radius*/) const { return 0.5 * reach(); }

  /// Least factor by which the box may shrink in all before the lists must be made anew; 1: none.
  virtual double least_scale() const { return 1; }

  /// Makes a new envelope for body i at its state now.
  virtual void place(int i, const Bodies& bodies, double now) = 0;

  /// Prefetches the envelope of body i; nothing where envelopes are too slow for that to matter.
  virtual void fetch(int /*i*/) const {}

  /// Scales the envelopes, as the box and all bodies in it have been.
  virtual void scale(double factor) = 0;

  /// Returns a lower bound of the time when body i leaves its envelope.
  virtual double exit_time(int i, const Bodies& bodies, double now, double box) const = 0;

  /// Returns the shortest time to an exit for which an envelope is kept; for a shorter one a new envelope is cheaper.
  virtual double worthwhile(int i, const Bodies& bodies) const = 0;

  /// Returns whether the envelopes of i and k may overlap, the bodies r apart when they were made (nearest image);
  /// false is proved. Sets a normal from i to k to start a contact search from.
  virtual bool may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const = 0;

  /// Finds those of the bodies near i, in their order, whose envelopes may overlap that of i, by may_overlap. Bodies
  /// before number `first` and i itself are left out.
  virtual void find_overlapping(int i, std::span<const NearBody> near, int first,
                                std::vector<OverlappingEnvelope>& found) const {
    found.clear();
    for (const auto& [k, r] : near) {
      Eigen::Vector3d normal;
      if (k >= first && k != i && may_overlap(i, k, r, normal)) found.push_back({k, normal});
    }
  }

  /// Returns `d`, known in some image, in the image in which i and k can touch.
  virtual Eigen::Vector3d image(int /*i*/, int /*k*/, const Eigen::Vector3d& d, double box) const {
    return nearest_image(d, box);
  }

  /// Uses the kernels of an instruction set from now on, if it uses any.
  virtual void use(const Bodies& /*bodies*/, geom::InstructionSet /*set*/) {}

  /// Writes and reads places and sizes; to be read by envelopes of the same bodies and kind.
  virtual void save(Writer& writer) const = 0;
  virtual void load(Reader& reader) = 0;
};

}  // namespace ed::internal
