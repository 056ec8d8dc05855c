#pragma once

/// What the starts share.

#include <ed/random.h>
#include <ed/shape.h>
#include <ed/start.h>
#include <ed/system.h>

#include <geom/pose.h>

#include <vector>

namespace ed::internal {

/// Anything but a certain no counts as overlap.
bool overlaps(const BodyShape& a, const geom::Pose& X_a, const BodyShape& b, const geom::Pose& X_b);

double largest_radius(const std::vector<Component>& components);

/// Throws std::invalid_argument for no components, one without bodies, or a species that is not sound.
void check_components(const std::vector<Component>& components);

/// Throws std::invalid_argument, naming the number, if a body could meet two images of another in this box.
void check_target(const std::vector<Component>& components, double box);

/// The bodies of the components, in their order, without places.
System bodies_of(const std::vector<Component>& components);

/// Numbers many bodies of a species along a curve that fills the box: bodies that are near each other stand near each
/// other in memory, too. Few are left as they are.
void number_along_curve(System& system);

/// Draws velocities from the Maxwell distribution; rescale_velocities() is the caller's.
void draw_velocities(System& system, Random& random);

/// Sets momentum zero and the temperatures of all bodies together, as rescale_velocities() does for one group.
void rescale_together(System& system);

}  // namespace ed::internal
