#pragma once

/// Envelopes: the regions, fixed in space, in which bodies stay while their neighbour lists are valid.
///
/// Two bodies are neighbours while their envelopes meet; a body that leaves its envelope gets a new one and a new list.
/// Three kinds, one list code: the dilated body, the paper's oriented box, and the cell of the paper's plain algorithm.

#include "base/archive.h"
#include "base/periodic.h"
#include "cells/near_body.h"

#include <Eigen/Core>

#include <span>
#include <vector>

namespace ed::internal {

/// A body whose envelope may meet another, and the normal to start from.
struct OverlappingEnvelope {
  int body;
  Eigen::Vector3d normal;
};

/// `Bodies`: UniaxialBodies or GeneralBodies.
template <class Bodies>
class Envelopes {
 public:
  virtual ~Envelopes() = default;

  /// What the lists' cost is tuned by (length); 0 for envelopes that have no such parameter.
  virtual double thickness() const = 0;

  /// Bodies whose positions when their envelopes were made are further apart than this are no neighbours.
  virtual double reach() const = 0;

  /// By what the box may shrink in all before the lists must be made anew; 1: it must not.
  virtual double least_scale() const { return 1; }

  /// A new envelope for body i at its state now.
  virtual void place(int i, const Bodies& bodies, double now) = 0;

  /// The envelope of body i is read soon. Asks for nothing where envelopes are too slow for that to matter.
  virtual void fetch(int /*i*/) const {}

  /// The box, and all that is in it, has been scaled.
  virtual void scale(double factor) = 0;

  /// A lower bound of the time when body i leaves its envelope.
  virtual double exit_time(int i, const Bodies& bodies, double now, double box) const = 0;

  /// A time short enough that looking at the envelope again after it would be a waste: better make a new one.
  virtual double worthwhile(int i, const Bodies& bodies) const = 0;

  /// Whether the envelopes of i and k, the bodies r apart when they were made (nearest image), may meet; false: they do
  /// not, proved. Sets a normal from i to k to start a contact search from.
  virtual bool may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const = 0;

  /// Of the bodies near i, in their order, those whose envelopes may meet that of i: may_overlap of i with each from
  /// number `first` on, but i itself.
  virtual void find_overlapping(int i, std::span<const NearBody> near, int first,
                                std::vector<OverlappingEnvelope>& found) const {
    found.clear();
    for (const auto& [k, r] : near) {
      Eigen::Vector3d normal;
      if (k >= first && k != i && may_overlap(i, k, r, normal)) found.push_back({k, normal});
    }
  }

  /// `d` in the image in which i and k can touch, known in some image.
  virtual Eigen::Vector3d image(int /*i*/, int /*k*/, const Eigen::Vector3d& d, double box) const {
    return nearest_image(d, box);
  }

  /// Places and sizes as they are; loaded into envelopes of the same bodies and kind.
  virtual void save(Writer& writer) const = 0;
  virtual void load(Reader& reader) = 0;
};

}  // namespace ed::internal
