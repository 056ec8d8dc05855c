#include "io/orientation.h"

#include <geom/tolerances.h>

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace hardbody {

StoredOrientation read_quaternion(const std::array<double, 4>& q, const Eigen::Vector3d& position) {
  const auto [w, x, y, z] = q;
  const double length = std::sqrt(w * w + x * x + y * y + z * z);
  const double error = std::abs(length - 1);
  if (!(error <= kQuaternionTolerance)) {
    throw std::invalid_argument(
        fmt::format("quaternion (w, x, y, z) is not of length 1: its length is {:.6g}; accepted: 1 within {:g}", length,
                    kQuaternionTolerance));
  }
  if (error <= geom::kPoseTolerance) return {geom::Pose::from_quaternion(w, x, y, z, position), length, false};
  return {geom::Pose::from_quaternion(w / length, x / length, y / length, z / length, position), length, true};
}

}  // namespace hardbody
