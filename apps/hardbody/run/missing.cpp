#include "run/missing.h"

#include "run/phases.h"

#include <algorithm>
#include <array>
#include <cmath>

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

bool longer_lags_help(const ed::Correlations& r) {
  const std::array all = {r.D_trans,
                          r.D_rot,
                          r.D_rot_body,
                          r.t_C2_1overe,
                          r.tau_C2,
                          r.t_F_1overe,
                          r.tau_F,
                          r.D_rot_axis[0],
                          r.D_rot_axis[1],
                          r.D_rot_axis[2],
                          r.t_C2_1overe_axis[0],
                          r.t_C2_1overe_axis[1],
                          r.t_C2_1overe_axis[2]};
  return std::any_of(all.begin(), all.end(), [](const ed::Estimate& e) {
    return !std::isfinite(e.value) && ed::longer_lags_help(e.missing.reason);
  });
}

}  // namespace hardbody
