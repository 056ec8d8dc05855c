#include "run/table.h"

#include "base/version.h"
#include "io/run_directory.h"
#include "run/missing.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <cmath>
#include <optional>
#include <variant>

namespace hardbody {
namespace {

/// An error below this share of the value is rounding: the quantity did not fluctuate.
constexpr double kExact = 1e-10;

/// Decimals that show two significant digits of the error.
int decimals_of(double error) {
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, 12);
}

/// A line of the table; without a value, the reason.
std::string number_line(const std::string& name, const ed::Estimate& value, const char* unit,
                        const std::string& meaning) {
  if (!std::isfinite(value.value)) return fmt::format("  {:<15} - ({})\n", name, ed::describe(value.missing));
  return fmt::format("  {:<15} {:<22} {:<14} {}\n", name, format_estimate(value), unit, meaning);
}

/// How many components of its rotation D_rot counts, and what it divides by.
std::string rotation_text(double rotation_axes) {
  if (rotation_axes == 2) return "<|integral of omega|^2> / 4t: 2 components, world frame";
  if (rotation_axes == 3) return "<|integral of omega|^2> / 6t: 3 components, world frame";
  return fmt::format("<|integral of omega|^2> / {:.4g}t: {:.4g} components on average, world frame", 2 * rotation_axes,
                     rotation_axes);
}

/// What all bodies have, and each species; F_self is measured at `wave_numbers`.
std::string diffusion_lines(const ed::Correlations& r, double rotation_axes, const std::vector<double>& wave_numbers) {
  const std::string f_self =
      wave_numbers.empty() ? "F_self" : fmt::format("F_self(q, t) at q = {:.4g} / l", wave_numbers[0]);
  return number_line("D_trans", r.D_trans, "l sqrt(kT/m)", "MSD / 6t") +
         number_line("D_rot", r.D_rot, "sqrt(kT/m)/l", rotation_text(rotation_axes)) +
         number_line("D_rot_body", r.D_rot_body, "sqrt(kT/m)/l", "the same, components along the body's axes") +
         number_line("t_C2(1/e)", r.t_C2_1overe, "l sqrt(m/kT)",
                     rotation_axes == 2 ? "<P2(u(t).u(0))> = 1/e" : "<P2(u(t).u(0))> = 1/e, u body z") +
         number_line("tau_C2", r.tau_C2, "l sqrt(m/kT)", "of A exp[-(t/tau)^beta]") +
         number_line("beta_C2", r.beta_C2, "1", "of the same") +
         number_line("t_F(1/e)", r.t_F_1overe, "l sqrt(m/kT)", f_self + " = 1/e") +
         number_line("tau_F", r.tau_F, "l sqrt(m/kT)", "of A exp[-(t/tau)^beta]") +
         number_line("beta_F", r.beta_F, "1", "of the same");
}

/// About each body axis, of bodies without an axis of revolution.
std::string axis_lines(const ed::GroupResults& r) {
  std::string text;
  constexpr const char* kNames[] = {"x", "y", "z"};
  for (std::size_t k = 0; k < 3; ++k) {
    text += number_line(fmt::format("kT_rot about {}", kNames[k]), r.axis_kT[k], "kT", "on N: one body axis");
  }
  for (std::size_t k = 0; k < 3; ++k) {
    text += number_line(fmt::format("D_rot about {}", kNames[k]), r.D_rot_axis[k], "sqrt(kT/m)/l",
                        "that component / 2t, body axis");
  }
  for (std::size_t k = 0; k < 3; ++k) {
    text += number_line(fmt::format("t_C2(1/e) of {}", kNames[k]), r.t_C2_1overe_axis[k], "l sqrt(m/kT)",
                        "u that body axis");
  }
  return text;
}

std::string temperature_lines(const ed::Estimate& translation, const ed::Estimate& rotation, const char* translational,
                              const std::string& rotational) {
  return number_line("kT_trans", translation, "kT", translational) + number_line("kT_rot", rotation, "kT", rotational);
}

std::string axes_text(const ed::BodyShape& shape) {
  const Eigen::Vector3d axes = ed::half_extents(shape);
  return fmt::format("semi-axes {:.5g}, {:.5g}, {:.5g}", axes.x(), axes.y(), axes.z());
}

/// "hard ellipsoids, X0 = 3 (semi-axes ..)"
std::string bodies_text(const SpeciesConfig& species) {
  const ed::BodyShape& shape = species.body.shape;
  if (const auto* s = std::get_if<geom::Superellipsoid>(&shape)) {
    return fmt::format("hard superellipsoids ({}, exponents {:g}, {:g})", axes_text(shape), s->e1(), s->e2());
  }
  const std::optional<double> ratio = species.shape.true_aspect_ratio();
  if (ratio) return fmt::format("hard ellipsoids, X0 = {:g} ({})", *ratio, axes_text(shape));
  return fmt::format("hard ellipsoids ({})", axes_text(shape));
}

std::string species_text(const SpeciesConfig& species, std::size_t index) {
  std::string text =
      fmt::format("species {}: {} {}, mass {:g}", index + 1, species.number, bodies_text(species), species.mass);
  if (species.factors.empty()) return text + "\n";
  const SizeStatistics drawn = statistics_of(species.factors);
  return text + fmt::format("; sizes {}, drawn {:.4g} +- {:.2g}, {:.4g} to {:.4g}\n", ed::to_string(*species.sizes),
                            drawn.mean, drawn.deviation, drawn.smallest, drawn.largest);
}

std::string state_text(const Config& config) {
  const std::string rest = fmt::format("packing fraction {:g}, seed {}\n", config.packing_fraction, config.seed);
  if (!config.mixture) {
    return fmt::format("hardbody {}: {} {}, {}", version(), config.number, bodies_text(config.species[0]), rest);
  }
  std::string text = fmt::format("hardbody {}: {} hard bodies of {} species, {}", version(), config.number,
                                 config.species.size(), rest);
  for (std::size_t k = 0; k < config.species.size(); ++k) text += species_text(config.species[k], k);
  return text;
}

std::string head(const RunRecord& record) {
  const Config& config = record.config;
  std::string text = state_text(config);
  text += fmt::format(
      "time: equilibration {:g}{}, production {:g}{}\n", record.equilibration.time,
      record.equilibration.reached() ? "" : " (not equilibrated: C2 and F_self below 0.05 twice in a row not reached)",
      record.production.time, record.stopped() ? " (stopped early)" : "");
  return text + (config.mixture ? "units: kT = 1, lengths and masses as given in [[species]], time l sqrt(m/kT)\n"
                                : "units: kT = m = 1, length l = (abc)^(1/3) of the semi-axes, time l sqrt(m/kT)\n");
}

/// The lines of each species of a mixture.
std::string species_numbers(const RunRecord& record) {
  std::string text;
  const std::vector<ed::GroupResults>& groups = record.production.results.groups;
  if (!record.config.mixture) return text;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    const SpeciesConfig& species = record.config.species[k];
    const int axes = species.rotation_axes();
    text += '\n';
    text += species_text(species, k) + diffusion_lines(groups[k], axes, record.production.wave_numbers) +
            number_line("S", groups[k].S, "1", "nematic order of this species") +
            temperature_lines(groups[k].translational_kT, groups[k].rotational_kT,
                              "on its share of 3N - 3 degrees of freedom", axes == 2 ? "on 2 a body" : "on 3 a body");
    if (axes == 3) text += axis_lines(groups[k]);
  }
  return text;
}

/// Advice where values are missing because lags are too short; empty where none is.
std::string longer_lags_line(const RunRecord& record) {
  const ed::Results& r = record.production.results;
  const bool help = longer_lags_help(r) || std::any_of(r.groups.begin(), r.groups.end(),
                                                       [](const auto& group) { return longer_lags_help(group); });
  return help ? fmt::format("  (longer lags: {})\n", missing_words(record).longer_lags) : "";
}

std::string numbers(const RunRecord& record) {
  const ed::Results& r = record.production.results;
  const Config& config = record.config;
  double rotation_axes = 0;
  for (const SpeciesConfig& s : config.species) rotation_axes += s.rotation_axes() * s.number;
  std::string text =
      number_line("collision rate", r.collision_rate, "sqrt(kT/m)/l", "collisions of a body in a time unit") +
      number_line("Z", r.Z, "1", "P V / (N kT)") +
      diffusion_lines(r, rotation_axes / config.number, record.production.wave_numbers) +
      number_line("S", r.S, "1", "nematic order: largest eigenvalue of Q, by frame") +
      temperature_lines(r.translational_kT, r.rotational_kT, "on 3N - 3 degrees of freedom",
                        fmt::format("on {}", freedoms_text(std::lround(rotation_axes), config.number)));
  if (!config.mixture && !config.all_of_revolution() && !r.groups.empty()) text += axis_lines(r.groups[0]);
  return text + species_numbers(record) + "  (+- one standard error, from blocks)\n" + longer_lags_line(record);
}

/// Empty for a run without rescues.
std::string rescue_line(const RunRecord& record) {
  const std::uint64_t rescues = record.production.counters.rescues;
  if (rescues == 0) return "";
  return fmt::format("  rescues {}: {}\n", rescues,
                     record.config.finder == ed::Finder::bracketing
                         ? "distances that Newton's method declined and the dual answered; the first ones in failures/"
                         : "pairs whose normal the Perram-Wertheim fallback found, which is slower and as safe");
}

std::string audit_lines(const RunRecord& record) {
  const Production& p = record.production;
  std::string text = fmt::format(
      "  {} collisions in {:.1f} s: {:.0f} a second; {:.1f} gap evaluations and {:.2f} refinements a "
      "collision\n",
      p.counters.collisions, p.wall_seconds,
      p.wall_seconds > 0 ? static_cast<double>(p.counters.collisions) / p.wall_seconds : 0,
      static_cast<double>(p.counters.kernel_calls) / std::max(1.0, static_cast<double>(p.counters.collisions)),
      static_cast<double>(p.counters.refinements) / std::max(1.0, static_cast<double>(p.counters.collisions)));
  text += fmt::format("  energy drift {:.1e} (relative), momentum drift {:.1e} sqrt(m kT) a body\n",
                      record.energy_relative_drift, record.momentum_drift);
  const Equilibration& before = record.equilibration;
  const std::uint64_t overlaps = before.counters_of_start.overlaps + before.counters_of_tuning.overlaps +
                                 before.counters.overlaps + p.counters.overlaps +
                                 static_cast<std::uint64_t>(record.audit.overlaps);
  // The audit looks at pairs whose bounding spheres meet; without one its distance is not that of a pair.
  text += fmt::format("  minimum distance at the end {}, overlaps {}\n",
                      record.audit.closest_i < 0 ? std::string("not known: no two bounding spheres meet")
                                                 : fmt::format("{:.3g} l", record.audit.minimum_distance),
                      overlaps);
  return text + rescue_line(record);
}

}  // namespace

std::string freedoms_text(long freedoms, int number) {
  if (freedoms % number == 0) return fmt::format("{}N", freedoms / number);
  return fmt::format("{}", freedoms);
}

std::string format_estimate(const ed::Estimate& estimate) {
  if (!std::isfinite(estimate.value)) return "-";
  if (!std::isfinite(estimate.error)) return fmt::format("{:.5g} (no error)", estimate.value);
  if (estimate.error <= kExact * std::abs(estimate.value)) return fmt::format("{:.6g} +- 0", estimate.value);
  int decimals = decimals_of(estimate.error);
  // 0.0996 rounds to 0.100: one digit less then.
  decimals =
      std::min(decimals, decimals_of(std::round(estimate.error * std::pow(10, decimals)) / std::pow(10, decimals)));
  return fmt::format("{:.{}f} +- {:.{}f}", estimate.value, decimals, estimate.error, decimals);
}

std::string results_table(const RunRecord& record, const std::vector<std::string>& files) {
  std::string text = head(record) + "\n" + numbers(record) + "\n" + audit_lines(record);
  for (const std::string& defect : defects(record)) text += fmt::format("  *** NOT SOUND: {} ***\n", defect);
  if (!files.empty()) text += fmt::format("\nfiles: {}\n", fmt::join(files, ", "));
  return text;
}

}  // namespace hardbody
