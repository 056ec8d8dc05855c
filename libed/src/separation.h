#pragma once

namespace ed::internal {

/// What a gauge's last resort says of two bodies at one time.
enum class Separation {
  apart,        ///< a normal with g > 0, to rounding
  overlapping,  ///< by more than kOverlap * size, as certain as geom::distance is of its answer
  declined,     ///< no method tells
};

}  // namespace ed::internal
