#include "run/summary.h"

#include "base/version.h"
#include "io/json_values.h"
#include "run/estimate_json.h"

#include <nlohmann/json.hpp>

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>
#include <string>
#include <utility>
#include <variant>

namespace hardbody {
namespace {

using Json = nlohmann::ordered_json;

/// What D_rot is divided by.
std::string rotation_divisor(const Config& config) {
  if (config.all_of_revolution()) return "/ 4, two components, spin excluded";
  const bool none = std::all_of(config.species.begin(), config.species.end(),
                                [](const SpeciesConfig& s) { return s.rotation_axes() == 3; });
  if (none) return "/ 6, three components";
  return "/ (2 c), c the number of components: 2 of bodies of revolution, spin excluded, 3 of others, of all their "
         "mean";
}

Json units(const Config& config) {
  return {{"length",
           config.mixture ? "l = 1: semi-axes are taken as they are given" : "l = (a b c)^(1/3) of the semi-axes = 1"},
          {"mass", config.mixture ? "m = 1: masses are taken as they are given" : "m = 1"},
          {"energy", "kT = 1"},
          {"time", "l sqrt(m/kT)"},
          {"D_trans", "slope of the MSD / 6"},
          {"D_rot", "slope of <|integral of omega dt|^2> " + rotation_divisor(config) + ", world frame"},
          {"D_rot_body", "the same with the components along the body's axes accumulated"},
          {"collision_rate", "collisions a body takes part in, a time unit"},
          {"pressure_tensor", "P V / (N kT), of trace 3 Z"},
          {"director", "eigenvector of Q of its largest eigenvalue; the error in radians"},
          {"wave_numbers", "of F_self, 1/l; tau_F, beta_F, t_F_1overe are of the first"},
          {"fit_windows", "from and to, l sqrt(m/kT)"},
          {"momentum_drift", config.mixture ? "|P_end - P_start| / (N sqrt(m kT)), m the mean mass"
                                            : "|P_end - P_start| / (N sqrt(m kT))"}};
}

Json counters(const ed::Counters& c) {
  return {{"collisions", c.collisions},
          {"predictions", c.predictions},
          {"evaluations", c.evaluations},
          {"refinements", c.refinements},
          {"rescues", c.rescues},
          {"neighbour_rebuilds", c.neighbour_rebuilds},
          {"overlaps", c.overlaps},
          {"declined", c.declined},
          {"cold_restarts", c.cold_restarts},
          {"envelope_checks", c.envelope_checks},
          {"kernel_calls", c.kernel_calls},
          {"candidate_tests", c.candidate_tests},
          {"parting_contacts", c.parting_contacts}};
}

Json axes(const std::array<ed::Estimate, 3>& estimates, const MissingWords& words) {
  return {estimate_json(estimates[0], words), estimate_json(estimates[1], words), estimate_json(estimates[2], words)};
}

Json matrix_json(const Eigen::Matrix3d& m) {
  Json rows = Json::array();
  for (int i = 0; i < 3; ++i) rows.push_back({number_json(m(i, 0)), number_json(m(i, 1)), number_json(m(i, 2))});
  return rows;
}

/// Director with S, whose reason it has where it is missing.
Json director(const ed::Director& d, const ed::Estimate& S, const MissingWords& words) {
  if (!d.axis.allFinite()) return estimate_json(ed::Estimate::none(S.missing), words);
  return {{"value", list_json(d.axis)}, {"error", number_json(d.error)}};
}

/// Pressure tensor with Z, whose reason it has where it is missing.
Json pressure(const ed::TensorEstimate& P, const ed::Estimate& Z, const MissingWords& words) {
  if (!P.value.allFinite()) return estimate_json(ed::Estimate::none(Z.missing), words);
  return {{"value", matrix_json(P.value)}, {"error", matrix_json(P.error)}};
}

Json window(const ed::FitWindow& w) {
  return std::isfinite(w.from) ? Json{w.from, w.to} : Json(nullptr);
}

/// The lags that fits have used.
Json fit_windows(const ed::Correlations& r) {
  return {{"D", window(r.window_D)}, {"C2", window(r.window_C2)}, {"F", window(r.window_F)}};
}

/// Of bodies without an axis of revolution: about body x, y, z.
void add_axes(Json& json, const ed::GroupResults& r, const MissingWords& words) {
  json["kT_axes"] = axes(r.axis_kT, words);
  json["D_rot_axes"] = axes(r.D_rot_axis, words);
  json["t_C2_1overe_axes"] = axes(r.t_C2_1overe_axis, words);
}

/// What is measured of all bodies and of those of a species alike.
template <class Measured>
void add_measured(Json& json, const Measured& r, const MissingWords& words) {
  json["D_trans"] = estimate_json(r.D_trans, words);
  json["D_rot"] = estimate_json(r.D_rot, words);
  json["D_rot_body"] = estimate_json(r.D_rot_body, words);
  json["S"] = estimate_json(r.S, words);
  json["director"] = director(r.director, r.S, words);
  add_decays_json(json, r, words);
  json["kT_trans"] = estimate_json(r.translational_kT, words);
  json["kT_rot"] = estimate_json(r.rotational_kT, words);
}

Json observables(const ed::Results& r, const Config& config, const MissingWords& words) {
  Json json = {{"collision_rate", estimate_json(r.collision_rate, words)},
               {"Z", estimate_json(r.Z, words)},
               {"pressure_tensor", pressure(r.pressure, r.Z, words)}};
  add_measured(json, r, words);
  if (!config.mixture && !config.all_of_revolution())
    add_axes(json, r.groups.empty() ? ed::GroupResults{} : r.groups[0], words);
  return json;
}

/// Of one species of a mixture.
Json observables(const ed::GroupResults& r, const SpeciesConfig& species, const MissingWords& words) {
  Json json = {{"collision_rate", estimate_json(r.collision_rate, words)}};
  add_measured(json, r, words);
  if (species.rotation_axes() == 3) add_axes(json, r, words);
  return json;
}

/// kind, aspect_ratio, semi_axes, exponents of a body of nominal size.
void add_shape(Json& json, const SpeciesConfig& species) {
  const std::optional<double> ratio = species.shape.true_aspect_ratio();
  json["kind"] = to_string(species.shape.kind);
  json["aspect_ratio"] = ratio ? Json(*ratio) : Json(nullptr);
  if (const auto* s = std::get_if<geom::Superellipsoid>(&species.body.shape)) {
    json["semi_axes"] = list_json(s->semi_axes());
    json["exponents"] = {s->e1(), s->e2()};
  } else {
    json["semi_axes"] = list_json(std::get<geom::Ellipsoid>(species.body.shape).semi_axes());
    json["exponents"] = nullptr;
  }
}

Json state(const Config& config) {
  Json json = {{"number", config.number}, {"packing_fraction", config.packing_fraction}};
  if (config.mixture) {
    for (const char* key : {"kind", "aspect_ratio", "semi_axes", "exponents"}) json[key] = nullptr;
    json["kind"] = "mixture";
  } else {
    add_shape(json, config.species[0]);
  }
  return json;
}

/// What was drawn; null for bodies of one size.
Json sizes(const SpeciesConfig& species) {
  if (species.factors.empty()) return nullptr;
  const SizeStatistics drawn = statistics_of(species.factors);
  return {{"distribution", ed::to_string(*species.sizes)}, {"width", species.width},     {"mean", drawn.mean},
          {"standard_deviation", drawn.deviation},         {"smallest", drawn.smallest}, {"largest", drawn.largest}};
}

Json species_list(const Config& config, const ed::Results& results, const MissingWords& words) {
  Json all = Json::array();
  for (std::size_t k = 0; k < config.species.size(); ++k) {
    const SpeciesConfig& species = config.species[k];
    Json json = {{"number", species.number}};
    add_shape(json, species);
    json["mass"] = species.body.mass;
    json["inertia"] = list_json(species.body.inertia);
    json["spins"] = species.body.spins;
    json["sizes"] = sizes(species);
    const ed::GroupResults group = k < results.groups.size() ? results.groups[k] : ed::GroupResults{};
    json["observables"] = observables(group, species, words);
    json["fit_windows"] = fit_windows(group);
    all.push_back(std::move(json));
  }
  return all;
}

Json equilibration(const ed::Relaxation& r) {
  return {{"relaxations", r.relaxations},
          {"relaxation_time", number_json(r.relaxation_time)},
          {"C2", number_json(r.c2)},
          {"F_self", number_json(r.f_self)},
          {"q", number_json(r.q)},
          {"Z_change", number_json(r.Z_change)},
          {"S_change", number_json(r.S_change)}};
}

Json performance(const RunRecord& record) {
  const Production& p = record.production;
  const double rate = static_cast<double>(p.counters.collisions) / p.wall_seconds;
  return {{"collisions_per_second", number_json(rate)},   {"wall_seconds", p.wall_seconds},
          {"total_wall_seconds", record.upkeep.seconds},  {"resumed", record.upkeep.resumed},
          {"checkpoints", record.upkeep.checkpoints},     {"checkpoints_failed", record.upkeep.checkpoints_failed},
          {"peak_memory_bytes", record.peak_memory_bytes}};
}

}  // namespace

std::string summary_json(const RunRecord& record) {
  const Config& config = record.config;
  const Production& production = record.production;
  const MissingWords words = missing_words(record);
  Json json;
  json["version"] = version();
  json["seed"] = config.seed;
  json["state"] = state(config);
  json["time"] = {{"equilibration", record.equilibration.time}, {"production", production.time}};
  json["counters"] = counters(production.counters);
  json["counters_of_start"] = counters(record.equilibration.counters_of_start);
  json["counters_of_tuning"] = counters(record.equilibration.counters_of_tuning);
  json["counters_of_equilibration"] = counters(record.equilibration.counters);
  json["performance"] = performance(record);
  json["audit"] = {{"minimum_distance", number_json(record.audit.minimum_distance)},
                   {"energy_relative_drift", number_json(record.energy_relative_drift)},
                   {"momentum_drift", number_json(record.momentum_drift)}};
  json["observables"] = observables(production.results, config, words);
  json["fit_windows"] = fit_windows(production.results);
  json["wave_numbers"] = production.wave_numbers;
  if (config.mixture) json["species"] = species_list(config, production.results, words);
  json["equilibrated"] = record.equilibration.reached();
  json["equilibration"] = equilibration(record.equilibration.relaxation);
  if (config.target_error) {
    json["target_error"] = {{"asked", *config.target_error}, {"reached", production.precise}};
  }
  json["interrupted"] = record.stopped();
  json["stalled"] = record.stall ? Json(ed::describe(*record.stall)) : Json(nullptr);
  json["failures"] = {{"recorded", record.equilibration.failures_of_start.size() +
                                       record.equilibration.failures.size() + record.production.failures.size()},
                      {"left_out", record.failures_left_out()}};
  json["sound"] = defects(record).empty();
  json["finder"] = {
      {"kind", ed::to_string(config.finder)}, {"distance", ed::to_string(config.distance)}, {"eps_d", config.eps_d}};
  json["neighbours"] = {{"kind", ed::to_string(config.neighbour_search())}, {"envelope", production.envelope}};
  json["cpu_features"] = cpu_features();
  json["units"] = units(config);
  return json.dump(2) + "\n";
}

}  // namespace hardbody
