#pragma once

/// The paper's contact search (section "Prediction of the time-of-collision"), for ellipsoids and superellipsoids.
///
/// It is kept because it is what the field knows, and because it shares nothing with certified_contact but the
/// distance: two independent ways to every contact. Unlike that, it can step over a contact that is shallower than
/// eps_d.

#include "contact/certified.h"
#include "motion/axis_motion.h"
#include "motion/rigid_motion.h"

#include <ed/contact_options.h>

#include <geom/ellipsoid.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <optional>

namespace ed::internal {

/// Two bodies in free flight.
template <class Shape, class Flight>
struct PairInFlight {
  const Shape& shape_a;
  const Shape& shape_b;
  const Flight& a;
  const Flight& b;
  Eigen::Vector3d r_now;  ///< vector from A's centre to B's at `now`, in the image that is meant
  double now;
};
/// Pair of ellipsoids of revolution; shapes have their axis of revolution along body z.
using UniaxialPair = PairInFlight<geom::Ellipsoid, AxisMotion>;
using GeneralPair = PairInFlight<geom::Shape, RigidMotion>;

/// A distance that Newton's method has declined, and its time.
struct Unsolved {
  double time;
  FailedDistance call;
};

/// Finds a contact in [t_begin, t_end] by the paper's steps 1 to 9. Outcome::clear means that none was found, which is
/// no proof. Where Newton's method for a distance fails the dual answers instead: `count.rescues` is raised and
/// `unsolved` set to the last such failure. `n` as in certified_contact.
Finding bracketing_contact(const UniaxialPair& pair, double t_begin, double t_end, const ContactOptions& options,
                           Eigen::Vector3d& n, FinderCounters& count, std::optional<Unsolved>& unsolved);
Finding bracketing_contact(const GeneralPair& pair, double t_begin, double t_end, const ContactOptions& options,
                           Eigen::Vector3d& n, FinderCounters& count, std::optional<Unsolved>& unsolved);

}  // namespace ed::internal
