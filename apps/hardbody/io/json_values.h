#pragma once

/// Numbers as the program writes them in JSON. Private to the sources that write JSON, because it includes the library.

#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <cmath>

namespace hardbody {

/// Returns null for a number that is not finite: JSON has no NaN.
inline nlohmann::ordered_json number_json(double x) {
  return std::isfinite(x) ? nlohmann::ordered_json(x) : nlohmann::ordered_json(nullptr);
}

inline nlohmann::ordered_json list_json(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

}  // namespace hardbody
