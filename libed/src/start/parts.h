#pragma once

/// Functions shared by all starts.

#include <ed/random.h>
#include <ed/shape.h>
#include <ed/start.h>
#include <ed/system.h>

#include <geom/pose.h>

#include <vector>

namespace ed::internal {

/// Returns whether the bodies may overlap: true unless it is certain that they do not.
bool overlaps(const BodyShape& a, const geom::Pose& X_a, const BodyShape& b, const geom::Pose& X_b);

double largest_radius(const std::vector<Component>& components);

/// Throws std::invalid_argument for no components, a component without bodies, or a species that is not sound.
void check_components(const std::vector<Component>& components);

/// Throws std::invalid_argument, naming the number, if a body could touch two images of another in this box; naming the
/// packing fraction, if the box is beyond geom::kMaxCoordinate.
void check_target(const std::vector<Component>& components, double box);

/// Returns the bodies of the components, in their order, without positions.
System bodies_of(const std::vector<Component>& components);

/// Renumbers the bodies of each species along a curve that fills the box, so that bodies that are near each other are
/// near each other in memory, too. Small numbers of bodies are left unchanged.
void number_along_curve(System& system);

/// Draws velocities from the Maxwell distribution; the caller has to call rescale_velocities().
void draw_velocities(System& system, Random& random);

/// Sets the momentum to zero and the temperatures of all bodies together, as rescale_velocities() does for one group.
void rescale_together(System& system);

}  // namespace ed::internal
