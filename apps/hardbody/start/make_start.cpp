#include "start/make_start.h"

#include "base/signals.h"

#include <ed/shape.h>
#include <ed/start.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

std::string order_text(const Config& config) {
  return config.nematic_order ? fmt::format(", S = {:g} about z", *config.nematic_order) : "";
}

ed::StartOptions start_options(const Config& config, const std::function<bool(double)>& progress, Start& start) {
  ed::StartOptions options;
  options.packing_fraction = config.packing_fraction;
  options.seed = static_cast<std::uint64_t>(config.seed);
  options.nematic_order = config.nematic_order;
  options.groups = config.numbers();
  options.progress = progress;
  options.counters = &start.counters;
  options.failures = &start.failures;
  return options;
}

/// Describes the cost of a start that cannot be repeated; nullopt if it is small.
std::optional<std::string> compressed_as_one(const Config& config) {
  if (config.start_from || config.lattice()) return std::nullopt;
  ed::StartOptions options;
  options.packing_fraction = config.packing_fraction;
  const int together = ed::compressed_together(config.components(), options);
  if (together <= options.most_compressed) return std::nullopt;
  return fmt::format(
      "start: {} of {} bodies are compressed together, because too few are alike to repeat a smaller box; the time "
      "grows with the square of their number",
      together, config.number);
}

/// Returns <P2(u_z)> of the bodies that are not spheres.
double order_about_z(const ed::System& system) {
  double sum = 0;
  int number = 0;
  for (int i = 0; i < system.size(); ++i) {
    const ed::Species& species = system.species_of(i);
    if (ed::is_sphere(species.shape)) continue;
    const double z = system.bodies[static_cast<std::size_t>(i)].rotation(2, ed::symmetry_axis(species).value_or(2));
    sum += 1.5 * z * z - 0.5;
    ++number;
  }
  return number > 0 ? sum / number : 0;
}

/// Logs how much of the requested order the compression has left; a loss is also printed.
void report_order(double asked, const ed::System& start, Progress& progress, Log& log) {
  const double reached = order_about_z(start);
  log.line(fmt::format("start: S = {:.3g}", reached));
  // Deviation that samples of this size hardly ever exceed.
  const double usual = std::max(0.05, 1.5 / std::sqrt(start.size()));
  if (std::abs(reached - asked) <= usual) return;
  announce(
      fmt::format("start: S = {:.2f} about z after the compression, not nematic_order = {:g}; start = \"fcc\" would "
                  "keep it",
                  reached, asked),
      progress, log);
}

/// Compresses a random start, the last state of another run or the state of a file; nullopt if a signal came first.
std::optional<Start> compressed_start(const Config& config, const std::optional<ed::System>& origin, Progress& progress,
                                      Log& log) {
  log.line(config.start_file   ? fmt::format("start: compressed to packing fraction {:g}", config.packing_fraction)
           : config.start_from ? fmt::format("start: the last state of {}, compressed to packing fraction {:g}",
                                             *config.start_from, config.packing_fraction)
                               : fmt::format("start: {} bodies placed at random{}, compressed to packing fraction {:g}",
                                             config.number, order_text(config), config.packing_fraction));
  progress.begin();
  const auto show = [&](double reached) {
    if (progress.due()) {
      progress.show(fmt::format("compression: packing fraction {:.4f} of {:g}", reached, config.packing_fraction));
    }
    return pending_signal() == 0;
  };
  try {
    Start start;
    if (origin) {
      start.system =
          ed::compressed(*origin, config.packing_fraction, show, &start.counters, &start.failures, config.numbers());
    } else {
      start.system = ed::random_start(config.components(), start_options(config, show, start));
    }
    if (pending_signal() != 0) return std::nullopt;
    log.line(fmt::format("start: done, {} collisions", start.counters.collisions));
    if (config.nematic_order) report_order(*config.nematic_order, start.system, progress, log);
    return start;
  } catch (const std::runtime_error&) {
    if (pending_signal() != 0) return std::nullopt;
    throw;
  }
}

}  // namespace

std::optional<Start> make_start(const Config& config, LoadedStates loaded, Progress& progress, Log& log) {
  if (config.start_file) {
    FileStart start = loaded.file ? std::move(*loaded.file) : start_from_file(config);
    announce(start.report, progress, log);
    for (const std::string& notice : start.notices) announce(notice, progress, log);
    if (!start.compress) return Start{std::move(start.system), {}, {}, start.packing_fraction};
    std::optional<Start> compressed = compressed_start(config, std::move(start.system), progress, log);
    if (compressed) compressed->packing_of_file = start.packing_fraction;
    return compressed;
  }
  if (const std::optional<std::string> cost = compressed_as_one(config)) announce(*cost, progress, log);
  const std::optional<ed::LatticeOptions> lattice = config.lattice();
  if (!lattice) return compressed_start(config, loaded.origin, progress, log);
  log.line(fmt::format("start: {} bodies on a lattice ({}) at packing fraction {:g}{}", config.number,
                       ed::to_string(*config.start), config.packing_fraction, order_text(config)));
  Start start{ed::lattice_start(config.components(), *lattice), {}, {}, 0};
  log.line("start: done");
  return start;
}

}  // namespace hardbody
