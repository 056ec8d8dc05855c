#pragma once

/// Conversion of the bytes of a fuzz input to numbers, shapes and poses.

#include <geom/geom.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <bit>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <stdexcept>
#include <type_traits>
#include <variant>

namespace fuzz {

/// Reads bytes from the front; zeros after the end.
///
/// Most bit patterns are numbers that constructors refuse. Therefore a tag decides which numbers are drawn: any bits,
/// or one of several ranges that matter.
class Input {
 public:
  Input(const std::uint8_t* data, std::size_t size) : data_(data), size_(size) {
    for (std::size_t k = 0; k < size; ++k) hash_ = (hash_ ^ data[k]) * 0x100000001b3;  // FNV-1a
  }

  /// Returns whether this input belongs to a fraction 1/n of all inputs, a different one for each n. No mutation can
  /// learn to be in it. It limits slow cases, which would otherwise displace all others because they cover more code.
  bool is_one_in(std::uint64_t n) const { return (hash_ * (2 * n + 1)) >> 32U < (std::uint64_t{1} << 32U) / n; }

  std::uint8_t byte() {
    if (size_ == 0) return 0;
    --size_;
    return *data_++;
  }

  /// Returns any double.
  double bits() { return read<double>(); }

  /// Returns a number in [0, 1).
  double fraction() { return read<std::uint16_t>() / 65536.0; }

  /// Returns a coordinate: mostly within a few units, and often a round number.
  double coordinate() {
    switch (byte() % 8) {
      case 0:
        return bits();
      case 1:
        return 0;
      case 2:
        return std::ldexp(2 * fraction() - 1, read<std::int8_t>());
      case 3:
        return static_cast<std::int8_t>(byte()) / 8.0;
      case 4:
        return std::nextafter(static_cast<std::int8_t>(byte()) / 4.0, std::numeric_limits<double>::infinity());
      default:
        return 8 * (fraction() - 0.5);
    }
  }

  /// Returns a length: mostly 0.01 to 100.
  double length() {
    switch (byte() % 8) {
      case 0:
        return bits();
      case 1:
        return 1;
      case 2:
        return std::ldexp(1 + fraction(), read<std::int8_t>());
      case 3:
        return (1 + byte() % 32) / 4.0;
      default:
        return std::pow(10.0, 4 * fraction() - 2);
    }
  }

  double exponent() {
    constexpr std::array kOften{0.2, 0.25, 0.3, 0.5, 2.0 / 3, 1.0, 1.3, 1.5, 1.6};
    switch (byte() % 4) {
      case 0:
        return bits();
      case 1:
        return kOften[byte() % kOften.size()];
      default:
        return 0.2 + 1.4 * fraction();
    }
  }

  Eigen::Vector3d vector() {
    return in_order([this] { return coordinate(); });
  }

  /// Returns a shape. Throws std::invalid_argument as the constructors do.
  geom::Shape shape() {
    const bool barr = byte() % 2 == 1;
    const Eigen::Vector3d axes =
        byte() % 4 == 0 ? Eigen::Vector3d(Eigen::Vector3d::Constant(length())) : in_order([this] { return length(); });
    if (!barr) return geom::Ellipsoid(axes);
    const double e1 = exponent();
    return geom::Superellipsoid(axes, e1, exponent());
  }

  geom::Pose pose(const Eigen::Vector3d& position) {
    std::array<double, 4> q{1, 0, 0, 0};
    const int kind = byte() % 8;
    if (kind == 7) return {matrix(), position};
    if (kind == 1) {  // rotation of the cube
      q = {0.5, byte() % 2 == 0 ? 0.5 : -0.5, 0.5, 0.5};
    } else if (kind > 1) {
      for (double& x : q) x = kind % 2 == 0 ? fraction() - 0.5 : coordinate();
      const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
      if (byte() % 16 != 0) {
        for (double& x : q) x /= norm;
      }
    }
    return geom::Pose::from_quaternion(q[0], q[1], q[2], q[3], position);
  }

 private:
  /// Returns a matrix that is mostly orthonormal within about the tolerance, 1e-6.
  Eigen::Matrix3d matrix() {
    Eigen::Matrix3d R;
    for (int k = 0; k < 3; ++k) R.col(k) = vector();
    if (byte() % 4 == 0) return R;
    R = Eigen::Quaterniond{0.1 + fraction(), fraction(), fraction(), fraction()}.normalized().toRotationMatrix();
    const int exponent = byte() % 4 == 0 ? -20 : -40;
    for (int k = 0; k < 9; ++k) R(k / 3, k % 3) += std::ldexp(fraction() - 0.5, exponent);
    return R;
  }

  template <class T>
  T read() {
    static_assert(std::is_trivially_copyable_v<T>);
    const std::size_t there = std::min(size_, sizeof(T));
    std::array<std::uint8_t, sizeof(T)> bytes{};
    std::copy_n(data_, there, bytes.begin());
    data_ += there;
    size_ -= there;
    return std::bit_cast<T>(bytes);
  }

  template <class Draw>
  static Eigen::Vector3d in_order(const Draw& draw) {
    const double x = draw();
    const double y = draw();
    return {x, y, draw()};
  }

  const std::uint8_t* data_;
  std::size_t size_;
  std::uint64_t hash_ = 0xcbf29ce484222325;
};

inline double aspect_ratio(const geom::Shape& shape) {
  return geom::bounding_radius(shape) / geom::inscribed_radius(shape);
}

/// Returns whether the distance of two bodies takes microseconds: apart or overlapping slightly in the projection on
/// the line of centres, which costs nothing to test, and not so flat that faces and edges need the last resort. The
/// search over all normals for the others (and for bodies lost in the rounding of their distance) is a thousand times
/// slower than everything else; fuzzers limit it.
inline bool are_quick(const geom::Shape& a, const geom::Pose& X_WA, const geom::Shape& b, const geom::Pose& X_WB) {
  const Eigen::Vector3d r = X_WB.position() - X_WA.position();
  const double r_a = geom::inscribed_radius(a);
  const double r_b = geom::inscribed_radius(b);
  const bool round = std::holds_alternative<geom::Ellipsoid>(a) && std::holds_alternative<geom::Ellipsoid>(b);
  return r.norm() < 1e12 * std::min(r_a, r_b) && r.norm() > 0.5 * (r_a + r_b) &&
         geom::distance_lower_bound(a, X_WA, b, X_WB, r) > -0.1 * std::min(r_a, r_b) &&
         (round || aspect_ratio(a) * aspect_ratio(b) < 100);
}

}  // namespace fuzz
