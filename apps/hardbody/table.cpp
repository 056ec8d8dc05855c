#include "table.h"

#include "run_directory.h"
#include "version.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

namespace hardbody {
namespace {

/// An error below this share of the value is rounding: the quantity did not fluctuate.
constexpr double kExact = 1e-10;

/// Decimals that show two significant digits of the error.
int decimals_of(double error) {
  return std::clamp(1 - static_cast<int>(std::floor(std::log10(error))), 0, 12);
}

struct Row {
  const char* name;
  ed::Estimate ed::Results::*value;
  const char* unit;
  const char* meaning;
};

constexpr std::array kRows = {
    Row{"collision rate", &ed::Results::collision_rate, "sqrt(kT/m)/l", "collisions of a body in a time unit"},
    Row{"Z", &ed::Results::Z, "1", "P V / (N kT)"},
    Row{"D_trans", &ed::Results::D_trans, "l sqrt(kT/m)", "MSD / 6t"},
    Row{"D_rot", &ed::Results::D_rot, "sqrt(kT/m)/l", "<|integral of omega|^2> / 4t: 2 components, world frame"},
    Row{"D_rot_body", &ed::Results::D_rot_body, "sqrt(kT/m)/l", "the same, components along the body's axes"},
    Row{"t_C2(1/e)", &ed::Results::t_C2_1overe, "l sqrt(m/kT)", "<P2(u(t).u(0))> = 1/e"},
    Row{"tau_C2", &ed::Results::tau_C2, "l sqrt(m/kT)", "of A exp[-(t/tau)^beta]"},
    Row{"beta_C2", &ed::Results::beta_C2, "1", "of the same"},
    Row{"S", &ed::Results::S, "1", "nematic order: largest eigenvalue of Q, by frame"},
    Row{"kT_trans", &ed::Results::translational_kT, "kT", "on 3N - 3 degrees of freedom"},
    Row{"kT_rot", &ed::Results::rotational_kT, "kT", "on 2N"},
};

std::string head(const RunRecord& record) {
  const Config& config = record.config;
  const Eigen::Vector3d& axes = config.species.shape.semi_axes();
  std::string text = fmt::format(
      "hardbody {}: {} hard ellipsoids, X0 = {:g} (semi-axes {:.5g}, {:.5g}, {:.5g}), packing "
      "fraction {:g}, seed {}\n",
      version(), config.number, config.true_aspect_ratio(), axes.x(), axes.y(), axes.z(), config.packing_fraction,
      config.seed);
  text += fmt::format("time: equilibration {:g}{}, production {:g}{}\n", record.equilibration.time,
                      record.equilibration.reached(config) ? "" : " (C2 < 0.05 and MSD > 1 not reached)",
                      record.production.time, record.stopped() ? " (stopped early)" : "");
  return text + "units: kT = m = 1, length l = (abc)^(1/3) of the semi-axes, time l sqrt(m/kT)\n";
}

std::string numbers(const RunRecord& record) {
  std::string text;
  for (const Row& row : kRows) {
    text += fmt::format("  {:<15} {:<22} {:<14} {}\n", row.name, format_estimate(record.production.results.*row.value),
                        row.unit, row.meaning);
  }
  return text + "  (+- one standard error, from blocks; -: the run is too short for it)\n";
}

/// Empty for a run without rescues.
std::string rescue_line(const RunRecord& record) {
  const std::uint64_t rescues = record.production.counters.rescues;
  if (rescues == 0) return "";
  return fmt::format("  rescues {}: {}\n", rescues,
                     record.config.finder == "bracketing"
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
  const std::uint64_t overlaps =
      record.equilibration.counters.overlaps + p.counters.overlaps + static_cast<std::uint64_t>(record.audit.overlaps);
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

std::string results_table(const RunRecord& record, const std::string& directory) {
  std::string text = head(record) + "\n" + numbers(record) + "\n" + audit_lines(record);
  for (const std::string& defect : defects(record)) text += fmt::format("  *** NOT SOUND: {} ***\n", defect);
  text += fmt::format("\nfiles: {0}/{1}, {0}/observables/*.csv, {0}/{2}{3}\n", directory, kSummaryFile, kCheckpointFile,
                      record.config.events > 0 ? fmt::format(", {}/{}", directory, kEventsFile) : "");
  return text;
}

}  // namespace hardbody
