#include "loop/checks.h"

#include "base/power_of_two.h"
#include "motion/checks.h"
#include "neighbours/cell.h"
#include "neighbours/limits.h"

#include <ed/simulation.h>
#include <ed/tolerances.h>

#include <cmath>
#include <sstream>
#include <stdexcept>
#include <string>

namespace ed::internal {

void check_box(const System& system, double bounding_radius) {
  if (system.box >= smallest_image_box(bounding_radius) * (1 - 1e-12)) return;
  std::ostringstream message;
  message << "box: an edge of " << system.box << " is too short for bodies of bounding radius " << bounding_radius
          << ": a body could meet two images of another; accepted: at least " << smallest_image_box(bounding_radius);
  if (system.species.size() == 1) {
    message << " (number: at least " << smallest_number(system.species[0].shape, packing_fraction(system))
            << " at this packing fraction)";
  }
  throw std::invalid_argument(message.str());
}

void check_cells(double box, double bounding_radius) {
  const int cells = CellLayout::cells_along(box, bounding_radius);
  if (cells >= CellLayout::kLeastCells) return;
  std::ostringstream message;
  message << "neighbours = \"cells\": only " << cells << " cells of twice the bounding radius " << bounding_radius
          << " fit along the box's edge of " << box << "; accepted: at least " << CellLayout::kLeastCells;
  throw std::invalid_argument(message.str());
}

double epoch_of(const System& system) {
  const KineticState kinetic = kinetic_state(system);
  const int degrees_of_freedom =
      3 * system.size() + kinetic.rotational_degrees_of_freedom + kinetic.spin_degrees_of_freedom;
  const double kT = 2 * kinetic.energy() / degrees_of_freedom;
  if (!(kT > 0)) return 1;  // nothing moves
  double rates = 0;
  for (int i = 0; i < system.size(); ++i) rates += 1 / thermal_time(system.species_of(i));
  return nearest_power_of_two(system.size() / (rates * std::sqrt(kT)));
}

void check_speeds(const System& system) {
  const auto check = [&](Eigen::Vector3d Body::*member, const std::string& what) {
    const Body* fastest = nullptr;
    double largest = 0;
    for (const Body& body : system.bodies) {
      const double speed = (body.*member).stableNorm();
      if (!(speed > largest) || !std::isfinite(speed)) continue;
      largest = speed;
      fastest = &body;
    }
    if (fastest == nullptr || (largest >= kMinSpeed && largest <= kMaxSpeed)) return;
    const std::string number = std::to_string(fastest - system.bodies.data());
    refuse_speed(fastest->*member, what + " of the fastest body, " + number + ',');
  };
  check(&Body::velocity, "velocity");
  check(&Body::angular_velocity, "angular velocity");
}

}  // namespace ed::internal
