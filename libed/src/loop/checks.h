#pragma once

/// Checks of what an event loop is made of, and its unit of time.

#include <ed/system.h>

namespace ed::internal {

/// Throws std::invalid_argument if the box is too short for nearest images of bodies of this bounding radius.
void check_box(const System& system, double bounding_radius);

/// Throws std::invalid_argument if the box has too few cells for Neighbours::cells.
void check_cells(double box, double bounding_radius);

/// Throws std::invalid_argument if the fastest body's speed or angular speed is not 0 and out of [kMinSpeed,
/// kMaxSpeed].
void check_speeds(const System& system);

/// Returns the length of an epoch: a power of two about the time in which bodies move by their size, so that times
/// within it are as exact as the way that bodies go in them. It is the harmonic mean of these times: at its end all
/// bodies are moved, which is then about as often as they move by their sizes, be a few of them as fast as they may.
double epoch_of(const System& system);

}  // namespace ed::internal
