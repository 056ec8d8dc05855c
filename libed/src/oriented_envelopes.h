#pragma once

/// The paper's envelopes: an oriented bounding parallelepiped (OBP) around each body of revolution, along the body's
/// axes when it was made, its faces a distance delta outside the body.
///
/// Neighbours are the bodies whose boxes meet (separating-axis test). A body leaves its box when it touches one of the
/// six planes, "a particular case of the collision between rigid bodies" (the paper, section 2.1): the same certified
/// search says when.

#include "axis_motion.h"
#include "envelopes.h"

#include <geom/internal/uniaxial.h>
#include <geom/obb.h>

#include <Eigen/Core>

#include <vector>

namespace ed::internal {

/// The thickest box envelope for which nearest images are safe in this periodic box: see OrientedEnvelopes::slack. 0 if
/// the periodic box is below smallest_box.
double thickest_oriented_envelope(const geom::internal::Spheroid& shape, double bounding_radius, double box);

class OrientedEnvelopes final : public Envelopes {
 public:
  OrientedEnvelopes(int number, const geom::internal::Spheroid& shape, double bounding_radius, double thickness,
                    bool spins);

  double thickness() const override { return thickness_; }
  double reach() const override { return reach_; }
  void place(int i, const Eigen::Vector3d& position, const Eigen::Vector3d& axis,
             const Eigen::Vector3d& x_axis) override;
  void scale(double factor) override;
  double exit_time(int i, const AxisMotion& motion, const Eigen::Vector3d& position, const Eigen::Vector3d& axis,
                   double now, double box) const override;
  double worthwhile(const AxisMotion& motion) const override;
  bool may_meet(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override;

  const geom::OrientedBox& box(int i) const { return boxes_[static_cast<std::size_t>(i)]; }

 private:
  template <bool kSpin>
  double exit(const geom::OrientedBox& box, const AxisMotion& motion, const Eigen::Vector3d& position,
              double now) const;

  /// The time in which the surface can cross the thickness; of bodies at rest 1e9, so that times stay finite.
  double crossing_time(const AxisMotion& motion) const;

  geom::internal::Spheroid shape_;
  double bounding_radius_;
  double thickness_;
  bool spins_;
  double reach_;
  Eigen::Vector3d half_extents_;
  std::vector<geom::OrientedBox> boxes_;  ///< axes: body x, body y, the axis of revolution
};

}  // namespace ed::internal
