#include "run/missing.h"

#include "registry/observables.h"
#include "run/record.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hardbody {

namespace {

/// Share of production beyond which longer lags have too few origins to be worth asking for.
constexpr double kMostOfProduction = 0.25;

}  // namespace

MissingWords missing_words(const RunRecord& record) {
  MissingWords words;
  const bool room = record.production.longest_lag < kMostOfProduction * record.production.planned;
  const bool frames = room && !record.config.trajectory.empty();
  words.longer_lags = frames ? "production.longest_lag, hardbody analyze --longest-lag or a longer run helps"
                      : room ? "production.longest_lag or a longer run helps"
                             : "a longer run helps";
  return words;
}

std::string missing_text(const ed::Missing& missing, const MissingWords& words) {
  std::string text = ed::describe(missing, words.length_unit);
  const auto add = [&](bool wanted, const std::string& help) {
    if (wanted && !help.empty()) text += "; " + help;
  };
  add(ed::longer_lags_help(missing.reason), words.longer_lags);
  add(missing.reason == ed::MissingReason::end_of_ballistic_unknown, words.end_of_ballistic);
  add(missing.reason == ed::MissingReason::not_unwrapped, words.unwrapping);
  add(missing.reason == ed::MissingReason::not_followed, words.following);
  return text;
}

bool longer_lags_help(const Part& part) {
  const auto help = [](const ed::Estimate& e) {
    return !std::isfinite(e.value) && ed::longer_lags_help(e.missing.reason);
  };
  return std::any_of(observables().begin(), observables().end(), [&](const Observable& o) {
    if (!o.remark || o.remark(part).empty() || (part.spheres && o.of_orientation)) return false;
    const std::vector<ed::Estimate> numbers = numbers_of(o, part);
    return std::any_of(numbers.begin(), numbers.end(), help);
  });
}

}  // namespace hardbody
