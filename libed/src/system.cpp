#include "cell_envelopes.h"
#include "cell_grid.h"
#include "dilated_envelopes.h"

#include <ed/system.h>

#include <geom/distance.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>

namespace ed {
namespace {

using Eigen::Vector3d;

int axis_of(const geom::Ellipsoid& shape) {
  const auto axis = shape.symmetry_axis();
  if (!axis) {
    std::ostringstream message;
    message << "semi_axes [" << shape.semi_axes().transpose()
            << "]: three different semi-axes are not available yet; accepted: two equal ones";
    throw std::invalid_argument(message.str());
  }
  return *axis;
}

}  // namespace

Species paper_species(const geom::Ellipsoid& shape, double mass) {
  axis_of(shape);
  const double r = shape.inscribed_radius();
  return {shape, mass, Vector3d::Constant(0.4 * mass * r * r), false};
}

Species uniform_species(const geom::Ellipsoid& shape, double mass) {
  axis_of(shape);
  return {shape, mass, shape.inertia(mass), true};
}

double packing_fraction(const System& system) {
  return system.size() * system.species.shape.volume() / (system.box * system.box * system.box);
}

double box_for(const geom::Ellipsoid& shape, int number, double packing_fraction) {
  return std::cbrt(number * shape.volume() / packing_fraction);
}

int smallest_number(const geom::Ellipsoid& shape, double packing_fraction, Neighbours neighbours) {
  const double R = shape.bounding_radius();
  const double box = neighbours == Neighbours::cells
                         ? std::max(internal::smallest_box(R), internal::CellEnvelopes::smallest_box(R))
                         : internal::smallest_box(R);
  return std::max(2, static_cast<int>(std::ceil(packing_fraction * box * box * box / shape.volume())));
}

KineticState kinetic_state(const System& system) {
  KineticState state;
  const Species& species = system.species;
  const int axis = axis_of(species.shape);
  const double perpendicular = species.inertia[(axis + 1) % 3];
  for (const Body& body : system.bodies) {
    const Vector3d u = body.rotation.col(axis);
    const double spin = body.angular_velocity.dot(u);
    state.translational_energy += 0.5 * species.mass * body.velocity.squaredNorm();
    state.rotational_energy += 0.5 * perpendicular * (body.angular_velocity - spin * u).squaredNorm();
    state.spin_energy += 0.5 * species.inertia[axis] * spin * spin;
    state.momentum += species.mass * body.velocity;
  }
  const int n = system.size();
  state.translational_kT = 2 * state.translational_energy / std::max(1, 3 * n - 3);
  state.rotational_kT = 2 * state.rotational_energy / (2 * n);
  return state;
}

Audit audit(const System& system) {
  Audit result;
  result.minimum_distance = system.box;
  result.kinetic = kinetic_state(system);
  const int n = system.size();
  std::vector<geom::Pose> poses(static_cast<std::size_t>(n));
  // Bounding spheres that meet, and a mean distance more, so that there is a closest pair to name in a dilute system
  // too.
  const double reach =
      std::min(2 * system.species.shape.bounding_radius() + system.box / std::cbrt(n), 0.5 * system.box);
  internal::CellGrid cells(n, system.box, reach);
  for (int i = 0; i < n; ++i) {
    const Body& body = system.bodies[static_cast<std::size_t>(i)];
    if (!body.position.allFinite() || !body.rotation.allFinite() || !body.velocity.allFinite() ||
        !body.angular_velocity.allFinite()) {
      result.finite = false;
      return result;
    }
    poses[static_cast<std::size_t>(i)] = geom::Pose(body.rotation, body.position);
    cells.place(i, body.position);
  }
  std::vector<internal::NearBody> near;
  for (int i = 0; i < n; ++i) {
    const geom::Pose& X_i = poses[static_cast<std::size_t>(i)];
    for (const auto& [j, r] : cells.collect(X_i.position(), reach, near)) {
      if (j <= i) continue;
      const geom::Pose X_image(poses[static_cast<std::size_t>(j)].rotation(), X_i.position() + r);
      const geom::DistanceResult d = geom::distance(system.species.shape, X_i, system.species.shape, X_image);
      if (!(d.status == geom::DistanceStatus::separated || d.status == geom::DistanceStatus::overlapping)) {
        ++result.unanswered;
        continue;
      }
      if (d.distance < -kAuditOverlap) ++result.overlaps;
      if (d.distance < result.minimum_distance) {
        result.minimum_distance = d.distance;
        result.closest_i = i;
        result.closest_j = j;
      }
    }
  }
  return result;
}

}  // namespace ed
