#pragma once

#include <Eigen/Core>

#include <array>
#include <charconv>
#include <sstream>
#include <string>

namespace geom::kernel {

/// Formats a number for a message, with enough digits to distinguish it from every other one, so that a refused value
/// does not look like an accepted one.
inline std::string shown(double x) {
  std::array<char, 32> text{};
  const std::to_chars_result end = std::to_chars(text.data(), text.data() + text.size(), x);
  return {text.data(), end.ptr};
}

/// Returns "of semi-axes 1 x 1 x 3", with six digits a number.
inline std::string of_semi_axes(const Eigen::Vector3d& a) {
  std::ostringstream text;
  text << "of semi-axes " << a.x() << " x " << a.y() << " x " << a.z();
  return text.str();
}

}  // namespace geom::kernel
