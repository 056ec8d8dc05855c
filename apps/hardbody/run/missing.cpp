#include "run/missing.h"

#include "registry/observables.h"
#include "run/record.h"

#include <algorithm>
#include <cmath>
#include <vector>

namespace hardbody {

MissingWords missing_words(const RunRecord& record) {
  MissingWords words;
  words.longer_lags = lags_are_longest(record.config, record.production)
                          ? "hardbody analyze --longest-lag reads longer ones off a trajectory"
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

bool longer_lags_help(const ed::GroupResults& results) {
  const auto help = [](const ed::Estimate& e) {
    return !std::isfinite(e.value) && ed::longer_lags_help(e.missing.reason);
  };
  return std::any_of(observables().begin(), observables().end(), [&](const Observable& o) {
    const std::vector<ed::Estimate> numbers = numbers_of(o, {results});
    return std::any_of(numbers.begin(), numbers.end(), help);
  });
}

}  // namespace hardbody
