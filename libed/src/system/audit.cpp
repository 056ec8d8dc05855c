#include "base/poll.h"
#include "cells/levels.h"
#include "contact/body_shapes.h"
#include "system/bounding_radii.h"

#include <ed/system.h>
#include <ed/tolerances.h>

#include <geom/distance.h>
#include <geom/pose.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <span>
#include <sstream>
#include <stdexcept>
#include <vector>

namespace ed {
namespace {

using Eigen::Vector3d;

/// Largest number of boxes between a body and an image of another that it can touch.
constexpr double kMostImagesAlong = 8;

bool is_finite(const Body& body) {
  return body.position.allFinite() && body.rotation.allFinite() && body.velocity.allFinite() &&
         body.angular_velocity.allFinite();
}

/// Comparison of all near pairs of a state.
class PairsAudit {
 public:
  PairsAudit(const System& system, Audit& audit)
      : system_(system),
        audit_(audit),
        // Pairs whose bounding spheres overlap, or are within a mean distance of that, so that a closest pair can be
        // named in a dilute system too.
        margin_(0.5 * system.box / std::cbrt(system.size())),
        sizes_(internal::bounding_radii(system)) {
    poses_.reserve(system.bodies.size());
    for (const Body& body : system.bodies) poses_.emplace_back(body.rotation, body.position);
    for (const double size : sizes_) largest_ = std::max(largest_, size);
  }

  void run(const std::function<void()>& poll) {
    // The nearest image is the only one within half the box.
    if (2 * largest_ <= 0.5 * system_.box) {
      nearest_images(poll);
    } else {
      all_images(poll);
    }
  }

 private:
  const geom::Pose& pose(int i) const { return poses_[static_cast<std::size_t>(i)]; }
  double size(int i) const { return sizes_[static_cast<std::size_t>(i)]; }

  void nearest_images(const std::function<void()>& poll) {
    std::vector<double> extents;
    extents.reserve(sizes_.size());
    for (const double size : sizes_) extents.push_back(std::min(size + margin_, 0.25 * system_.box));
    internal::CellLevels cells(extents, system_.box);
    for (int i = 0; i < system_.size(); ++i) cells.place(i, pose(i).position());
    std::vector<internal::NearBody> near;
    for (int i = 0; i < system_.size(); ++i) {
      internal::poll_at(i, poll);
      cells.search(i, pose(i).position(), near, [&](std::span<const internal::NearBody> others) {
        for (const auto& [j, r] : others) {
          if (j > i) add(i, j, r);
        }
      });
    }
  }

  /// Tries every image of all pairs that bounding spheres allow, those of a body itself too.
  void all_images(const std::function<void()>& poll) {
    const double box = system_.box;
    if (2 * largest_ > kMostImagesAlong * box) {
      std::ostringstream message;
      message << "audit: an edge of the box of " << box << " for bodies of bounding radius " << largest_
              << "; accepted: at least " << 2 / kMostImagesAlong << " of that radius";
      throw std::invalid_argument(message.str());
    }
    for (int i = 0; i < system_.size(); ++i) {
      for (int j = i; j < system_.size(); ++j) images(i, j, poll);
    }
  }

  void images(int i, int j, const std::function<void()>& poll) {
    const double box = system_.box, reach = size(i) + size(j) + margin_;
    Vector3d r = pose(j).position() - pose(i).position();
    for (int axis = 0; axis < 3; ++axis) r[axis] -= box * std::round(r[axis] / box);
    const int most = static_cast<int>(std::floor(reach / box + 0.5));
    for (int x = -most; x <= most; ++x) {
      for (int y = -most; y <= most; ++y) {
        for (int z = -most; z <= most; ++z) {
          const bool is_first_half = x != 0 ? x > 0 : y != 0 ? y > 0 : z > 0;
          if (i == j && !is_first_half) continue;  // an image and its opposite are one pair
          const Vector3d there = r + box * Vector3d(x, y, z);
          if (there.norm() > reach) continue;
          add(i, j, there);
          internal::poll_at(tried_, poll);
          tried_ = (tried_ + 1) % 256;
        }
      }
    }
  }

  void add(int i, int j, const Vector3d& r) {
    const geom::Pose X_image(pose(j).rotation(), pose(i).position() + r);
    const geom::DistanceResult d = distance(system_.species_of(i).shape, pose(i), system_.species_of(j).shape, X_image);
    if (!(d.status == geom::DistanceStatus::separated || d.status == geom::DistanceStatus::overlapping)) {
      ++audit_.unanswered;
      return;
    }
    if (d.distance < -kAuditOverlap * (size(i) + size(j))) ++audit_.overlaps;
    if (d.distance < audit_.minimum_distance) {
      audit_.minimum_distance = d.distance;
      audit_.closest_i = i;
      audit_.closest_j = j;
    }
  }

  const System& system_;
  Audit& audit_;
  double margin_;
  std::vector<double> sizes_;
  double largest_ = 0;
  int tried_ = 0;  ///< number of images that all_images has tried, modulo 256
  std::vector<geom::Pose> poses_;
};

}  // namespace

Audit audit(const System& system, const std::function<void()>& poll) {
  Audit result;
  result.minimum_distance = system.box;
  result.kinetic = kinetic_state(system);
  const bool has_box = system.box > 0 && std::isfinite(system.box);
  result.finite = has_box && std::all_of(system.bodies.begin(), system.bodies.end(), is_finite);
  if (result.finite) PairsAudit(system, result).run(poll);
  return result;
}

}  // namespace ed
