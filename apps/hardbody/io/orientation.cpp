#include "io/orientation.h"

#include <geom/tolerances.h>

#include <fmt/format.h>

#include <cmath>
#include <stdexcept>

namespace hardbody {

QuaternionLength::QuaternionLength(const Eigen::Vector4d& q)
    : length(q.norm()),
      off(std::abs(length - 1)),
      accepted(off <= kQuaternionTolerance),
      normalized(off > kQuaternionRounding) {}

StoredOrientation read_quaternion(const std::array<double, 4>& q, const Eigen::Vector3d& position) {
  const auto [w, x, y, z] = q;
  const QuaternionLength found(Eigen::Vector4d(q.data()));
  const double length = found.length;
  if (!found.accepted) {
    throw std::invalid_argument(
        fmt::format("quaternion (w, x, y, z) is not of length 1: its length is {:.6g}; accepted: 1 within {:g}", length,
                    kQuaternionTolerance));
  }
  // A pose takes the quaternion as it is where it can, for the same bits as geom gives.
  if (found.off <= geom::kPoseTolerance) return {geom::Pose::from_quaternion(w, x, y, z, position), length, false};
  return {geom::Pose::from_quaternion(w / length, x / length, y / length, z / length, position), length,
          found.normalized};
}

}  // namespace hardbody
