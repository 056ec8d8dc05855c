#pragma once

#include <ed/export.h>

#include <geom/newton.h>

#include <functional>

namespace ed {

/// How the time of a contact is searched for.
enum class Finder {
  certified,   ///< certified bounds: never steps over a contact
  bracketing,  ///< the paper's: steps of at most d / (an overestimate of |dd/dt|), at least eps_d / that
};

/// How "bracketing" finds distances.
enum class DistanceMethod {
  dual,     ///< geom::distance
  newton8,  ///< geom::newton_distance on the paper's 8 equations
  newton5,  ///< the same on 5
};

/// How "bracketing" ends, once a contact is between two times.
enum class ContactRoot {
  newton,           ///< Newton's method on the paper's eqs. (contime) for contact point, alpha and time
  one_dimensional,  ///< a safeguarded root finder on d(t) = 0 (the paper's footnote)
};

/// A guess of the closest points of two bodies to start Newton's method from.
using SeedFunction = std::function<geom::WitnessPair(const geom::Ellipsoid& a, const geom::Pose& X_WA,
                                                     const geom::Ellipsoid& b, const geom::Pose& X_WB)>;

/// Everything but `finder` is for "bracketing" alone.
struct ContactOptions {
  Finder finder = Finder::certified;
  double eps_d =
      1e-6;  ///< length; 0 < eps_d < the smallest semi-axis. Contacts shallower than about this can be missed
  DistanceMethod distance = DistanceMethod::dual;
  ContactRoot root = ContactRoot::newton;
  /// For the first distance of a search with newton8 or newton5; where it declines, and if there is none: the support
  /// points along the last known normal. Later ones go on from the distance before.
  SeedFunction seed;
};

}  // namespace ed
