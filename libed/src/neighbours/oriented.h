#pragma once

/// The paper's envelopes: an oriented bounding parallelepiped (OBP) around each body of revolution, along the body's
/// axes when it was made, its faces a distance delta outside the body.
///
/// Neighbours are the bodies whose boxes meet (separating-axis test). A body leaves its box when it touches one of the
/// six planes, "a particular case of the collision between rigid bodies" (the paper, section 2.1): the same certified
/// search says when.

#include "base/archive.h"
#include "bodies/uniaxial.h"
#include "neighbours/envelopes.h"

#include <ed/archive_system.h>

#include <geom/kernel/uniaxial.h>
#include <geom/obb.h>

#include <Eigen/Core>

#include <vector>

namespace ed::internal {

/// Returns the thickest box envelope for which nearest images are safe in this periodic box: see
/// OrientedEnvelopes::slack. 0 if the periodic box is below smallest_image_box.
double thickest_oriented_envelope(const geom::kernel::Spheroid& shape, double bounding_radius, double box);
/// Returns the thickest envelope that is safe for all kinds of bodies.
double thickest_oriented_envelope(const UniaxialBodies& bodies, double box);

class OrientedEnvelopes final : public Envelopes<UniaxialBodies> {
 public:
  OrientedEnvelopes(const UniaxialBodies& bodies, double thickness);
  /// Ellipsoids of one kind.
  OrientedEnvelopes(int number, const geom::kernel::Spheroid& shape, double bounding_radius, double thickness,
                    bool spins);

  double thickness() const override { return thickness_; }
  double reach() const override { return reach_; }
  void place(int i, const UniaxialBodies& bodies, double now) override;
  void place(int i, const Eigen::Vector3d& position, const Eigen::Vector3d& axis, const Eigen::Vector3d& x_axis);
  void scale(double factor) override;
  double exit_time(int i, const UniaxialBodies& bodies, double now, double box) const override;
  double exit_time(int i, const AxisMotion& motion, const Eigen::Vector3d& position, double now, double box) const;
  double worthwhile(int i, const UniaxialBodies& bodies) const override { return worthwhile(i, bodies.axis_motion(i)); }
  double worthwhile(int i, const AxisMotion& motion) const;
  bool may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override;

  const geom::OrientedBox& box(int i) const { return boxes_[static_cast<std::size_t>(i)]; }

  void save(Writer& writer) const override { fields(writer, *this); }
  void load(Reader& reader) override { fields(reader, *this); }

 private:
  /// The extents of the kinds follow from the thickness, which must be that of the constructor.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const double thickness = self.thickness_;
    archive(self.thickness_, self.reach_, self.boxes_);
    expect(archive, self.thickness_ == thickness && self.boxes_.size() == self.kind_.size(),
           "the envelopes of the bodies");
  }

  struct Kind {
    geom::kernel::Spheroid shape;
    Rod rod;
    double bounding_radius;
    double axis_difference;
    bool is_rod;
    bool spins;
    Eigen::Vector3d half_extents;
  };

  void add_kind(const geom::kernel::Spheroid& shape, double bounding_radius, bool spins);
  void add_rod(const UniaxialKind& rod);
  void add_reach(const Eigen::Vector3d& half_extents, const Eigen::Vector3d& slack, double bounding_radius);
  const Kind& kind_of(int i) const { return kinds_[static_cast<std::size_t>(kind_[static_cast<std::size_t>(i)])]; }
  template <bool kSpin>
  double exit(int i, const AxisMotion& motion, const Eigen::Vector3d& position, double now) const;
  double rod_exit(int i, const AxisMotion& motion, const Eigen::Vector3d& position, double now) const;

  /// The time in which the surface can cross the thickness; of bodies at rest 1e9, so that times stay finite.
  double crossing_time(const Kind& kind, const AxisMotion& motion) const;

  double thickness_;
  double reach_ = 0;
  std::vector<Kind> kinds_;
  std::vector<int> kind_;
  std::vector<geom::OrientedBox> boxes_;  ///< axes: body x, body y, the axis of revolution
};

}  // namespace ed::internal
