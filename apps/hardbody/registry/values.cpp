// Values of observables: those of a part, and what is said of numbers.

#include "registry/observables.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <vector>

namespace hardbody {
namespace {

using ed::GroupResults;
using ed::Results;

/// Differences of the motion along two edges of the box that are shown.
constexpr double kDifferentShare = 0.1;
constexpr double kDifferentErrors = 4;

}  // namespace

Part whole_part(const ed::Results& results, const std::vector<ed::BodyGroup>& groups, bool body_axes,
                const std::vector<double>& wave_numbers) {
  Part part{.results = results, .whole = &results, .body_axes = body_axes, .wave_numbers = wave_numbers};
  double axes = 0;
  double axes_of_oriented = 0;
  int oriented = 0;
  for (const ed::BodyGroup& group : groups) {
    part.number += group.number;
    axes += group.rotation_axes * group.number;
    if (!group.oriented) continue;
    axes_of_oriented += group.rotation_axes * group.number;
    oriented += group.number;
  }
  part.rotation_axes = axes / part.number;
  if (oriented > 0) part.averaged_axes = axes_of_oriented / oriented;
  part.spheres = oriented == 0;
  return part;
}

std::vector<ed::Estimate> numbers_of(const Observable& observable, const Part& part) {
  if (observable.of_box && part.results.lags.empty()) return {};
  const ObservableValue& value = observable.value;
  if (const auto* member = std::get_if<ed::Estimate GroupResults::*>(&value)) return {part.results.**member};
  if (const auto* of = std::get_if<ed::Estimate (*)(const GroupResults&)>(&value)) return {(*of)(part.results)};
  if (const auto* member = std::get_if<ed::Estimate Results::*>(&value); member != nullptr && part.whole != nullptr) {
    return {part.whole->**member};
  }
  if (const auto* member = std::get_if<std::array<ed::Estimate, 3> GroupResults::*>(&value)) {
    const std::array<ed::Estimate, 3>& axes = part.results.**member;
    return {axes.begin(), axes.end()};
  }
  if (const auto* member = std::get_if<ed::Estimate ed::ScatteringDecay::*>(&value)) {
    std::vector<ed::Estimate> list;
    for (const ed::ScatteringDecay& decay : part.results.decays_F) list.push_back(decay.**member);
    return list;
  }
  if (const auto* collective = std::get_if<CollectiveDecay>(&value)) {
    std::vector<ed::Estimate> list;
    for (const ed::ScatteringDecay& decay : part.results.decays_collective) list.push_back(decay.*collective->member);
    return list;
  }
  return {};
}

bool has_axes(const Observable& observable, const Part& part) {
  const bool known = part.whole == nullptr || !part.whole->groups.empty();
  return is_per_axis(observable) && (observable.of_box || (part.body_axes && known));
}

bool has_director(const ed::GroupResults& results) {
  return results.director.exists;
}

bool are_apart(const ed::Estimate& a, const ed::Estimate& b) {
  const double difference = std::abs(a.value - b.value);
  return difference > kDifferentShare * std::max(a.value, b.value) &&
         difference > kDifferentErrors * std::hypot(a.error, b.error);
}

bool edges_differ(const ed::Correlations& results) {
  if (results.lags.empty()) return false;
  const std::array<ed::Estimate, 3>& msd = results.lags.back().msd_box;
  for (std::size_t k = 0; k < msd.size(); ++k) {
    if (are_apart(msd[k], msd[(k + 1) % msd.size()])) return true;
  }
  return false;
}

ed::Estimate component_of(const ed::Director& director, int axis) {
  const double n = director.axis[axis];
  return {n, director.error * std::sqrt(std::max(0.0, 1 - n * n) / 2)};
}

bool is_absent(const ed::Estimate& number) {
  const ed::MissingReason reason = number.missing.reason;
  return !std::isfinite(number.value) &&
         (reason == ed::MissingReason::not_asked || reason == ed::MissingReason::no_such_axis);
}

}  // namespace hardbody
