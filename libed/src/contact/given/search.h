#pragma once

#include <ed/given/contact.h>
#include <ed/given/motion.h>

#include <geom/distance.h>
#include <geom/pose.h>
#include <geom/shape.h>

#include <Eigen/Core>

#include <cstdint>
#include <functional>

namespace ed::internal {

/// Two shapes as a search on given motions sees them.
struct GivenPair {
  std::function<geom::DistanceResult(const geom::Pose& X_WA, const geom::Pose& X_WB,
                                     const geom::DistanceOptions& options)>
      distance;
  std::function<double(const Eigen::Vector3d&n)> height_a, height_b;  ///< support heights, body frame
  double radius_a, radius_b;                                          ///< bounding radii
};

/// Returns the pair of two shapes, which it refers to.
template <class S>
GivenPair pair_of(const S& a, const S& b) {
  const auto height = [](const S& shape, const Eigen::Vector3d& n) {
    if constexpr (geom::SupportShape<S>) {
      return geom::Support(shape.support(n)).height;
    } else {
      return support(shape, n).height;
    }
  };
  const auto radius = [](const S& shape) {
    if constexpr (geom::SupportShape<S>) {
      return shape.bounding_radius();
    } else {
      return bounding_radius(shape);
    }
  };
  return {[&](const geom::Pose& X_WA, const geom::Pose& X_WB, const geom::DistanceOptions& options) {
            return distance(a, X_WA, b, X_WB, options);
          },
          [&, height](const Eigen::Vector3d& n) { return height(a, n); },
          [&, height](const Eigen::Vector3d& n) { return height(b, n); }, radius(a), radius(b)};
}

/// Function and bodies that messages name; -1: the bodies are A and B.
struct GivenNames {
  const char* function = "time_of_contact";
  std::int64_t a = -1, b = -1;
};

/// Throws std::invalid_argument if options or times are out of range.
void check_given(const char* function, const GivenContactOptions& options, double t_min, double t_max);

/// Throws std::invalid_argument: speeds have no bound between these times.
[[noreturn]] void refuse_infinite_speeds(const GivenNames& names, double from, double to);

/// Pose of a body at a time.
struct PoseAt {
  double time;
  const geom::Pose& X;
};

/// Throws std::invalid_argument if a body has moved further between two times than its bounds over the interval allow.
/// `body`: its number in a scene, or -1 for the one called `letter`; `size`: length whose rounding counts.
void check_way(const char* function, std::int64_t body, const char* letter, const MotionBounds& bounds,
               const GivenMotion& motion, const PoseAt& from, const PoseAt& to, double size);

/// Searches the first contact; arguments are checked.
ContactResult given_contact(const GivenPair& pair, const GivenMotion& motion_a, const GivenMotion& motion_b,
                            const GivenNames& names, double t_min, double t_max, const GivenContactOptions& options);

}  // namespace ed::internal
