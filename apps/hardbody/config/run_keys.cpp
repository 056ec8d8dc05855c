/// Keys of [equilibration], [production] and [output].

#include "base/number_text.h"
#include "config/keys.h"
#include "config/rules.h"

#include <ed/observables.h>

#include <fmt/format.h>

#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {
namespace {

constexpr std::int64_t kMostEvents = 100'000'000;  ///< rows of events.csv, 50 bytes each
constexpr std::int64_t kMostFrames = 100'000;      ///< frames for all of which the files' heads have room
constexpr double kLongestTime = 1e9;               ///< time in ed::time_unit of the bodies, as is kLeastCap
constexpr double kShortestInterval = 1e-9;         ///< shortest time between two frames
constexpr double kLeastCap = 1;
constexpr double kLeastLag = 0.01;  ///< least longest lag, also in that unit: bounds the cost of measuring
constexpr double kLargestWaveNumber = 1e6;

constexpr const char* kAuto = "\"auto\"";
constexpr const char* kTimeUnit = "time unit l sqrt(m/kT)";

Taken take_time(const Value& value, const Place& at, std::optional<double>& result) {
  const double longest = kLongestTime * at.config.time_unit;
  result = std::nullopt;
  if (toml_text(value) == kAuto) return std::nullopt;
  result = value.real;
  return is_number(value) && value.real >= 0 && value.real <= longest
             ? Taken()
             : Refusal{fmt::format("{} or a number at least 0, at most {:g} ({})", kAuto, longest, kTimeUnit)};
}

Rule time_or_auto(std::optional<double> Config::*member) {
  Rule rule = bound(member, take_time);
  rule.text = [member](const Place& at) { return at.config.*member ? value_text(at.config.*member) : kAuto; };
  return rule;
}

Taken take_cap(const Value& value, const Place& at, double& result) {
  const double unit = at.config.time_unit;
  return take_number(value, {kLeastCap * unit, kLongestTime * unit}, kTimeUnit, result);
}

/// Returns the longest production that a config allows, and so the longest lag.
double longest_production(const Config& config) {
  return config.production_time.value_or(kMostProduction * config.time_unit);
}

Taken take_longest_lag(const Value& value, const Place& at, std::optional<double>& result) {
  const double most = longest_production(at.config);
  const double least = std::min(kLeastLag * at.config.time_unit, most);
  result = std::nullopt;
  if (toml_text(value) == kAuto) return std::nullopt;
  result = value.real;
  if (is_number(value) && most > 0 && value.real >= least && value.real <= most) return std::nullopt;
  if (!(most > 0)) return Refusal{fmt::format("{}, since production.time is 0", kAuto)};
  const char* limit = at.config.production_time ? "production.time" : "the longest production";
  return Refusal{fmt::format("{} or a number from {:g} to {}, {:g} ({})", kAuto, least, limit, most, kTimeUnit)};
}

Rule longest_lag_rule() {
  Rule rule = bound(&Config::longest_lag, take_longest_lag);
  rule.text = [](const Place& at) { return at.config.longest_lag ? value_text(at.config.longest_lag) : kAuto; };
  return rule;
}

Taken take_wave_numbers(const Value& value, const Place&, std::vector<double>& result) {
  result.resize(value.items.size());
  const bool good = take_positive(value, result) && result.size() <= ed::kMostWaveNumbers &&
                    std::all_of(result.begin(), result.end(), [](double q) { return q <= kLargestWaveNumber; });
  return good ? Taken()
              : Refusal{fmt::format("a list of at most {} numbers above 0, at most {:g} (1/l)", ed::kMostWaveNumbers,
                                    kLargestWaveNumber)};
}

Taken take_order(const Value& value, const Place&, std::vector<BondOrder>& result) {
  for (const Value& item : value.items) {
    for (const auto order : {BondOrder::steinhardt, BondOrder::hexatic}) {
      const bool twice = std::find(result.begin(), result.end(), order) != result.end();
      if (toml_text(item) == value_text(order) && !twice) result.push_back(order);
    }
  }
  const bool all = value.kind == Value::Kind::array && result.size() == value.items.size();
  return all ? Taken() : Refusal{"an array of \"steinhardt\" and \"hexatic\", each at most once"};
}

Taken take_trajectory(const Value& value, const Place&, std::vector<TrajectoryFormat>& result) {
  for (const Value& item : value.items) {
    for (const auto format : {TrajectoryFormat::gsd, TrajectoryFormat::lammps, TrajectoryFormat::vtk}) {
      const bool twice = std::find(result.begin(), result.end(), format) != result.end();
      if (toml_text(item) == value_text(format) && !twice) result.push_back(format);
    }
  }
  const bool all = value.kind == Value::Kind::array && result.size() == value.items.size();
  return all ? Taken() : Refusal{"an array of \"gsd\", \"lammps\" and \"vtk\", each at most once"};
}

std::string production_comment(const Place& at) {
  const double unit = at.config.time_unit;
  return fmt::format(
      "in l sqrt(m/kT); \"auto\": 30 times the equilibration, from {:g}\n"
      "to {:g}; or until the relative errors of both diffusion coefficients are",
      kLeastProduction * unit, kMostProduction * unit);
}

/// Whether it is a time of checkpoints.
constexpr auto is_duration = [](const std::string& text) { return duration_seconds(text).has_value(); };
constexpr bool kMayChange = true;
constexpr auto has_log_frames = [](const Place& at) { return at.config.frames_spacing == FramesSpacing::log; };
constexpr auto has_production_time = [](const Place& at) { return at.config.production_time.has_value(); };

}  // namespace

std::vector<Key> run_keys() {
  return {
      {"equilibration.time", "\"auto\"", time_or_auto(&Config::equilibration_time),
       "in l sqrt(m/kT); \"auto\": until C2 and F_self have decayed below\n0.05 twice in a row, and Z and S do not "
       "drift"},
      {"equilibration.cap", "500 thermal times", bound(&Config::equilibration_cap, take_cap),
       "of \"auto\": the state counts as not equilibrated then"},
      {"production.time", "\"auto\"", time_or_auto(&Config::production_time), production_comment},
      {"production.target_error", "",
       unless(has_production_time, "no target_error, or production.time = \"auto\"",
              number(&Config::target_error, {1e-4, 1}, "standard error over value, of both diffusion coefficients")),
       "at most this", nullptr, "target_error = 0.02, if that is given"},
      {"production.longest_lag", "\"auto\"", longest_lag_rule(),
       "of correlations, in l sqrt(m/kT), at most the production; \"auto\": a\n"
       "sixteenth of production.time"},
      {"production.wave_numbers", "[]", bound(&Config::wave_numbers, take_wave_numbers),
       "of F_self in 1/l, at most 8; the decay at the first is fitted.\n"
       "[]: first peak of S(q), and a quarter, half and twice of it"},
      {"production.collective", "false", flag(&Config::collective),
       "true: also F(q, t) / S(q) of all bodies, at these wave numbers"},
      {"production.order", "[]", bound(&Config::order, take_order),
       "of bonds: any of \"steinhardt\", q4 and q6, and \"hexatic\", psi6 across the\ndirector"},
      {"production.order_neighbours", "12",
       integer(&Config::order_neighbours, ed::kFewestNeighbours, ed::kMostNeighbours),
       "number of nearest neighbours that have a bond with a body, for q4 and q6"},
      {"output.events", "0", integer(&Config::events, 0, kMostEvents),
       "number of production collisions to record in events.csv"},
      {"output.trajectory", "[]", bound(&Config::trajectory, take_trajectory),
       "of production: any of \"gsd\", \"lammps\" and \"vtk\""},
      {kFramesKey, "100", integer(&Config::frames, 2, kMostFrames),
       "of each, from the begin of production to its end; with frames_every\nat most"},
      {kSpacingKey, "\"even\"", choice(&Config::frames_spacing, {FramesSpacing::even, FramesSpacing::log}),
       "in time; or \"log\": the first one at 0, times that grow by a factor behind it"},
      {kEveryKey, "",
       unless(has_log_frames, "no frames_every, or frames_spacing = \"even\"",
              number(&Config::frames_every, {kShortestInterval, kLongestTime}, kTimeUnit)),
       "between two frames, whatever the length of production", nullptr, "frames_every = 0.5, if that is given"},
      {"output.checkpoint_every", "\"60s\"",
       text(&Config::checkpoint_every, is_duration,
            "a string of a positive number and a unit, as in \"60s\", \"5m\", \"1h\""),
       "of checkpoint.bin: a number and s, m or h; it is also written at\nthe end, and when the run is stopped",
       nullptr, "", kMayChange},
  };
}

}  // namespace hardbody
