#include "make_start.h"

#include "frame.h"
#include "origin.h"
#include "signals.h"
#include "start_file.h"

#include <ed/shape.h>
#include <ed/start.h>

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <functional>
#include <limits>
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
  options.progress = progress;
  options.counters = &start.counters;
  options.failures = &start.failures;
  return options;
}

/// Bodies in a cell as wide as the largest one, from which on a run is said to be slow: neighbours are sought in cells.
constexpr double kCrowdedCell = 100;

/// What sizes that differ by much cost; nothing where they do not.
std::optional<std::string> unequal_sizes(const Config& config) {
  const std::vector<ed::Component> components = config.components();
  double largest = 0;
  double smallest = std::numeric_limits<double>::infinity();
  for (const ed::Component& component : components) {
    const double radius = ed::bounding_radius(component.species.shape);
    largest = std::max(largest, radius);
    smallest = std::min(smallest, radius);
  }
  const double box = ed::box_for(components, config.packing_fraction);
  const double in_a_cell = config.number * std::pow(2 * largest / box, 3);
  if (in_a_cell < kCrowdedCell || largest < 2 * smallest) return std::nullopt;
  return fmt::format(
      "start: the largest bodies have {:.3g} times the bounding radius of the smallest, and a cell as wide as they are "
      "holds {:.0f} bodies, among which neighbours are sought; expect a slow start and run",
      largest / smallest, std::min(in_a_cell, static_cast<double>(config.number)));
}

std::string reached_order(const Config& config, const ed::System& start) {
  return config.nematic_order ? fmt::format(", S = {:.3g}", frame_of(start, {start.size()}).S) : "";
}

/// Random, or the last state of another run; nothing if a signal came first.
std::optional<Start> compressed_start(const Config& config, Progress& progress, Log& log) {
  log.line(config.start_from ? fmt::format("start: the last state of {}, compressed to packing fraction {:g}",
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
    if (config.start_from) {
      start.system =
          ed::compressed(read_origin_state(config), config.packing_fraction, show, &start.counters, &start.failures);
    } else {
      start.system = ed::random_start(config.components(), start_options(config, show, start));
    }
    if (pending_signal() != 0) return std::nullopt;
    log.line(
        fmt::format("start: done, {} collisions{}", start.counters.collisions, reached_order(config, start.system)));
    return start;
  } catch (const std::runtime_error&) {
    if (pending_signal() != 0) return std::nullopt;
    throw;
  }
}

}  // namespace

std::optional<Start> make_start(const Config& config, Progress& progress, Log& log) {
  if (config.start_file) {
    FileStart start = start_from_file(config);
    log.line(start.report);
    progress.say(start.report);
    return Start{std::move(start.system), {}, {}};
  }
  if (const std::optional<std::string> warning = unequal_sizes(config)) {
    log.line(*warning);
    progress.say(*warning);
  }
  const std::optional<ed::LatticeOptions> lattice = config.lattice();
  if (!lattice) return compressed_start(config, progress, log);
  log.line(fmt::format("start: {} bodies on a lattice ({}) at packing fraction {:g}{}", config.number, config.start,
                       config.packing_fraction, order_text(config)));
  Start start{ed::lattice_start(config.components(), *lattice), {}, {}};
  log.line("start: done");
  return start;
}

}  // namespace hardbody
