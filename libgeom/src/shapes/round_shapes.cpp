#include "shapes/format.h"
#include "shapes/lengths.h"

#include <geom/kernel/refuse.h>
#include <geom/round_shapes.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

namespace geom {

using Eigen::Vector3d;

namespace {

/// Throws std::invalid_argument unless a ratio is at most kMaxAspectRatio.
void check_ratio(const std::string& what, double ratio) {
  if (ratio <= kMaxAspectRatio) return;
  kernel::refuse(what + " is " + kernel::shown(ratio) + "; accepted: at most " + kernel::shown(kMaxAspectRatio));
}

}  // namespace

bool kernel::frustum_contains(const CoreView& core, const Vector3d& x) {
  const auto& [low, high] = core.disc;
  if (!(x.z() >= low.z && x.z() <= high.z)) return false;
  const double across = std::hypot(x.x(), x.y());
  const double height = high.z - low.z;
  return (across - low.radius) * height <= (high.radius - low.radius) * (x.z() - low.z);
}

Cylinder::Cylinder(double half_length, double radius)
    : half_length_(half_length), radius_(radius), bounding_radius_(std::hypot(half_length, radius)) {
  kernel::check_length("Cylinder: half-length", half_length, kMinSemiAxis);
  kernel::check_length("Cylinder: radius", radius, kMinSemiAxis);
  check_ratio("Cylinder: ratio of half-length to radius", half_length / radius);
  check_ratio("Cylinder: ratio of radius to half-length", radius / half_length);
}

double Cylinder::volume() const {
  return 2 * std::numbers::pi * radius_ * radius_ * half_length_;
}

Vector3d Cylinder::inertia(double mass) const {
  const double across = mass * (radius_ * radius_ / 4 + half_length_ * half_length_ / 3);
  return {across, across, mass * radius_ * radius_ / 2};
}

std::string Cylinder::description() const {
  std::ostringstream text;
  text << "cylinder of half-length " << half_length_ << " and radius " << radius_;
  return text.str();
}

Cone::Cone(double height, double radius, double base)
    : height_(height),
      radius_(radius),
      base_(base),
      bounding_radius_(std::max(base + height, std::hypot(radius, base))),
      inscribed_radius_(std::min(-base, radius * ((base + height) / std::hypot(height, radius)))) {
  kernel::check_length("Cone: height", height, kMinSemiAxis);
  kernel::check_length("Cone: radius", radius, kMinSemiAxis);
  if (!(base < 0 && base > -height)) {
    kernel::refuse("Cone: base is " + kernel::shown(base) + "; accepted: more than " + kernel::shown(-height) +
                   ", less than 0, so that the origin is inside");
  }
  check_ratio("Cone: ratio of bounding to inscribed radius", bounding_radius_ / inscribed_radius_);
}

Cone Cone::in_principal_frame(double height, double radius, double rounding) {
  const Cone sharp(height, radius);
  kernel::CoreView core = sharp.core();
  core.radius = kernel::checked_rounding(rounding);
  return {height, radius, sharp.base() - kernel::swept_mass(core).centre().z()};
}

double Cone::volume() const {
  return std::numbers::pi / 3 * radius_ * radius_ * height_;
}

bool Cone::is_in_principal_frame() const {
  constexpr double kOff = 1e-9;
  return centre_of_mass().norm() <= kOff * bounding_radius_;
}

Vector3d Cone::inertia(double mass) const {
  const double off = base_ + 0.25 * height_;
  const double across = mass * (0.15 * radius_ * radius_ + 0.0375 * height_ * height_ + off * off);
  return {across, across, 0.3 * mass * radius_ * radius_};
}

std::string Cone::description() const {
  std::ostringstream text;
  text << "cone of height " << height_ << " and radius " << radius_;
  return text.str();
}

}  // namespace geom
