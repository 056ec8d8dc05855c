#pragma once

/// Dilated envelopes: the region within a distance delta of where a body of revolution was when its list was made.
///
/// A body at (r, u) lies inside the envelope of (r0, u0) while |r - r0| + |a - b| theta <= delta, theta the angle
/// between u and u0, because the support function changes by at most |a - b| a radian. Two bodies whose envelopes do
/// not meet, gap of the bodies at (r0, u0) > 2 delta, cannot touch.

#include "dilated_gap.h"
#include "envelope_limits.h"
#include "envelopes.h"
#include "find_kernels.h"
#include "large_vector.h"
#include "neighbour_lists.h"
#include "periodic.h"
#include "uniaxial_bodies.h"

#include <geom/internal/uniaxial.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace ed::internal {

class DilatedEnvelopes final : public Envelopes<UniaxialBodies> {
 public:
  /// `thickness`: delta. Bodies leave at `exit_thickness` <= delta already, which is what a shrinking box eats up.
  /// `kernel`: for find_meetings; null: one pair at a time.
  DilatedEnvelopes(const UniaxialBodies& bodies, double thickness, double exit_thickness,
                   MeetingKernel* kernel = nullptr)
      : kernel_(kernel),
        bounding_radius_(bodies.bounding_radius()),
        thickness_(thickness),
        exit_thickness_(exit_thickness) {
    for (const UniaxialKind& kind : bodies.kinds()) {
      kinds_.push_back({kind.shape, kind.bounding_radius - kind.inscribed_radius});
    }
    for (int i = 0; i < bodies.number(); ++i) kind_.push_back(bodies.kind_index(i));
    centre_.resize(kind_.size());
    axis_.resize(kind_.size());
  }
  /// Bodies of one kind.
  DilatedEnvelopes(int number, const geom::internal::Spheroid& shape, double axis_difference, double bounding_radius,
                   double thickness, double exit_thickness)
      : kinds_{{shape, axis_difference}},
        kind_(static_cast<std::size_t>(number), 0),
        bounding_radius_(bounding_radius),
        thickness_(thickness),
        exit_thickness_(exit_thickness),
        centre_(static_cast<std::size_t>(number)),
        axis_(static_cast<std::size_t>(number)) {}

  double thickness() const override { return thickness_; }
  double exit_thickness() const { return exit_thickness_; }
  double reach() const override { return 2 * (bounding_radius_ + thickness_); }
  /// See Envelopes.
  ///
  /// Pairs outside the lists had a gap above 2 delta when the lists were made. Shrinking by s brings a pair of gap G
  /// and hA + hB = h down to s (G + h) - h, which stays above 2 delta_exit while 1 - s <= 2 (delta - delta_exit) / (2
  /// delta + h).
  double least_scale() const override { return 1 - 2 * (thickness_ - exit_thickness_) / reach(); }
  const Eigen::Vector3d& centre(int i) const { return centre_[static_cast<std::size_t>(i)]; }

  void place(int i, const UniaxialBodies& bodies, double now) override {
    place(i, bodies.position_at(i, now), bodies.axis_motion(i).axis_at(now));
  }
  void place(int i, const Eigen::Vector3d& position, const Eigen::Vector3d& axis) {
    centre_[static_cast<std::size_t>(i)] = position;
    axis_[static_cast<std::size_t>(i)] = axis;
  }

  void scale(double factor) override {
    for (Eigen::Vector3d& c : centre_) c *= factor;
  }

  double exit_time(int i, const UniaxialBodies& bodies, double now, double box) const override {
    const AxisMotion& motion = bodies.axis_motion(i);
    return exit_time(i, motion, motion.position_at(now), motion.axis_at(now), now, box);
  }
  double exit_time(int i, const AxisMotion& motion, const Eigen::Vector3d& position, const Eigen::Vector3d& axis,
                   double now, double box) const {
    const std::size_t k = static_cast<std::size_t>(i);
    const double axis_difference = kind_of(i).axis_difference;
    const Eigen::Vector3d d = nearest_image(position - centre_[k], box);
    const double left = exit_thickness_ - axis_difference * angle_bound((axis - axis_[k]).norm());
    const double d2 = d.squaredNorm();
    if (!(left > 0) || d2 >= left * left) return now;
    // First root of |d + v s| + w s = left, w the fastest that turning can move the surface.
    const double w = surface_speed(i, motion);
    const double A = motion.velocity.squaredNorm() - w * w;
    const double B = d.dot(motion.velocity) + left * w;
    const double C = d2 - left * left;
    const double denominator = B + std::sqrt(std::max(0.0, B * B - A * C));
    return denominator > 0 ? now - C / denominator : kNever;
  }

  double worthwhile(int i, const UniaxialBodies& bodies) const override { return worthwhile(i, bodies.axis_motion(i)); }
  double worthwhile(int i, const AxisMotion& motion) const {
    return 0.15 * exit_thickness_ / (motion.velocity.norm() + surface_speed(i, motion) + 1e-300);
  }

  bool may_meet(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override {
    const geom::internal::Spheroid& shape_i = kind_of(i).shape;
    const geom::internal::Spheroid& shape_k = kind_of(k).shape;
    const Eigen::Vector3d& u_i = axis_[static_cast<std::size_t>(i)];
    const Eigen::Vector3d& u_k = axis_[static_cast<std::size_t>(k)];
    const double limit = 2 * thickness_;
    // Most pairs are told apart by the gap along the line of centres already.
    if (apart_along_centres(shape_i, shape_k, u_i, u_k, r, limit)) return false;
    normal = geom::internal::cold_normal(shape_i, shape_k, r, u_i, u_k);
    auto e = geom::internal::evaluate_uniaxial(shape_i, shape_k, r, u_i, u_k, normal);
    if (e.g > limit) return false;
    for (int step = 0; step < kMeetingSteps && e.g + e.decrement > limit; ++step) {
      normal = geom::internal::step_on_sphere(normal, e.step);
      e = geom::internal::evaluate_uniaxial(shape_i, shape_k, r, u_i, u_k, normal);
      if (e.g > limit) return false;
    }
    normal = geom::internal::step_on_sphere(normal, e.step);
    return true;
  }

  void find_meetings(int i, std::span<const NearBody> near, int first, std::vector<Meeting>& found) const override {
    if (kernel_ == nullptr) return Envelopes::find_meetings(i, near, first, found);
    found.clear();
    MeetingInput in;
    std::array<const NearBody*, kBlockMeetings> near_of;
    put_one(i, in);
    for (std::size_t next = 0; next < near.size();) {
      int lanes = 0;
      for (; next < near.size() && lanes < kBlockMeetings; ++next) {
        const int k = near[next].body;
        if (k < first || k == i) continue;
        put_other(k, near[next].r, in, lanes);
        near_of[static_cast<std::size_t>(lanes++)] = &near[next];
      }
      if (lanes == 0) return;
      const NearBody& last = *near_of[static_cast<std::size_t>(lanes - 1)];
      for (int lane = lanes; lane % kLongestVector != 0; ++lane) put_other(last.body, last.r, in, lane);
      MeetingOutput out;
      kernel_(in, lanes, out);
      for (int lane = 0; lane < lanes; ++lane) {
        const auto& [k, r] = *near_of[static_cast<std::size_t>(lane)];
        const double verdict = out.rows[MeetingOutput::verdict][lane];
        if (verdict == MeetingOutput::apart) continue;
        const auto normal = [&](int axis) { return out.rows[MeetingOutput::normal + axis][lane]; };
        Meeting meeting{k, {normal(0), normal(1), normal(2)}};
        if (verdict == MeetingOutput::open && !may_meet(i, k, r, meeting.normal)) continue;
        found.push_back(meeting);
      }
    }
  }

  void save(Writer& writer) const override { fields(writer, *this); }
  void load(Reader& reader) override { fields(reader, *this); }

 private:
  void put_one(int i, MeetingInput& in) const {
    put_shape(kind_of(i).shape, in.one_shape, 0);
    put_vector(axis_[static_cast<std::size_t>(i)], in.one_axis, 0);
    in.limit = 2 * thickness_;
  }
  void put_other(int k, const Eigen::Vector3d& r, MeetingInput& in, int lane) const {
    put_shape(kind_of(k).shape, in.rows + MeetingInput::shape, lane);
    put_vector(axis_[static_cast<std::size_t>(k)], in.rows + MeetingInput::axis, lane);
    put_vector(r, in.rows + MeetingInput::r, lane);
  }

  struct Kind {
    geom::internal::Spheroid shape;
    double axis_difference;  ///< |a - b|
  };

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.thickness_, self.exit_thickness_, self.centre_, self.axis_);
    expect(archive, self.centre_.size() == self.kind_.size() && self.axis_.size() == self.kind_.size(),
           "the envelopes of the bodies");
    expect(archive, self.exit_thickness_ >= 0 && self.exit_thickness_ <= self.thickness_, "the room to an exit");
    const auto finite = [](const Eigen::Vector3d& v) { return v.allFinite(); };
    expect(archive,
           std::all_of(self.centre_.begin(), self.centre_.end(), finite) &&
               std::all_of(self.axis_.begin(), self.axis_.end(), finite),
           "an envelope is not finite");
  }

  const Kind& kind_of(int i) const { return kinds_[static_cast<std::size_t>(kind_[static_cast<std::size_t>(i)])]; }
  double surface_speed(int i, const AxisMotion& motion) const {
    return kind_of(i).axis_difference * motion.rate * motion.e2.norm();
  }

  MeetingKernel* kernel_ = nullptr;
  std::vector<Kind> kinds_;
  std::vector<int> kind_;
  double bounding_radius_;
  double thickness_;
  double exit_thickness_;
  LargeVector<Eigen::Vector3d> centre_;
  LargeVector<Eigen::Vector3d> axis_;
};

}  // namespace ed::internal
