#pragma once

#include <ed/given/contact.h>
#include <ed/given/motion.h>

#include <geom/distance.h>
#include <geom/pose.h>

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

/// Function and bodies that messages name; -1: the bodies are A and B.
struct GivenNames {
  const char* function = "time_of_contact";
  std::int64_t a = -1, b = -1;
};

/// Throws std::invalid_argument if options or times are out of range.
void check_given(const char* function, const GivenContactOptions& options, double t_min, double t_max);

/// Throws std::invalid_argument: speeds have no bound between these times.
[[noreturn]] void refuse_infinite_speeds(const GivenNames& names, double from, double to);

/// Searches the first contact; arguments are checked.
ContactResult given_contact(const GivenPair& pair, const GivenMotion& motion_a, const GivenMotion& motion_b,
                            const GivenNames& names, double t_min, double t_max, const GivenContactOptions& options);

}  // namespace ed::internal
