#pragma once

/// Envelopes of bodies of any shape: dilated, and the paper's oriented boxes (see dilated.h and
/// oriented.h for those of ellipsoids of revolution).
///
/// Turning by an angle theta moves the surface along any normal by at most lever * theta, because it turns the
/// direction seen from the body by theta at the most. So a body at (r, R) lies inside its dilated envelope of (r0, R0)
/// while |r - r0| + lever theta <= delta, theta the angle of R R0^T.

#include "base/archive.h"
#include "bodies/general.h"
#include "neighbours/envelopes.h"

#include <ed/archive_system.h>

#include <geom/obb.h>

#include <Eigen/Core>

#include <algorithm>
#include <vector>

namespace ed::internal {

class GeneralDilatedEnvelopes final : public Envelopes<GeneralBodies> {
 public:
  /// Makes envelopes as DilatedEnvelopes does. `bodies` must outlive this.
  GeneralDilatedEnvelopes(const GeneralBodies& bodies, double thickness, double exit_thickness);

  double thickness() const override { return thickness_; }
  double reach() const override { return 2 * (bodies_->bounding_radius() + thickness_); }
  double extent(double bounding_radius) const override { return bounding_radius + thickness_; }
  double least_scale() const override { return 1 - 2 * (thickness_ - exit_thickness_) / reach(); }
  void place(int i, const GeneralBodies& bodies, double now) override;
  void scale(double factor) override;
  double exit_time(int i, const GeneralBodies& bodies, double now, double box) const override;
  double worthwhile(int i, const GeneralBodies& bodies) const override;
  bool may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override;
  void save(Writer& writer) const override { fields(writer, *this); }
  void load(Reader& reader) override { fields(reader, *this); }

 private:
  struct EnvelopePose {
    Eigen::Vector3d centre;
    Eigen::Matrix3d rotation;

    template <class Archive, class Self>
    static void fields(Archive& archive, Self& self) {
      archive(self.centre, self.rotation);
    }
  };

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number = self.places_.size();
    archive(self.thickness_, self.exit_thickness_, self.places_);
    expect(archive, self.places_.size() == number, "the envelopes of the bodies");
    expect(archive, self.exit_thickness_ >= 0 && self.exit_thickness_ <= self.thickness_, "the room to an exit");
    const auto finite = [](const EnvelopePose& place) {
      return place.centre.allFinite() && place.rotation.allFinite();
    };
    expect(archive, std::all_of(self.places_.begin(), self.places_.end(), finite), "an envelope is not finite");
  }

  const GeneralBodies* bodies_;
  double thickness_;
  double exit_thickness_;
  std::vector<EnvelopePose> places_;
};

/// The thickest box envelope for which nearest images are safe in this periodic box.
double thickest_oriented_envelope(const GeneralBodies& bodies, double box);

class GeneralOrientedEnvelopes final : public Envelopes<GeneralBodies> {
 public:
  GeneralOrientedEnvelopes(const GeneralBodies& bodies, double thickness);

  double thickness() const override { return thickness_; }
  double reach() const override { return reach_; }
  void place(int i, const GeneralBodies& bodies, double now) override;
  void scale(double factor) override;
  double exit_time(int i, const GeneralBodies& bodies, double now, double box) const override;
  double worthwhile(int i, const GeneralBodies& bodies) const override;
  bool may_overlap(int i, int k, const Eigen::Vector3d& r, Eigen::Vector3d& normal) const override;
  void save(Writer& writer) const override { fields(writer, *this); }
  void load(Reader& reader) override { fields(reader, *this); }

 private:
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number = self.boxes_.size();
    archive(self.thickness_, self.reach_, self.boxes_);
    expect(archive, self.boxes_.size() == number, "the envelopes of the bodies");
  }

  double thickness_;
  double reach_;
  std::vector<geom::OrientedBox> boxes_;
};

}  // namespace ed::internal
