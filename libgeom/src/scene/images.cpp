#include "scene/images.h"

#include <geom/kernel/refuse.h>
#include <geom/tolerances.h>

#include <Eigen/Dense>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <iomanip>
#include <sstream>
#include <string>

namespace geom::scene {

using Eigen::Matrix3d;
using Eigen::Vector3d;

namespace {

constexpr double kLeastLength =
    1 / kMaxCoordinate;  ///< least length of a lattice vector: its square does not underflow

/// Returns a unit vector across all columns but those that are 0, of which there is at least one.
Vector3d across(const Matrix3d& columns) {
  std::array<Vector3d, 2> known;
  std::size_t count = 0;
  for (int k = 0; k < 3; ++k) {
    if (!columns.col(k).isZero(0)) known[count++] = columns.col(k);
  }
  if (count == 0) return Vector3d::UnitX();
  return count == 1 ? known[0].unitOrthogonal() : known[0].cross(known[1]).normalized();
}

}  // namespace

Images::Images(const Lattice& lattice) {
  for (int k = 0; k < 3; ++k) {
    const Vector3d& v = lattice.vectors[static_cast<std::size_t>(k)];
    if (!v.allFinite()) kernel::refuse("Lattice: vector " + std::to_string(k) + " is not finite");
    vectors_.col(k) = v;
    if (v.isZero(0)) continue;
    const double length = v.stableNorm();
    if (!(length >= kLeastLength && length <= kMaxCoordinate)) {
      std::ostringstream message;
      message << "Lattice: vector " << k << " has length " << std::setprecision(17) << length << std::setprecision(6)
              << "; accepted: 0, or " << kLeastLength << " to " << kMaxCoordinate;
      kernel::refuse(message.str());
    }
    ++directions_;
    shortest_ = std::min(shortest_, v.norm());
    longest_ = std::max(longest_, v.norm());
  }
  // Directions without a lattice vector get one across the others, so that the inverse exists; it is not used.
  Matrix3d all = vectors_;
  for (int k = 0; k < 3; ++k) all.col(k).normalize();
  for (int k = 0; k < 3; ++k) {
    if (all.col(k).isZero(0)) all.col(k) = open_[open_count_++] = across(all);
  }
  constexpr double kPlane = 1e-6;  // smallest volume spanned by the unit vectors along the lattice
  if (!(std::abs(all.determinant()) >= kPlane)) {
    kernel::refuse(
        "Lattice: vectors are nearly in one plane, or two of them nearly parallel; accepted: vectors whose "
        "directions span a volume of at least 1e-6");
  }
  inverse_ = all.inverse();
  for (int k = 0; k < 3; ++k) {
    const double length = vectors_.col(k).norm();
    inverse_.row(k) *= length > 0 ? 1 / length : 0;
  }
}

double Images::open_gap(const Box3& a, const Box3& b) const {
  const Vector3d way = b.centre() - a.centre();
  const Vector3d half = 0.5 * ((a.high - a.low) + (b.high - b.low));
  const double rounding = kOpenRounding * (way.norm() + half.norm());
  double square = 0;
  for (const Vector3d& direction : open()) {
    const double gap = std::abs(direction.dot(way)) - direction.cwiseAbs().dot(half) - rounding;
    if (gap > 0) square += gap * gap;
  }
  return std::sqrt(square);
}

Images::Range Images::range(const Box3& moved, const Box3& other, double reach) const {
  // Lattice vectors in [low, high] bring the box within reach.
  Range near;
  near.low = (other.low - moved.high).array() - reach;
  near.high = (other.high - moved.low).array() + reach;
  const Vector3d middle = inverse_ * (0.5 * (near.low + near.high));
  // Of the reach, what is left across the open directions leads along the lattice.
  const double gap = open_gap(moved, other);
  if (gap > reach) {
    near.count = 0;
    near.first.setOnes();
    near.last.setZero();
    return near;
  }
  const double along = std::sqrt(reach - gap) * std::sqrt(reach + gap);
  const Vector3d widths = (moved.high - moved.low) + (other.high - other.low);
  const Vector3d spread = inverse_.cwiseAbs() * (0.5 * widths) + along * inverse_.rowwise().norm();
  constexpr double kRounding = 1e-9;
  for (int k = 0; k < 3; ++k) {
    near.first[k] = std::ceil(middle[k] - spread[k] - kRounding) + 0.0;  // without -0
    near.last[k] = std::floor(middle[k] + spread[k] + kRounding);
    near.count *= std::max(0.0, near.last[k] - near.first[k] + 1);
  }
  return near;
}

void Images::check_count(double count) {
  constexpr double kMost = 1e8;
  if (count <= kMost) return;
  kernel::refuse("Scene: the query reaches over more than 1e8 lattice vectors; accepted: shorter distances");
}

Vector3d Images::cell(const Vector3d& point, const char* what) const {
  constexpr double kFurthest = 1e9;
  Vector3d cell = Vector3d::Zero();
  if (!periodic()) return cell;
  const Vector3d coordinates = inverse_ * point;
  for (int k = 0; k < 3; ++k) cell[k] = std::floor(coordinates[k] + 0.5);
  if (!(cell.cwiseAbs().maxCoeff() <= kFurthest)) {
    kernel::refuse(std::string(what) +
                   ": the position is more than 1e9 lattice vectors away from the origin; accepted: nearer ones");
  }
  return cell;
}

}  // namespace geom::scene
