#include "run/summary.h"

#include "base/shapes.h"
#include "base/version.h"
#include "io/json_shape.h"
#include "io/json_values.h"
#include "io/text_file.h"
#include "run/equilibrated.h"
#include "run/observables_json.h"

#include <nlohmann/json.hpp>

#include <cmath>
#include <optional>
#include <string>
#include <utility>

namespace hardbody {
namespace {

using Json = nlohmann::ordered_json;

const char* unit_of_length(const Config& config) {
  if (config.mixture) return "l = 1: lengths are taken as they are given";
  return has_semi_axes(config.species[0].shape.kind) ? "l = (a b c)^(1/3) of the semi-axes = 1"
                                                     : "l = radius of the sphere of the body's volume = 1";
}

Json units(const Config& config, const Part& part) {
  Json json = {{"length", unit_of_length(config)},
               {"mass", config.mixture ? "m = 1: masses are taken as they are given" : "m = 1"},
               {"energy", "kT = 1"},
               {"time", "l sqrt(m/kT)"}};
  for (const Observable* o : observables_by(&Places::units)) json[o->key] = o->convention(part);
  json["wave_numbers"] = "of F_self, 1/l; tau_F, beta_F, t_F_1overe are of the first";
  json["fit_windows"] = "from and to, l sqrt(m/kT)";
  json["van_hove_lags"] = "of the columns of van_hove.csv, l sqrt(m/kT)";
  json["momentum_drift"] =
      config.mixture ? "|P_end - P_start| / (N sqrt(m kT)), m the mean mass" : "|P_end - P_start| / (N sqrt(m kT))";
  return json;
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

Json window(const ed::FitWindow& w) {
  return std::isfinite(w.from) ? Json{w.from, w.to} : Json(nullptr);
}

/// The lags that fits have used.
Json fit_windows(const ed::Correlations& r) {
  return {{"D", window(r.window_D)}, {"C2", window(r.window_C2)}, {"F", window(r.window_F)}};
}

/// Adds kind, aspect_ratio, semi_axes, exponents of a body of nominal size, and the shape where these do not tell it.
void add_shape(Json& json, const SpeciesConfig& species) {
  const std::optional<double> ratio = species.shape.true_aspect_ratio();
  json["kind"] = to_string(species.shape.kind);
  json["aspect_ratio"] = ratio ? Json(*ratio) : Json(nullptr);
  const ShapeNumbers numbers = numbers_of(species.body.shape);
  const Eigen::Vector2d& e = numbers.exponents;
  const bool axes = has_semi_axes(numbers.kind) || numbers.kind == ShapeKind::sphere;
  json["semi_axes"] = axes ? list_json(numbers.lengths) : Json(nullptr);
  json["exponents"] = has_exponents(numbers.kind) ? Json{e.x(), e.y()} : Json(nullptr);
  if (!has_semi_axes(numbers.kind)) json["shape"] = shape_json(species.body.shape);
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

/// Describes the file that the run started from; null for other starts.
Json start(const RunRecord& record) {
  const std::optional<StartFile>& file = record.config.start_file;
  if (!file) return nullptr;
  const double before = record.equilibration.packing_of_file;
  return {{"file", file->file},
          {"frame", file->frame ? Json(*file->frame) : Json(nullptr)},
          {"packing_fraction", before},
          {"compressed", before != record.config.packing_fraction}};
}

/// Describes the sizes that were drawn; null for bodies of one size.
Json sizes(const SpeciesConfig& species) {
  if (species.factors.empty()) return nullptr;
  const SizeStatistics drawn = statistics_of(species.factors);
  return {{"distribution", ed::to_string(*species.sizes)}, {"width", species.width},     {"mean", drawn.mean},
          {"standard_deviation", drawn.deviation},         {"smallest", drawn.smallest}, {"largest", drawn.largest}};
}

Json species_list(const RunRecord& record, const MissingWords& words) {
  const Config& config = record.config;
  const ed::Results& results = record.production.results;
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
    json["observables"] = observables_json(part_of_species(record, k, group), words, Source::run);
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
          {"S_change", number_json(r.S_change)},
          {"order",
           {{"S", number_json(r.order.S)},
            {"S_octants", number_json(r.order.S_octants)},
            {"bragg", number_json(r.order.bragg)},
            {"Z_change", number_json(r.order.Z_change)},
            {"S_change", number_json(r.order.S_change)},
            {"bragg_change", number_json(r.order.bragg_change)}}}};
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
  const Part whole = part_of_all(record);
  Json json;
  json["version"] = version();
  json["seed"] = config.seed;
  json["state"] = state(config);
  json["start"] = start(record);
  json["time"] = {{"equilibration", record.equilibration.time}, {"production", production.time}};
  json["counters"] = counters(production.counters);
  json["counters_of_start"] = counters(record.equilibration.counters_of_start);
  json["counters_of_tuning"] = counters(record.equilibration.counters_of_tuning);
  json["counters_of_equilibration"] = counters(record.equilibration.counters);
  json["performance"] = performance(record);
  json["audit"] = {{"minimum_distance", number_json(record.audit.minimum_distance)},
                   {"energy_relative_drift", number_json(record.energy_relative_drift)},
                   {"momentum_drift", number_json(record.momentum_drift)}};
  json["observables"] = observables_json(whole, words, Source::run);
  json["fit_windows"] = fit_windows(production.results);
  json["wave_numbers"] = production.wave_numbers;
  json["collective"] = config.collective;
  json["van_hove_lags"] = production.results.displacement_lags;
  if (config.bonds().steinhardt) json["order_neighbours"] = config.order_neighbours;
  if (config.mixture) json["species"] = species_list(record, words);
  json["equilibrated"] = record.equilibration.reached();
  const ed::EquilibratedBy by = record.equilibration.relaxation.by;
  json["equilibrated_by"] = by == ed::EquilibratedBy::nothing ? Json(nullptr) : Json(to_string(by));
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
  json["units"] = units(config, whole);
  return json.dump(2) + "\n";
}

nlohmann::json stored_summary(const RunDirectory& directory) {
  if (!directory.has(kSummaryFile)) return nullptr;
  const std::string text = read_file(directory.file(kSummaryFile), kLongestSummary);
  nlohmann::json summary = nlohmann::json::parse(text, nullptr, /*allow_exceptions=*/false);
  return summary.is_object() ? summary : nlohmann::json(nullptr);
}

}  // namespace hardbody
