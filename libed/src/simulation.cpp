#include "cell_envelopes.h"
#include "event_loop.h"

#include <ed/simulation.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <sstream>
#include <stdexcept>

namespace ed {

class Simulation::Impl : public internal::EventLoop {
 public:
  using EventLoop::EventLoop;
};

namespace {

/// Work of a stretch of the run in units of one evaluation of the gap function, from counters alone so that it is the
/// same on every machine. The weights are relative times, measured with a profiler at X0 = 3, phi = 0.40.
double work(const Counters& from, const Counters& to) {
  const auto difference = [](std::uint64_t a, std::uint64_t b) { return static_cast<double>(b - a); };
  return difference(from.kernel_calls, to.kernel_calls) + difference(from.predictions, to.predictions) +
         0.7 * difference(from.candidate_tests, to.candidate_tests) +
         4 * difference(from.neighbour_rebuilds, to.neighbour_rebuilds) +
         difference(from.envelope_checks, to.envelope_checks);
}

void check_start(const System& system) {
  if (system.size() < 2) {
    throw std::invalid_argument("number is " + std::to_string(system.size()) + "; accepted: at least 2");
  }
  if (!(system.box > 0) || !std::isfinite(system.box)) {
    throw std::invalid_argument("box is not positive; accepted: a positive number");
  }
  const Audit state = audit(system);
  if (!state.finite) throw std::invalid_argument("a position, orientation or velocity is not finite");
  if (state.overlaps == 0 && state.unanswered == 0) return;
  std::ostringstream message;
  message << state.overlaps + state.unanswered << " pairs of bodies overlap at the start";
  if (state.overlaps > 0) {
    message << ", the worst answered by " << -state.minimum_distance << " (bodies " << state.closest_i << " and "
            << state.closest_j << ")";
  } else {
    message << ", too deeply to say how much";
  }
  message << "; accepted: none deeper than " << kAuditOverlap;
  throw std::invalid_argument(message.str());
}

/// Mean number of bodies in 27 cells below which cells are faster, by at least 5 % where the choice matters: measured
/// for X0 = 1/3 to 10, phi = 0.02 to 0.15 (bench_engine, dilute/...; the unit test has the rows).
constexpr double kFewInCells = 33;
constexpr double kFewInCellsBracketing = 12;

}  // namespace

const char* to_string(FailureReason reason) {
  switch (reason) {
    case FailureReason::overlap:
      return "the bodies overlap by more than rounding";
    case FailureReason::distance:
      return "Newton's method for the distance gave no answer";
  }
  return "unknown";
}

Neighbours fastest_neighbours(const geom::Ellipsoid& shape, int number, double packing_fraction, Finder finder) {
  const int cells =
      internal::CellEnvelopes::cells_along(box_for(shape, number, packing_fraction), shape.bounding_radius());
  if (cells < internal::CellEnvelopes::kLeastCells) return Neighbours::dilated;
  if (shape.bounding_radius() == shape.inscribed_radius()) return Neighbours::dilated;
  const double in_cells = 27.0 * number / (static_cast<double>(cells) * cells * cells);
  const double few = finder == Finder::certified ? kFewInCells : kFewInCellsBracketing;
  return in_cells < few ? Neighbours::cells : Neighbours::dilated;
}

Simulation::Simulation(const System& system, const SimulationOptions& options) {
  check_start(system);
  impl_ = std::make_unique<Impl>(system, options);
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

double Simulation::time() const {
  return impl_->time();
}
double Simulation::box() const {
  return impl_->box();
}
double Simulation::envelope() const {
  return impl_->envelope();
}
double Simulation::virial() const {
  return impl_->virial();
}
KineticState Simulation::kinetic() const {
  return impl_->kinetic();
}
System Simulation::system() const {
  return impl_->system();
}
void Simulation::sample(Snapshot& snapshot) const {
  impl_->sample(snapshot);
}
void Simulation::record_collisions(std::size_t number) {
  impl_->record_collisions(number);
}
const std::vector<Collision>& Simulation::collisions() const {
  return impl_->collisions();
}
const std::vector<FailedPair>& Simulation::failures() const {
  return impl_->failures();
}

Counters Simulation::counters() const {
  return impl_->counters();
}

bool Simulation::run_until(double time, std::uint64_t max_collisions) {
  if (std::isnan(time)) throw std::invalid_argument("run_until: time is not a number");
  return impl_->run_until(time, max_collisions);
}

void Simulation::run_collisions(std::uint64_t number) {
  impl_->run_until(std::numeric_limits<double>::infinity(), number);
}

double Simulation::shrink_box(double target_box, double least_gain) {
  if (impl_->neighbours() != Neighbours::dilated) {
    throw std::logic_error("shrink_box: needs the neighbour lists of dilated bodies");
  }
  return impl_->shrink_box(target_box, least_gain);
}

void Simulation::tune_envelopes(const std::function<bool()>& keep_going) {
  if (impl_->neighbours() == Neighbours::cells) return;
  constexpr std::uint64_t kSlice = 100;
  bool stopped = false;
  const auto run = [&](std::uint64_t number) {
    for (std::uint64_t done = 0; done < number && !stopped; done += kSlice) {
      run_collisions(std::min(kSlice, number - done));
      stopped = keep_going && !keep_going();
    }
  };
  const auto stretch = 2 * static_cast<std::uint64_t>(impl_->number());
  const auto cost = [&](double thickness) {
    impl_->set_envelope(thickness);
    run(stretch / 2);
    const Counters before = impl_->counters();
    run(stretch);
    return stopped ? std::numeric_limits<double>::infinity() : work(before, impl_->counters());
  };
  // Walk in steps of 25 % from the current thickness, in the direction that gets cheaper.
  constexpr double kStep = 1.25;
  double best = impl_->envelope();
  double best_cost = cost(best);
  for (const double factor : {kStep, 1 / kStep}) {
    bool improved = false;
    for (int step = 0; step < 6 && !stopped; ++step) {
      const double trial = best * factor;
      const double trial_cost = cost(trial);
      if (!(trial_cost < best_cost) || impl_->envelope() != trial) break;
      best = trial;
      best_cost = trial_cost;
      improved = true;
    }
    if (improved) break;
  }
  impl_->set_envelope(best);
}

}  // namespace ed
