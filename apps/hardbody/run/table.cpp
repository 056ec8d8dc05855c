#include "run/table.h"

#include "base/shapes.h"
#include "base/version.h"
#include "config/shape_forms.h"
#include "registry/observables.h"
#include "run/equilibrated.h"
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
std::string number_line(const std::string& name, const ed::Estimate& value, const std::string& unit,
                        const std::string& remark) {
  if (!std::isfinite(value.value)) return fmt::format("  {:<15} - ({})\n", name, ed::describe(value.missing));
  return fmt::format("  {:<15} {:<22} {:<14} {}\n", name, format_estimate(value), unit, remark);
}

/// Lines of all observables of a part; of spheres none that is about orientation.
std::string observable_lines(const Part& part) {
  std::string text;
  for (const Observable* o : observables_by(&Places::reading)) {
    const std::string remark = o->remark ? o->remark(part) : "";
    if (remark.empty() || (part.spheres && o->of_orientation)) continue;
    if (is_per_axis(*o) && !has_axes(*o, part)) continue;
    if (const auto* director = std::get_if<ed::Director ed::GroupResults::*>(&o->value)) {
      text += fmt::format("  {:<15} {:<37} {}\n", o->label, format_director(part.results.**director), remark);
    }
    const std::vector<ed::Estimate> numbers = numbers_of(*o, part);
    for (std::size_t k = 0; k < numbers.size(); ++k) text += number_line(label_of(*o, k), numbers[k], o->unit, remark);
  }
  return text;
}

std::string axes_text(const ed::BodyShape& shape) {
  const Eigen::Vector3d axes = ed::half_extents(shape);
  return fmt::format("semi-axes {:.5g}, {:.5g}, {:.5g}", axes.x(), axes.y(), axes.z());
}

/// "hard ellipsoids, X0 = 3 (semi-axes ..)"
std::string bodies_text(const SpeciesConfig& species) {
  const ed::BodyShape& shape = species.body.shape;
  const ShapeKind kind = species.shape.kind;
  const ShapeForm& form = form_of(kind);
  if (form.title != nullptr) return fmt::format("hard {} ({})", form.title(species.shape), form.lengths(shape));
  if (has_exponents(kind)) {
    const Eigen::Vector2d& e = species.shape.exponents;
    return fmt::format("hard {}s ({}, exponents {:g}, {:g})", to_string(kind), axes_text(shape), e.x(), e.y());
  }
  const std::optional<double> ratio = species.shape.true_aspect_ratio();
  if (ratio) return fmt::format("hard {}s, X0 = {:g} ({})", to_string(kind), *ratio, axes_text(shape));
  return fmt::format("hard {}s ({})", to_string(kind), axes_text(shape));
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
  text += fmt::format("time: equilibration {:g}, production {:g}{}\n", record.equilibration.time,
                      record.production.time, record.stopped() ? " (stopped early)" : "");
  if (config.mixture) {
    return text + "units: kT = 1, lengths and masses as given in [[species]], time l sqrt(m/kT)\n";
  }
  const char* length = has_semi_axes(config.species[0].shape.kind) ? "(abc)^(1/3) of the semi-axes"
                                                                   : "radius of the sphere of the body's volume";
  return text + fmt::format("units: kT = m = 1, length l = {}, time l sqrt(m/kT)\n", length);
}

/// The lines of each species, if there are several.
std::string species_numbers(const RunRecord& record) {
  std::string text;
  const std::vector<ed::GroupResults>& groups = record.production.results.groups;
  if (groups.size() < 2) return text;
  for (std::size_t k = 0; k < groups.size(); ++k) {
    text += '\n';
    text += species_text(record.config.species[k], k) + observable_lines(part_of_species(record, k, groups[k]));
  }
  return text;
}

/// Advice where values are missing because lags are too short; empty where none is.
std::string longer_lags_line(const RunRecord& record) {
  const std::vector<ed::GroupResults>& groups = record.production.results.groups;
  bool help = longer_lags_help(part_of_all(record));
  for (std::size_t k = 0; k < groups.size(); ++k) {
    help = help || longer_lags_help(part_of_species(record, k, groups[k]));
  }
  return help ? fmt::format("  (longer lags: {})\n", missing_words(record).longer_lags) : "";
}

std::string numbers(const RunRecord& record) {
  return observable_lines(part_of_all(record)) + species_numbers(record) + "  (+- one standard error, from blocks)\n" +
         longer_lags_line(record);
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

std::string format_director(const ed::Director& director) {
  const Eigen::Vector3d& n = director.axis;
  const int decimals = director.error > 0 ? std::max(decimals_of(director.error), 3) : 4;
  const std::string axis =
      fmt::format("({:.{}f}, {:.{}f}, {:.{}f})", n.x(), decimals, n.y(), decimals, n.z(), decimals);
  if (!std::isfinite(director.error)) return axis + " (no error)";
  return axis + fmt::format(" +- {:.{}f}", director.error, decimals);
}

std::string results_table(const RunRecord& record, const std::vector<std::string>& files) {
  std::string text = head(record) + "\n" + numbers(record) + "\n" + audit_lines(record);
  if (!record.equilibration.reached()) {
    text += fmt::format("  *** NOT EQUILIBRATED: {}; averages may still drift ***\n",
                        why_not_equilibrated(record.equilibration.relaxation));
  }
  for (const std::string& defect : defects(record)) text += fmt::format("  *** NOT SOUND: {} ***\n", defect);
  if (!files.empty()) text += fmt::format("\nfiles: {}\n", fmt::join(files, ", "));
  return text;
}

}  // namespace hardbody
