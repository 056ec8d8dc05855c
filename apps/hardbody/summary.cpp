#include "summary.h"

#include "version.h"

#include <nlohmann/json.hpp>

#include <cmath>

namespace hardbody {
namespace {

using Json = nlohmann::ordered_json;

Json number(double x) {
  return std::isfinite(x) ? Json(x) : Json(nullptr);
}

Json estimate(const ed::Estimate& e) {
  return {{"value", number(e.value)}, {"error", number(e.error)}};
}

Json list(const Eigen::Vector3d& v) {
  return {v.x(), v.y(), v.z()};
}

Json units() {
  return {{"length", "l = (a b c)^(1/3) of the semi-axes = 1"},
          {"mass", "m = 1"},
          {"energy", "kT = 1"},
          {"time", "l sqrt(m/kT)"},
          {"D_trans", "slope of the MSD / 6"},
          {"D_rot", "slope of <|integral of omega dt|^2> / 4, two components, spin excluded, world frame"},
          {"D_rot_body", "the same with the components along the body's axes accumulated"},
          {"collision_rate", "collisions a body takes part in, a time unit"},
          {"momentum_drift", "|P_end - P_start| / (N sqrt(m kT))"}};
}

Json counters(const ed::Counters& c) {
  return {{"collisions", c.collisions},
          {"predictions", c.predictions},
          {"evaluations", c.evaluations},
          {"refinements", c.refinements},
          {"rescues", c.rescues},
          {"neighbour_rebuilds", c.neighbour_rebuilds},
          {"overlaps", c.overlaps},
          {"cold_restarts", c.cold_restarts},
          {"envelope_checks", c.envelope_checks},
          {"kernel_calls", c.kernel_calls},
          {"candidate_tests", c.candidate_tests}};
}

Json observables(const ed::Results& r) {
  return {{"collision_rate", estimate(r.collision_rate)},
          {"Z", estimate(r.Z)},
          {"D_trans", estimate(r.D_trans)},
          {"D_rot", estimate(r.D_rot)},
          {"D_rot_body", estimate(r.D_rot_body)},
          {"S", estimate(r.S)},
          {"tau_C2", estimate(r.tau_C2)},
          {"beta_C2", estimate(r.beta_C2)},
          {"t_C2_1overe", estimate(r.t_C2_1overe)},
          {"kT_trans", estimate(r.translational_kT)},
          {"kT_rot", estimate(r.rotational_kT)}};
}

Json performance(const RunRecord& record) {
  const Production& p = record.production;
  const double rate = static_cast<double>(p.counters.collisions) / p.wall_seconds;
  return {{"collisions_per_second", number(rate)},
          {"wall_seconds", p.wall_seconds},
          {"total_wall_seconds", record.total_seconds},
          {"peak_memory_bytes", record.peak_memory_bytes}};
}

}  // namespace

std::string summary_json(const RunRecord& record) {
  const Config& config = record.config;
  const Production& production = record.production;
  Json json;
  json["version"] = version();
  json["seed"] = config.seed;
  json["state"] = {{"number", config.number},
                   {"packing_fraction", config.packing_fraction},
                   {"kind", "ellipsoid"},
                   {"aspect_ratio", config.true_aspect_ratio()},
                   {"semi_axes", list(config.species.shape.semi_axes())},
                   {"exponents", nullptr}};
  json["time"] = {{"equilibration", record.equilibration.time}, {"production", production.time}};
  json["counters"] = counters(production.counters);
  json["performance"] = performance(record);
  json["audit"] = {{"minimum_distance", number(record.audit.minimum_distance)},
                   {"energy_relative_drift", number(record.energy_relative_drift)},
                   {"momentum_drift", number(record.momentum_drift)}};
  json["observables"] = observables(production.results);
  json["equilibrated"] = record.equilibration.reached(config);
  json["interrupted"] = record.stopped();
  json["failures"] = {{"recorded", record.equilibration.failures.size() + record.production.failures.size()},
                      {"left_out", record.failures_left_out()}};
  json["sound"] = defects(record).empty();
  json["finder"] = {{"kind", config.finder}, {"distance", config.distance}, {"eps_d", config.eps_d}};
  json["neighbours"] = {{"kind", config.neighbours}, {"envelope", production.envelope}};
  json["cpu_features"] = cpu_features();
  json["units"] = units();
  return json.dump(2) + "\n";
}

}  // namespace hardbody
