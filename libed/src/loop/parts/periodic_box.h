#pragma once

#include "base/archive.h"
#include "base/large_vector.h"
#include "base/nearest_integer.h"

#include <Eigen/Core>

#include <cstddef>

namespace ed::internal {

/// The periodic cubic box, and the number of its edges by which each body has been wrapped.
class PeriodicBox {
 public:
  PeriodicBox(double edge, int number)
      : edge_(edge), images_(static_cast<std::size_t>(number), Eigen::Vector3i::Zero()) {}

  double edge() const { return edge_; }

  /// Shifts body i into the box, centred at the origin.
  template <class Bodies>
  void wrap(Bodies& bodies, int i, double now) {
    const Eigen::Vector3d r = bodies.position_at(i, now);
    Eigen::Vector3d by = Eigen::Vector3d::Zero();
    for (int k = 0; k < 3; ++k) {
      const double boxes = nearest_integer(r[k] / edge_);
      if (boxes == 0) continue;
      by[k] = -boxes * edge_;
      images_[static_cast<std::size_t>(i)][k] += static_cast<int>(boxes);
    }
    bodies.shift(i, by);
  }

  /// Returns the position of body i as if it had never been wrapped.
  Eigen::Vector3d unwrapped(int i, const Eigen::Vector3d& position) const {
    return position + edge_ * images_[static_cast<std::size_t>(i)].template cast<double>();
  }

  void scale(double factor) { edge_ *= factor; }

  /// Images only: the edge is the system's.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number = self.images_.size();
    archive(self.images_);
    expect(archive, self.images_.size() == number, "the images of the bodies");
  }

 private:
  double edge_;
  LargeVector<Eigen::Vector3i> images_;
};

}  // namespace ed::internal
