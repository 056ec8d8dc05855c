#pragma once

#include "plot/contours.h"
#include "plot/map_svg.h"

#include <vector>

namespace hardbody {

/// Levels for lines where none are given: six between the extremes, by equal factors where all values are positive; two
/// digits. Of one sample at least.
std::vector<double> chosen_levels(const std::vector<Sample>& samples);

/// The lines of the levels, `value` and `of` still to be filled in. Samples and lines are in the coordinates of the
/// data, interpolation is in those of the drawing: on a logarithmic axis coordinates are above 0. Values between
/// positive ones are interpolated by their logarithms: diffusivities span decades.
std::vector<MapLevel> map_levels(std::vector<Sample> samples, const std::vector<double>& levels, MapScales scales);

}  // namespace hardbody
