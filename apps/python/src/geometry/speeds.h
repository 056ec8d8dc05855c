#pragma once

#include "base/arguments.h"

#include <ed/tolerances.h>

#include <Eigen/Core>

#include <string>

namespace hardbody::python {

/// Returns a velocity or an angular velocity. Throws ValueError unless its length is one that ed::Motion may have.
inline const Eigen::Vector3d& checked_speed(const Eigen::Vector3d& v, const std::string& name) {
  const double speed = v.stableNorm();
  if (speed == 0 || (speed >= ed::kMinSpeed && speed <= ed::kMaxSpeed)) return v;
  refuse_value(name, shown(v), "0, or a length from 1e-50 to 1e+50");
}

}  // namespace hardbody::python
