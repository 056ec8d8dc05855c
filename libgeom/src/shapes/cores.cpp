#include "shapes/format.h"
#include "shapes/length_of.h"
#include "shapes/lengths.h"

#include <geom/kernel/core.h>
#include <geom/kernel/refuse.h>
#include <geom/polyhedron.h>
#include <geom/round_shapes.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <sstream>
#include <string>

namespace geom {

using Eigen::Matrix3d;
using Eigen::Vector3d;

int kernel::support_vertex(const Hull& hull, const Vector3d& n) {
  const Eigen::Index count = hull.vertices.rows();
  const double* x = hull.vertices.data();
  const double* y = x + count;
  const double* z = y + count;
  int best = 0;
  double highest = n.x() * x[0] + n.y() * y[0] + n.z() * z[0];
  for (Eigen::Index k = 1; k < count; ++k) {
    const double height = n.x() * x[k] + n.y() * y[k] + n.z() * z[k];
    if (height > highest) {
      highest = height;
      best = static_cast<int>(k);
    }
  }
  return best;
}

namespace {

/// Returns whether a direction is along z, as far as doubles tell: `across`, its part across z, is nothing beside it.
/// The ratio of a length to it might overflow.
bool is_along_z(const Vector3d& n, double across) {
  constexpr double kNothing = 1e-100;
  return !(across > kNothing * std::abs(n.z()));
}

/// Returns the disc of a frustum that reaches furthest along n, `across` the part of n across the axis.
const kernel::CoreDisc& furthest_disc(const kernel::CoreView& core, const Vector3d& n, double across) {
  const auto& [low, high] = core.disc;
  const double rise = (high.z - low.z) * n.z() + (high.radius - low.radius) * across;
  return std::signbit(rise) ? low : high;
}

}  // namespace

Matrix3d kernel::rim_hessian(const CoreView& core, const Vector3d& n) {
  const double across = length_of(n.x(), n.y());
  if (is_along_z(n, across)) return Matrix3d::Zero();
  const Vector3d along(-n.y() / across, n.x() / across, 0);
  return furthest_disc(core, n, across).radius / across * along * along.transpose();
}

Support kernel::core_support(const CoreView& core, const Vector3d& n) {
  switch (core.kind) {
    case CoreKind::point:
      break;
    case CoreKind::segment:
      return {core.half.z() * std::abs(n.z()), {0, 0, std::copysign(core.half.z(), n.z())}};
    case CoreKind::box: {
      Vector3d corner;
      for (int k = 0; k < 3; ++k) corner[k] = std::copysign(core.half[k], n[k]);
      return {n.dot(corner), corner};
    }
    case CoreKind::hull: {
      const Vector3d vertex = core.hull->vertices.row(support_vertex(*core.hull, n)).transpose();
      return {n.dot(vertex), vertex};
    }
    case CoreKind::frustum: {
      const double across = length_of(n.x(), n.y());
      const CoreDisc& disc = furthest_disc(core, n, across);
      const double share = is_along_z(n, across) ? 0 : disc.radius / across;  // along the axis: the middle of the face
      return {disc.z * n.z() + disc.radius * across, {share * n.x(), share * n.y(), disc.z}};
    }
  }
  return {0, Vector3d::Zero()};
}

Sphere::Sphere(double radius) : radius_(radius) {
  kernel::check_length("Sphere: radius", radius, kMinSemiAxis);
}

double Sphere::volume() const {
  return 4.0 / 3.0 * std::numbers::pi * radius_ * radius_ * radius_;
}

Vector3d Sphere::inertia(double mass) const {
  return Vector3d::Constant(0.4 * mass * radius_ * radius_);
}

std::string Sphere::description() const {
  std::ostringstream text;
  text << "sphere of radius " << radius_;
  return text.str();
}

Capsule::Capsule(double half_length, double radius) : half_length_(half_length), radius_(radius) {
  kernel::check_length("Capsule: radius", radius, kMinSemiAxis);
  kernel::check_length("Capsule: half-length", half_length, 0);
  kernel::check_length("Capsule: half-length + radius", half_length + radius, kMinSemiAxis);
  if (!(half_length + radius <= kMaxAspectRatio * radius)) {
    kernel::refuse("Capsule: ratio of half-length + radius to the radius is " +
                   kernel::shown((half_length + radius) / radius) + "; accepted: at most " +
                   kernel::shown(kMaxAspectRatio));
  }
}

Vector3d Capsule::from_segment(const Vector3d& x) const {
  return {x.x(), x.y(), x.z() - std::clamp(x.z(), -half_length_, half_length_)};
}

Vector3d Capsule::gradient(const Vector3d& x) const {
  return 2 / radius_ * (from_segment(x) / radius_);
}

Matrix3d Capsule::hessian(const Vector3d& x) const {
  const double beside = std::abs(x.z()) <= half_length_ ? 0 : 1;
  return (2 / radius_ / radius_ * Vector3d(1, 1, beside)).asDiagonal();
}

double Capsule::volume() const {
  return std::numbers::pi * radius_ * radius_ * (2 * half_length_ + 4.0 / 3.0 * radius_);
}

Vector3d Capsule::inertia(double mass) const {
  const double l = half_length_;
  const double r = radius_;
  const double caps = mass * (2 * r) / (3 * l + 2 * r);  // both together: a ball
  const double tube = mass * (3 * l) / (3 * l + 2 * r);
  const double across = tube * (l * l / 3 + r * r / 4) + caps * (0.4 * r * r + l * l + 0.75 * l * r);
  return {across, across, (0.5 * tube + 0.4 * caps) * r * r};
}

std::string Capsule::description() const {
  std::ostringstream text;
  text << "capsule of half-length " << half_length_ << " and radius " << radius_;
  return text.str();
}

Box::Box(const Vector3d& half_extents) : half_extents_(half_extents), bounding_radius_(half_extents.stableNorm()) {
  for (int k = 0; k < 3; ++k) {
    const std::string what = std::string("Box: half extent ") + "xyz"[k];
    kernel::check_length(what.c_str(), half_extents[k], kMinSemiAxis);
  }
  const double ratio = half_extents.maxCoeff() / half_extents.minCoeff();
  if (!(ratio <= kMaxAspectRatio)) {
    kernel::refuse("Box: ratio of the largest to the smallest half extent is " + kernel::shown(ratio) +
                   "; accepted: at most " + kernel::shown(kMaxAspectRatio));
  }
}

Vector3d Box::inertia(double mass) const {
  const Vector3d a2 = half_extents_.cwiseAbs2();
  return mass / 3 * (Vector3d::Constant(a2.sum()) - a2);
}

std::string Box::description() const {
  std::ostringstream text;
  text << "box of half extents " << half_extents_.x() << " x " << half_extents_.y() << " x " << half_extents_.z();
  return text.str();
}

double kernel::checked_rounding(double radius) {
  kernel::check_length("Rounded: radius", radius, 0);
  return radius;
}

}  // namespace geom
