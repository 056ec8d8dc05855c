#include "plot/levels.h"

#include <algorithm>
#include <cmath>
#include <map>
#include <utility>

namespace hardbody {
namespace {

constexpr int kLevels = 6;              ///< number of levels that is aimed at
constexpr double kLogarithmicFrom = 4;  ///< ratio of the extremes from which on levels follow the logarithm

void to_data(ContourLine& line, MapScales scales) {
  for (PlanePoint& p : line) {
    if (scales.log_x) p.x = std::pow(10.0, p.x);
    if (scales.log_y) p.y = std::pow(10.0, p.y);
  }
}

/// Returns multiples of a round step.
std::vector<double> linear_levels(double low, double high) {
  const double raw = (high - low) / kLevels;
  const double decade = std::pow(10.0, std::floor(std::log10(raw)));
  double step = 10 * decade;
  for (const double factor : {5.0, 2.5, 2.0, 1.0}) {
    if (factor * decade >= raw) step = factor * decade;
  }
  std::vector<double> levels;
  for (double k = std::ceil(low / step); k * step < high; ++k) levels.push_back(k * step);
  return levels;
}

/// Returns these digits times powers of ten strictly between two values, from every `stride`-th decade.
std::vector<double> digits_between(double low, double high, const std::vector<double>& digits, int stride) {
  std::vector<double> levels;
  const int last = static_cast<int>(std::floor(std::log10(high)));
  for (int power = static_cast<int>(std::floor(std::log10(low))); power <= last; power += stride) {
    for (const double digit : digits) levels.push_back(digit * std::pow(10.0, power));
  }
  std::erase_if(levels, [&](double x) { return x <= low || x >= high; });
  return levels;
}

/// Returns round numbers whose logarithms are about evenly spaced: of several series the one whose number is nearest to
/// kLevels.
std::vector<double> logarithmic_levels(double low, double high) {
  const int stride = std::max(1, static_cast<int>(std::ceil(std::log10(high / low) / kLevels)));
  std::vector<double> levels = digits_between(low, high, {1}, stride);
  const auto excess = [](const std::vector<double>& list) { return std::abs(static_cast<int>(list.size()) - kLevels); };
  for (const std::vector<double>& digits : {std::vector<double>{1, 3}, {1, 2, 5}, {1, 1.5, 2, 3, 5, 7}}) {
    std::vector<double> finer = digits_between(low, high, digits, 1);
    if (excess(finer) < excess(levels)) levels = std::move(finer);
  }
  return levels;
}

/// Returns the samples with one value at each point, the mean of all: of several seeds, say.
std::vector<Sample> averaged(const std::vector<Sample>& samples) {
  std::map<std::pair<double, double>, std::pair<double, int>> sums;
  for (const Sample& s : samples) {
    auto& [sum, number] = sums[{s.x, s.y}];
    sum += s.value;
    ++number;
  }
  std::vector<Sample> means;
  means.reserve(sums.size());
  for (const auto& [at, sum] : sums) means.push_back({at.first, at.second, sum.first / sum.second});
  return means;
}

}  // namespace

std::vector<double> round_levels(double low, double high) {
  if (!(low < high)) return {};
  std::vector<double> levels =
      low > 0 && high >= kLogarithmicFrom * low ? logarithmic_levels(low, high) : linear_levels(low, high);
  std::erase_if(levels, [&](double x) { return x <= low || x >= high; });
  return levels;
}

std::vector<double> chosen_levels(const std::vector<Sample>& samples) {
  const auto [low, high] = std::minmax_element(samples.begin(), samples.end(),
                                               [](const Sample& a, const Sample& b) { return a.value < b.value; });
  return round_levels(low->value, high->value);
}

std::vector<MapLevel> map_levels(const std::vector<Sample>& measured, const std::vector<double>& levels,
                                 MapScales scales) {
  std::vector<Sample> samples = averaged(measured);
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
