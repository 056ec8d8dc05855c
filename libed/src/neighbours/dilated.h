#pragma once

/// Dilated envelopes: the region within a distance delta of where a body of revolution was when its list was made.
///
/// A body at (r, u) lies inside the envelope of (r0, u0) while |r - r0| + |a - b| theta <= delta, theta the angle
/// between u and u0, because the support function changes by at most |a - b| a radian. Two bodies whose envelopes do
/// not meet, gap of the bodies at (r0, u0) > 2 delta, cannot touch.

#include "base/large_vector.h"
#include "base/periodic.h"
#include "base/prefetch.h"
#include "bodies/pair.h"
#include "bodies/uniaxial.h"
#include "contact/rods/spheroid_gap.h"
#include "neighbours/envelopes.h"
#include "neighbours/limits.h"
#include "vectors/dilated_gap.h"
#include "vectors/kernels.h"

#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

namespace ed::internal {

class DilatedEnvelopes final : public Envelopes<UniaxialBodies> {
 public:
  /// `thickness`: delta. Bodies leave at `exit_thickness` <= delta already, which is what a shrinking box eats up.
  /// `kernel` is for find_overlapping; null: one pair at a time.
  DilatedEnvelopes(const UniaxialBodies& bodies, double thickness, double exit_thickness,
                   OverlapKernel* kernel = nullptr)
      : kernel_(kernel),
        bounding_radius_(bodies.bounding_radius()),
        thickness_(thickness),
        exit_thickness_(exit_thickness) {
    family_ = bodies.family();
    for (const UniaxialKind& kind : bodies.kinds()) add_kind(kind);
    for (int i = 0; i < bodies.number(); ++i) envelopes_.push_back({{}, bodies.kind_index(i), 0, {}});
  }
  /// Bodies of one kind.
  DilatedEnvelopes(int number, const geom::kernel::Spheroid& shape, double axis_difference, double bounding_radius,
                   double thickness, double exit_thickness)
      : bounding_radius_(bounding_radius),
        thickness_(thickness),
        exit_thickness_(exit_thickness),
        envelopes_(static_cast<std::size_t>(number), DilatedEnvelope{}) {
    add_kind(shape, axis_difference);
  }

  double thickness() const override { return thickness_; }
  double exit_thickness() const { return exit_thickness_; }
  double reach() const override { return 2 * (bounding_radius_ + thickness_); }
  double extent(double bounding_radius) const override { return bounding_radius + thickness_; }
  /// See Envelopes.
  ///
  /// Pairs outside the lists had a gap above 2 delta when the lists were made. Shrinking by s brings a pair of gap G
  /// and hA + hB = h down to s (G + h) - h, which stays above 2 delta_exit while 1 - s <= 2 (delta - delta_exit) / (2
  /// delta + h).
  double least_scale() const override { return 1 - 2 * (thickness_ - exit_thickness_) / reach(); }
  Eigen::Vector3d centre(int i) const { return Eigen::Vector3d(envelope(i).centre); }

  void place(int i, const UniaxialBodies& bodies, double now) override {
    place(i, bodies.position_at(i, now), bodies.axis_at(i, now));
  }
  void place(int i, const Eigen::Vector3d& position, const Eigen::Vector3d& axis) {
    DilatedEnvelope& envelope = envelopes_[static_cast<std::size_t>(i)];
    Eigen::Vector3d::Map(envelope.centre) = position;
    Eigen::Vector3d::Map(envelope.axis) = axis;
  }

  void fetch(int i) const override { prefetch(envelopes_[static_cast<std::size_t>(i)]); }

  void scale(double factor) override {
    for (DilatedEnvelope& envelope : envelopes_) Eigen::Vector3d::Map(envelope.centre) *= factor;
  }

  double exit_time(int i, const UniaxialBodies& bodies, double now, double box) const override {
    const AxisMotion& motion = bodies.axis_motion(i);
    const Eigen::Vector3d position = motion.position_at(now);
    // The axis of a sphere moves nothing.
    if (kind_of(i).axis_difference == 0) return exit_time(i, motion, position, exit_thickness_, 0, now, box);
    return exit_time(i, motion, position, motion.axis_at(now), now, box);
  }
  double exit_time(int i, const AxisMotion& motion, const Eigen::Vector3d& position, const Eigen::Vector3d& axis,
                   double now, double box) const {
    const double left = exit_thickness_ - kind_of(i).axis_difference * angle_bound((axis - axis_of(i)).norm());
    return exit_time(i, motion, position, left, surface_speed(i, motion), now, box);
  }

  double worthwhile(int i, const UniaxialBodies& bodies) const override { return worthwhile(i, bodies.axis_motion(i)); }
  double worthwhile(int i, const AxisMotion& motion) const {
    return kWorthwhile * exit_thickness_ / (motion.velocity.norm() + surface_speed(i, motion) + 1e-300);
  }

  bool may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override {
    switch (family_of(i, k)) {
      case UniaxialFamily::rods:
        return rods_may_overlap(i, k, r, normal);
      case UniaxialFamily::mixed:
        return mixed_may_overlap(i, k, r, normal);
      case UniaxialFamily::spheroids:
        break;
    }
    const geom::kernel::Spheroid& shape_i = kind_of(i).shape;
    const geom::kernel::Spheroid& shape_k = kind_of(k).shape;
    const Eigen::Vector3d u_i = axis_of(i);
    const Eigen::Vector3d u_k = axis_of(k);
    const double limit = 2 * thickness_;
    // Most pairs are told apart by the gap along the line of centres already.
    if (apart_along_centres(shape_i, shape_k, u_i, u_k, r, limit)) return false;
    normal = geom::kernel::cold_normal(shape_i, shape_k, r, u_i, u_k);
    auto e = geom::kernel::evaluate_uniaxial(shape_i, shape_k, r, u_i, u_k, normal);
    if (e.g > limit) return false;
    for (int step = 0; step < kOverlapSteps && e.g + e.decrement > limit; ++step) {
      normal = geom::kernel::step_on_sphere(normal, e.step);
      e = geom::kernel::evaluate_uniaxial(shape_i, shape_k, r, u_i, u_k, normal);
      if (e.g > limit) return false;
    }
    normal = geom::kernel::step_on_sphere(normal, e.step);
    return true;
  }

  void find_overlapping(int i, std::span<const NearBody> near, int first,
                        std::vector<OverlappingEnvelope>& found) const override {
    if (kernel_ == nullptr) return Envelopes::find_overlapping(i, near, first, found);
    found.clear();
    OverlapInput in{nullptr, 0, envelopes_.data(), shapes_.data(), kinds_.size() == 1, i, first, 2 * thickness_};
    for (std::size_t next = 0; next < near.size(); next += kBlockOverlaps) {
      const auto block = near.subspan(next, std::min(near.size() - next, std::size_t{kBlockOverlaps}));
      in.near = block.data();
      in.count = static_cast<int>(block.size());
      OverlapOutput out;
      kernel_(in, out);
      for (int lane = 0; lane < out.count; ++lane) {
        const double verdict = out.rows[OverlapOutput::verdict][lane];
        if (verdict == OverlapOutput::apart) continue;
        const NearBody& other = block[static_cast<std::size_t>(out.place[lane])];
        const auto normal = [&](int axis) { return out.rows[OverlapOutput::normal + axis][lane]; };
        OverlappingEnvelope overlapping{other.body, {normal(0), normal(1), normal(2)}};
        if (verdict == OverlapOutput::open && !may_overlap(i, other.body, other.r, overlapping.normal)) continue;
        found.push_back(overlapping);
      }
    }
  }

  void use(const UniaxialBodies& bodies, geom::InstructionSet set) override { kernel_ = bodies.kernels(set).overlap; }

  void save(Writer& writer) const override { fields(writer, *this); }
  void load(Reader& reader) override { fields(reader, *this); }

 private:
  struct Kind {
    geom::kernel::Spheroid shape;
    Rod rod;
    double axis_difference;  ///< |a - b|
    bool is_rod = false;
    bool sphere = false;
  };

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.thickness_, self.exit_thickness_);
    expect(archive, self.exit_thickness_ >= 0 && self.exit_thickness_ <= self.thickness_, "the room to an exit");
    for (auto& envelope : self.envelopes_) {
      for (auto& x : envelope.centre) archive(x);
      for (auto& u : envelope.axis) archive(u);
    }
    const auto finite = [](const double(&v)[3]) { return Eigen::Vector3d(v).allFinite(); };
    const bool fits = std::all_of(self.envelopes_.begin(), self.envelopes_.end(),
                                  [&](const DilatedEnvelope& e) { return finite(e.centre) && finite(e.axis); });
    expect(archive, fits, "an envelope is not finite");
  }

  void add_kind(const geom::kernel::Spheroid& shape, double axis_difference) {
    kinds_.push_back({shape, {}, axis_difference, false, false});
    shapes_.push_back({{shape.a2, shape.b2, shape.c, shape.rho}});
  }
  void add_kind(const UniaxialKind& kind) {
    if (!kind.is_rod) return add_kind(kind.shape, kind.bounding_radius - kind.inscribed_radius);
    kinds_.push_back({kind.shape, kind.rod, kind.rod.half_length, true, kind.sphere});
    shapes_.push_back({{kind.rod.half_length, kind.rod.radius, 0, 0}});
  }
  UniaxialFamily family_of(int i, int k) const {
    if (family_ != UniaxialFamily::mixed) return family_;
    return internal::family_of(kind_of(i), kind_of(k));
  }
  const DilatedEnvelope& envelope(int i) const { return envelopes_[static_cast<std::size_t>(i)]; }
  Eigen::Vector3d axis_of(int i) const { return Eigen::Vector3d(envelope(i).axis); }
  const Kind& kind_of(int i) const { return kinds_[static_cast<std::size_t>(envelope(i).kind)]; }
  double surface_speed(int i, const AxisMotion& motion) const {
    return kind_of(i).axis_difference * motion.rate * motion.e2.norm();
  }

  /// Returns the first root of |d + v s| + w s = left, d the way from the envelope's centre and w the fastest that
  /// turning can move the surface, as a time.
  double exit_time(int i, const AxisMotion& motion, const Eigen::Vector3d& position, double left, double w, double now,
                   double box) const {
    const Eigen::Vector3d d = nearest_image(position - centre(i), box);
    const double d2 = d.squaredNorm();
    if (!(left > 0) || d2 >= left * left) return now;
    const double A = motion.velocity.squaredNorm() - w * w;
    const double B = d.dot(motion.velocity) + left * w;
    const double C = d2 - left * left;
    const double denominator = B + std::sqrt(std::max(0.0, B * B - A * C));
    return denominator > 0 ? now - C / denominator : kNever;
  }

  bool rods_may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const {
    const Rod& a = kind_of(i).rod;
    const Rod& b = kind_of(k).rod;
    const RodEnvelopesOf<double, Eigen::Vector3d> pair{a.half_length, b.half_length, a.radius + b.radius, r,
                                                       axis_of(i),    axis_of(k)};
    if (pair.apart_along_centres(2 * thickness_)) return false;
    double gap = 0;
    normal = pair.normal(gap);
    return !(gap > 2 * thickness_);
  }

  bool mixed_may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const {
    if (kind_of(i).is_rod) {
      const bool may = mixed_may_overlap(k, i, -r, normal);
      normal = -normal;
      return may;
    }
    MixedPairOf<double, Eigen::Vector3d, geom::kernel::Spheroid, false> pair{};
    pair.shape = kind_of(i).shape;
    pair.l = kind_of(k).rod.half_length;
    pair.radius = kind_of(k).rod.radius;
    pair.r = r;
    pair.u_a = axis_of(i);
    pair.u_b = axis_of(k);
    const double limit = 2 * thickness_;
    normal = geom::kernel::unit_or(r, pair.u_a);
    if (pair.sample(normal).g > limit) return false;
    normal = mixed_cold_normal(pair);
    MixedEvaluation e = complete_mixed(pair, pair.sample(normal), normal);
    for (int step = 0; step < kOverlapSteps && !(e.g > limit) && e.g + e.decrement > limit; ++step) {
      normal = geom::kernel::step_on_sphere(normal, e.step);
      e = complete_mixed(pair, pair.sample(normal), normal);
    }
    if (e.g > limit) return false;
    normal = geom::kernel::step_on_sphere(normal, e.step);
    return true;
  }

  OverlapKernel* kernel_ = nullptr;
  UniaxialFamily family_ = UniaxialFamily::spheroids;
  std::vector<Kind> kinds_;
  std::vector<ShapeNumbers> shapes_;  ///< shapes of the kinds, for the kernel
  double bounding_radius_;
  double thickness_;
  double exit_thickness_;
  LargeVector<DilatedEnvelope> envelopes_;
};

}  // namespace ed::internal
