#pragma once

#include <ed/export.h>

#include <geom/any_shape.h>
#include <geom/newton.h>

#include <Eigen/Core>

#include <functional>

namespace ed {

/// How the time of a contact is searched for.
enum class Finder {
  certified,   ///< certified bounds: never steps over a contact
  bracketing,  ///< the paper's: steps of at most d / (an overestimate of |dd/dt|), at least eps_d / that
};

/// The enumerator's name.
ED_EXPORT const char* to_string(Finder finder);

/// How "bracketing" finds distances.
enum class DistanceMethod {
  dual,     ///< geom::distance
  newton8,  ///< geom::newton_distance on the paper's 8 equations
  newton5,  ///< the same on 5
};

/// The enumerator's name.
ED_EXPORT const char* to_string(DistanceMethod method);

/// How "bracketing" ends, once a contact is between two times.
enum class ContactRoot {
  newton,           ///< Newton's method on the paper's eqs. (contime) for contact point, alpha and time
  one_dimensional,  ///< a safeguarded root finder on d(t) = 0 (the paper's footnote)
};

/// The enumerator's name.
ED_EXPORT const char* to_string(ContactRoot root);

/// A guess of the closest points of two bodies to start Newton's method from.
///
/// It is called in the event loop with bodies in any relation, overlapping ones too; the frame has the world's axes and
/// its origin at A's centre; in systems of ellipsoids of revolution alone their axes are along body z. It may decline
/// and it may be wrong: its points are not checked, and the worst that bad ones do is a distance that Newton's method
/// declines and the dual answers (`rescues`). It must not throw, and must give the same points for the same bodies, or
/// a run is not reproducible. Whether it allocates is its own affair.
using SeedFunction = std::function<geom::WitnessPair(const geom::Shape& a, const geom::Pose& X_WA, const geom::Shape& b,
                                                     const geom::Pose& X_WB)>;

/// A call of geom::newton_distance that gave no answer, to be repeated bit for bit. Axes of revolution as for
/// SeedFunction.
struct FailedDistance {
  DistanceMethod method = DistanceMethod::newton8;
  geom::DistanceStatus status = geom::DistanceStatus::not_converged;
  geom::Shape shape_a = geom::Ellipsoid(Eigen::Vector3d::Ones());
  geom::Shape shape_b = geom::Ellipsoid(Eigen::Vector3d::Ones());
  geom::Pose X_WA;
  geom::Pose X_WB;
  geom::WitnessPair seed;
};

/// Settings of a contact search: everything after `max_evaluations` is for "bracketing" alone.
struct ContactOptions {
  Finder finder = Finder::certified;
  /// Budget of time_of_contact with "certified", >= 1: about the number of points in time to look at, at 0.3 to 2
  /// microseconds for ellipsoids of revolution and up to 50 for other bodies. Most searches need 3 to 20, some turning
  /// bodies hundreds. A simulation has budgets of its own.
  int max_evaluations = 2000;
  double eps_d =
      1e-6;  ///< length; 0 < eps_d < the smallest semi-axis. Contacts shallower than about this can be missed
  DistanceMethod distance = DistanceMethod::dual;
  ContactRoot root = ContactRoot::newton;
  /// For the first distance of a search with newton8 or newton5; where it declines, and if there is none: the dual's
  /// points. Later ones start from the support points along the normal before.
  SeedFunction seed;
};

}  // namespace ed
