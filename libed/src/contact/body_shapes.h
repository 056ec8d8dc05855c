#pragma once

/// Properties of a BodyShape that contact searches need.

#include "contact/support_gap.h"

#include <ed/contact_options.h>
#include <ed/shape.h>

#include <geom/distance.h>
#include <geom/shape_variant.h>

#include <optional>

namespace ed::internal {

/// Throws std::invalid_argument for exponents beyond those tested in motion.
void check_exponents(const BodyShape& shape);

/// Returns the shape as the paper's equations take it (geom::has_equations); nullopt if they cannot.
std::optional<geom::Shape> shape_with_equations(const BodyShape& shape);

/// Throws std::invalid_argument if the options ask for the paper's search, which needs implicit surfaces, of a body
/// that has none.
void check_finder(const ContactOptions& options, const BodyShape& shape);

/// Returns an upper bound of the way by which a radian of turning can move the surface along any normal: max |s(n) -
/// h(n) n| over unit n, the derivative of h along the sphere, or more.
/// @{
double turning_lever(const geom::Ellipsoid& shape);
double turning_lever(const geom::Shape& shape);
double turning_lever(const BodyShape& shape);
/// @}

/// Returns whether the result has a distance: the bodies are apart or overlap.
inline bool is_answer(const geom::DistanceResult& result) {
  return result.status == geom::DistanceStatus::separated || result.status == geom::DistanceStatus::overlapping;
}

/// Returns the shape as SupportGap needs it; nullopt for one that is not the unit ball of a norm that NormShape knows.
std::optional<NormBodyShape> norm_body(const BodyShape& shape);

}  // namespace ed::internal
