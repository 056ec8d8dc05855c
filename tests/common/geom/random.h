#pragma once

#include <common/full_form.h>

/// Seeded random directions, rotations and shapes for the tests of libgeom.

#include <geom/geom.h>

#include <Eigen/Core>

#include <cmath>
#include <cstdint>
#include <random>

namespace geom_test {

using ::repetitions;

/// Draws from std::mt19937_64 without the distributions of <random>, whose results differ between standard libraries.
class Random {
 public:
  explicit Random(std::uint64_t seed) : engine_(seed) {}

  /// Returns a uniform number in [0, 1), 53 random bits.
  double uniform() { return 0x1p-53 * static_cast<double>(engine_() >> 11); }
  double uniform(double low, double high) { return low + (high - low) * uniform(); }
  double log_uniform(double low, double high) { return low * std::exp(uniform() * std::log(high / low)); }
  bool coin() { return uniform() < 0.5; }

  /// Returns a direction, uniform on the unit sphere.
  Eigen::Vector3d direction() {
    while (true) {
      const Eigen::Vector3d v(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      const double length2 = v.squaredNorm();
      // A short vector has few random bits; outside the ball the directions would not be uniform.
      if (length2 > 1e-4 && length2 <= 1) return v / std::sqrt(length2);
    }
  }

  /// Returns a pose, uniform over the rotations, at `position`.
  geom::Pose pose(const Eigen::Vector3d& position) {
    while (true) {
      const Eigen::Vector4d q(uniform(-1, 1), uniform(-1, 1), uniform(-1, 1), uniform(-1, 1));
      const double length2 = q.squaredNorm();
      if (length2 <= 1e-4 || length2 > 1) continue;
      const Eigen::Vector4d unit = q / std::sqrt(length2);
      return geom::Pose::from_quaternion(unit[0], unit[1], unit[2], unit[3], position);
    }
  }

  /// Returns a pose, uniform over the rotations, the position within a cube of side 2 * extent about the origin.
  geom::Pose pose(double extent) {
    return pose(Eigen::Vector3d(extent * signed_unit(), extent * signed_unit(), extent * signed_unit()));
  }

  /// Returns a spheroid with semi-axis 1 across its axis and `aspect_ratio` along it, its axis along x, y or z of the
  /// body.
  geom::Ellipsoid spheroid(double aspect_ratio) {
    Eigen::Vector3d semi_axes = Eigen::Vector3d::Ones();
    semi_axes[static_cast<int>(3 * uniform())] = aspect_ratio;
    return geom::Ellipsoid(semi_axes);
  }

  /// Returns an ellipsoid with three semi-axes, each drawn log-uniformly from [1, ratio].
  geom::Ellipsoid biaxial(double ratio) {
    return geom::Ellipsoid({log_uniform(1, ratio), log_uniform(1, ratio), log_uniform(1, ratio)});
  }

 private:
  double signed_unit() { return uniform(-1, 1); }

  std::mt19937_64 engine_;
};

}  // namespace geom_test
