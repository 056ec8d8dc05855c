#pragma once

#include <ed/export.h>

#include <geom/newton.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <functional>

namespace ed {

/// Method of the search for the time of a contact.
enum class Finder {
  certified,   ///< certified bounds: never steps over a contact
  bracketing,  ///< the paper's method: steps of d / (an overestimate of |dd/dt|), at least eps_d / (that overestimate)
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(Finder finder);

/// Method by which "bracketing" computes distances.
enum class DistanceMethod {
  dual,     ///< geom::distance
  newton8,  ///< geom::newton_distance on the paper's 8 equations
  newton5,  ///< geom::newton_distance on the paper's 5 equations
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(DistanceMethod method);

/// Method by which "bracketing" finds the contact once it is between two times.
enum class ContactRoot {
  newton,           ///< Newton's method on the paper's eqs. (contime) for contact point, alpha and time
  one_dimensional,  ///< a safeguarded root finder on d(t) = 0 (the paper's footnote)
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(ContactRoot root);

/// Guess of the closest points of two bodies, from which Newton's method starts.
///
/// It is called in the event loop with bodies in any relation, overlapping ones too. The frame has the world's axes and
/// its origin at A's centre; in systems of ellipsoids of revolution alone, the axes of revolution are along body z. The
/// function may decline and it may be wrong: its points are not checked, and the worst effect of bad ones is a distance
/// that Newton's method declines and the dual method answers (`rescues`). It must not throw, and must give the same
/// points for the same bodies, or a run is not reproducible. It may allocate.
using SeedFunction = std::function<geom::WitnessPair(const geom::Shape& a, const geom::Pose& X_WA, const geom::Shape& b,
                                                     const geom::Pose& X_WB)>;

/// Call of geom::newton_distance that gave no answer, with all data to repeat it bit for bit. Axes of revolution as for
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

/// Settings of a contact search. Members after `max_evaluations` apply to "bracketing" alone.
struct ContactOptions {
  Finder finder = Finder::certified;
  /// Budget of time_of_contact with "certified", >= 1: about the number of evaluations of the pair at points in time,
  /// at 0.3 to 2 microseconds each for ellipsoids of revolution and up to 50 for other bodies. Most searches need 3 to
  /// 20, some rotating bodies hundreds. A simulation has budgets of its own.
  int max_evaluations = 2000;
  double eps_d =
      1e-6;  ///< length, 0 < eps_d < the smallest semi-axis; contacts shallower than about this can be missed
  DistanceMethod distance = DistanceMethod::dual;
  ContactRoot root = ContactRoot::newton;
  /// Seed of the first distance of a search with newton8 or newton5. If it is empty or declines, the dual method's
  /// points are used. Later distances start from the support points along the previous normal.
  SeedFunction seed;
};

}  // namespace ed
