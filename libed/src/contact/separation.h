#pragma once

namespace ed::internal {

/// Verdict of a pair gap's last resort on two bodies at one time, by bounds of their signed distance.
enum class Separation {
  apart,        ///< certainly not deeper than kOverlap * size, or not known to be
  overlapping,  ///< certainly deeper than kOverlap * size
  declined,     ///< no method tells
};

}  // namespace ed::internal
