#pragma once

#include "plot/contours.h"
#include "plot/map_svg.h"

#include <vector>

namespace hardbody {

/// Returns round numbers strictly between two values, about six: multiples of a round step, or, from a ratio of 4 on,
/// 1, 2, 5 and so on times powers of ten.
std::vector<double> round_levels(double low, double high);

/// Returns the round levels between the extremes of the samples, of which there is at least one.
std::vector<double> chosen_levels(const std::vector<Sample>& samples);

/// Returns the lines of the levels, with `value` and `of` still to be set. Samples and lines are in the coordinates of
/// the data, interpolation is in those of the drawing: on a logarithmic axis coordinates are above 0. Positive values
/// are interpolated by their logarithms, because diffusivities span decades. Samples at one point are averaged first.
std::vector<MapLevel> map_levels(const std::vector<Sample>& measured, const std::vector<double>& levels,
                                 MapScales scales);

}  // namespace hardbody
