#include "run/phases/runner.h"

#include "base/signals.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hardbody {
namespace {

/// Seconds between two looks at the clock and at signals.
constexpr double kLook = 0.1;

/// Collisions in the first slice of a phase: little work for the slowest finder, and it grows by kGrowth at most.
constexpr double kFirstSlice = 10;
constexpr double kGrowth = 4;
constexpr double kLongestSlice = 1e6;
/// Events in a slice for each of its collisions, at the most: some times what sound runs need. A run that stalls has
/// any number of them without a collision.
constexpr double kEventsOfACollision = 100;

}  // namespace

Runner::Runner(ed::Simulation& simulation, std::string phase, Progress& progress, Saver& saver,
               std::function<Checkpoint()> checkpoint, std::function<void()> keep_up)
    : simulation_(simulation),
      progress_(progress),
      saver_(saver),
      checkpoint_(std::move(checkpoint)),
      keep_up_(std::move(keep_up)),
      phase_(std::move(phase)),
      begin_(simulation.time()),
      slice_(kFirstSlice),
      collisions_(simulation.counters().collisions),
      energy_(simulation.kinetic().energy()) {}

bool Runner::run_to(double time, double planned_end) {
  while (pending_signal() == 0 && !simulation_.stall()) {
    const bool arrived = run_slice(time);
    if (keep_up_) keep_up_();
    if (progress_.due()) progress_.show(text(planned_end), (simulation_.time() - begin_) / (planned_end - begin_));
    if (saver_.due()) saver_.save(checkpoint_);
    if (arrived) return true;
  }
  return false;
}

/// Runs one slice; true if `time` is reached. The end of a slice changes no bit of the run, so that its length may
/// follow the clock.
bool Runner::run_slice(double time) {
  const double begin = progress_.seconds();
  const bool arrived = simulation_.run_until(time, static_cast<std::uint64_t>(slice_),
                                             static_cast<std::uint64_t>(kEventsOfACollision * slice_));
  const double seconds = progress_.seconds() - begin;
  // A slice that was cut short by `time` says nothing of longer ones.
  if (!arrived || seconds > kLook) {
    slice_ = std::clamp(slice_ * std::min(kGrowth, kLook / std::max(seconds, 1e-9)), 1.0, kLongestSlice);
  }
  return arrived;
}

std::string Runner::text(double planned_end) const {
  const double done = simulation_.time();
  const double seconds = progress_.seconds();
  const auto collisions = static_cast<double>(simulation_.counters().collisions - collisions_);
  return fmt::format("{} {:.4g} of {:g}  {:.0f} collisions/s  {}  energy drift {:.1e}", phase_, done, planned_end,
                     collisions / std::max(seconds, 1e-9), eta(seconds, done - begin_, planned_end - begin_),
                     std::abs(simulation_.kinetic().energy() / energy_ - 1));
}

}  // namespace hardbody
