#include "contact/given/search.h"

#include <ed/given/contact.h>
#include <ed/shape.h>

#include <Eigen/Core>

namespace ed {
ContactResult time_of_contact(const BodyShape& a, const GivenMotion& motion_a, const BodyShape& b,
                              const GivenMotion& motion_b, double t_min, double t_max,
                              const GivenContactOptions& options) {
  internal::check_given("time_of_contact", options, t_min, t_max);
  const internal::GivenPair pair{
      [&](const geom::Pose& X_WA, const geom::Pose& X_WB, const geom::DistanceOptions& distance_options) {
        return distance(a, X_WA, b, X_WB, distance_options);
      },
      [&](const Eigen::Vector3d& n) { return support(a, n).height; },
      [&](const Eigen::Vector3d& n) { return support(b, n).height; }, bounding_radius(a), bounding_radius(b)};
  return internal::given_contact(pair, motion_a, motion_b, {}, t_min, t_max, options);
}

}  // namespace ed
