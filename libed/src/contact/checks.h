#pragma once

#include <ed/contact_options.h>

#include <sstream>
#include <stdexcept>
#include <string>

namespace ed::internal {

/// Throws std::invalid_argument unless the options are usable for bodies with this smallest semi-axis.
inline void check_contact_options(const ContactOptions& options, double smallest_semi_axis) {
  if (options.max_evaluations < 1) {
    throw std::invalid_argument("max_evaluations is " + std::to_string(options.max_evaluations) +
                                "; accepted: 1 or more");
  }
  if (options.finder != Finder::bracketing && options.distance != DistanceMethod::dual) {
    throw std::invalid_argument("distance: only the finder \"bracketing\" has a choice; accepted: \"dual\"");
  }
  if (options.finder != Finder::bracketing) return;
  if (options.eps_d > 0 && options.eps_d < smallest_semi_axis) return;
  std::ostringstream message;
  message << "eps_d is " << options.eps_d << "; accepted: above 0 and below the smallest semi-axis, "
          << smallest_semi_axis;
  throw std::invalid_argument(message.str());
}

}  // namespace ed::internal
