#include "plot/levels.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

namespace hardbody {
namespace {

constexpr int kLevels = 6;

void to_data(ContourLine& line, MapScales scales) {
  for (PlanePoint& p : line) {
    if (scales.log_x) p.x = std::pow(10.0, p.x);
    if (scales.log_y) p.y = std::pow(10.0, p.y);
  }
}

}  // namespace

std::vector<double> chosen_levels(const std::vector<Sample>& samples) {
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end(),
                                               [](const Sample& a, const Sample& b) { return a.value < b.value; });
  std::vector<double> levels;
  for (int k = 1; k <= kLevels; ++k) {
    const double share = k / (kLevels + 1.0);
    const double level = low->value > 0 ? low->value * std::pow(high->value / low->value, share)
                                        : low->value + share * (high->value - low->value);
    levels.push_back(std::stod(fmt::format("{:.2g}", level)));
  }
  levels.erase(std::unique(levels.begin(), levels.end()), levels.end());
  return levels;
}

std::vector<MapLevel> map_levels(std::vector<Sample> samples, const std::vector<double>& levels, MapScales scales) {
  const bool log = std::all_of(samples.begin(), samples.end(), [](const Sample& s) { return s.value > 0; });
  for (Sample& s : samples) {
    if (scales.log_x) s.x = std::log10(s.x);
    if (scales.log_y) s.y = std::log10(s.y);
    if (log) s.value = std::log(s.value);
  }
  const Lattice lattice = lattice_of(samples);
  std::vector<MapLevel> result;
  for (const double level : levels) {
    MapLevel one;
    one.level = level;
    if (!log || level > 0) one.lines = contour_lines(lattice, log ? std::log(level) : level);
    for (ContourLine& line : one.lines) to_data(line, scales);
    result.push_back(std::move(one));
  }
  return result;
}

}  // namespace hardbody
