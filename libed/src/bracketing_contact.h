#pragma once

/// The paper's contact search (section "Prediction of the time-of-collision"), for bodies of revolution.
///
/// It is kept because it is what the field knows, and because it shares nothing with certified_contact but the
/// distance: two independent ways to every contact. Unlike that, it can step over a contact that is shallower than
/// eps_d.

#include "axis_motion.h"
#include "certified_contact.h"

#include <ed/contact_options.h>

#include <geom/ellipsoid.h>

#include <Eigen/Core>

#include <optional>

namespace ed::internal {

/// Two bodies of revolution in free flight; shapes have their axis of revolution along body z.
struct PairInFlight {
  const geom::Ellipsoid& shape_a;
  const geom::Ellipsoid& shape_b;
  const AxisMotion& a;
  const AxisMotion& b;
  Eigen::Vector3d r_now;  ///< from A's centre to B's at `now`, in the image that is meant
  double now;
};

/// A distance that Newton's method has declined, and when.
struct Unsolved {
  double time;
  FailedDistance call;
};

/// Finds a contact in [t_begin, t_end] by the paper's steps 1 to 9. Outcome::clear says that none was found, which is
/// no proof. Where Newton's method for a distance fails the dual answers instead: `count.rescues` is raised and
/// `unsolved` set to the last such failure. `n` as in certified_contact.
Finding bracketing_contact(const PairInFlight& pair, double t_begin, double t_end, const ContactOptions& options,
                           Eigen::Vector3d& n, FinderCounters& count, std::optional<Unsolved>& unsolved);

}  // namespace ed::internal
