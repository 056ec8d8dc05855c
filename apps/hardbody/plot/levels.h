#pragma once

#include "plot/contours.h"
#include "plot/map_svg.h"

#include <vector>

namespace hardbody {

/// Returns default levels: six between the extremes, by equal factors if all values are positive; two digits. Needs at
/// least one sample.
std::vector<double> chosen_levels(const std::vector<Sample>& samples);

/// Returns the lines of the levels, with `value` and `of` still to be set. Samples and lines are in the coordinates of
/// the data, interpolation is in those of the drawing: on a logarithmic axis coordinates are above 0. Positive values
/// are interpolated by their logarithms, because diffusivities span decades.
std::vector<MapLevel> map_levels(std::vector<Sample> samples, const std::vector<double>& levels, MapScales scales);

}  // namespace hardbody
