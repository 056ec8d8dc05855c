#pragma once

/// Room of a body of any shape in a box around it, and the size of the periodic box that this needs.

#include <ed/shape.h>

#include <vector>

namespace ed::internal {

/// Returns an upper bound of the distance between the centre of a body and that of its box, which is thicker than the
/// body by `thickness` on every side, while the body stays inside.
///
/// Its height h along an axis of the box is no less than the inscribed radius. A centrally symmetric body that reaches
/// to a distance R from its centre has a point there which is within the extents of the box along the other two axes,
/// and so leaves h^2 >= R^2 - their squares.
double oriented_slack(const BodyShape& shape, double thickness);

/// Returns the shortest periodic box with boxes of this thickness around bodies of all these shapes, which can turn in
/// them.
///
/// Bodies that touch while both are in their boxes have centres within 2 R; each centre moves by at most twice the
/// slack inside its box, so that before and after they are within 2 R + 4 slack, which must be below half the periodic
/// box.
double smallest_oriented_box(const std::vector<BodyShape>& shapes, double thickness);

}  // namespace ed::internal
