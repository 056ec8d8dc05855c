#pragma once

/// Proof that cores overlap, however little.

#include "cores/contact.h"
#include "cores/rims.h"

namespace geom::kernel {

/// Returns a depth that the overlap of a contact whose points match has for certain; 0 if none is proved.
///
/// The points a - b of A and B are a convex set, and the depth is the distance of the origin from its surface. The
/// origin lies below the point t of the set that is furthest along n, by the depth across n. Three further points of
/// the set and t are a tetrahedron in it. If it has the origin inside, the distance of the origin from its faces is
/// certain; it is a share of the depth across n, however shallow the overlap is.
double certain_depth(const RoundCore& a, const RoundCore& b, double size, const CoreContact& contact);

}  // namespace geom::kernel
