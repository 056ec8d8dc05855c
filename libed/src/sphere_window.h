#pragma once

#include "select.h"

#include <Eigen/Core>

#include <cmath>

namespace ed::internal {

/// An interval of time; empty if begin >= end.
struct Window {
  double begin;
  double end;
};

/// When the bounding spheres of two bodies (distance r, relative velocity v at `now`, radii adding up to `reach`)
/// overlap within [t_begin, t_end].
inline Window sphere_window(const Eigen::Vector3d& r, const Eigen::Vector3d& v, double reach, double now,
                            double t_begin, double t_end) {
  const double excess = r.squaredNorm() - reach * reach;
  const double approach = r.dot(v);
  const double v2 = v.squaredNorm();
  const double discriminant = approach * approach - v2 * excess;
  Window window{t_begin, t_end};
  if (excess > 0) {
    if (approach >= 0 || discriminant < 0) return {t_end, t_end};
    window.begin = larger(t_begin, now + excess / (std::sqrt(discriminant) - approach));
  }
  // The spheres part again only if they no longer overlap at the end.
  const double span = t_end - now;
  if (!(excess + span * (2 * approach + span * v2) <= 0) && v2 > 0 && discriminant > 0) {
    window.end = smaller(t_end, now + (std::sqrt(discriminant) - approach) / v2);
  }
  return window;
}

}  // namespace ed::internal
