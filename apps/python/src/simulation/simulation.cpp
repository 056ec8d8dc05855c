#include "simulation/simulation.h"

#include "base/arguments.h"
#include "base/gil.h"
#include "base/unlocked.h"
#include "geometry/custom_shape.h"
#include "simulation/outcomes.h"

#include <nanobind/nanobind.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <exception>
#include <functional>
#include <stdexcept>
#include <utility>

namespace hardbody::python {
namespace {

using Clock = std::chrono::steady_clock;

/// Seconds of a slice of a run, between two looks at signals.
constexpr double kLook = 0.05;
/// Collisions in the first slice: little work for the slowest shapes; it grows by kGrowth at most.
constexpr double kFirstSlice = 1;
constexpr double kGrowth = 8;
constexpr double kLongestSlice = 1e6;
/// Most events in a slice for each of its collisions. A run that stalls has any number of them without a collision.
constexpr double kEventsOfACollision = 100;

/// Sets a flag as long as it lives.
class Busy {
 public:
  explicit Busy(bool& flag) : flag_(flag) { flag_ = true; }
  ~Busy() { flag_ = false; }
  Busy(const Busy&) = delete;
  Busy& operator=(const Busy&) = delete;

 private:
  bool& flag_;
};

/// Fraction of a run that is done, handed to Python about ten times a second.
class ProgressCalls {
 public:
  ProgressCalls(const RunPlan& plan, const ed::Simulation& simulation)
      : callable_(plan.progress.is_valid() ? plan.progress : nb::handle(Py_None)),
        plan_(plan),
        simulation_(simulation),
        begin_(simulation.time()),
        first_collision_(simulation.counters().collisions) {}

  void operator()() {
    if (!callable_.is_none() && ticks_.due()) callable_(done());
  }
  void end() const {
    if (!callable_.is_none()) callable_(1.0);
  }

 private:
  double done() const {
    const auto collisions = static_cast<double>(simulation_.counters().collisions - first_collision_);
    const double by_collisions = collisions / static_cast<double>(plan_.collisions);
    const double by_time = (simulation_.time() - begin_) / (plan_.end - begin_);
    return std::isfinite(plan_.end) ? std::max(by_time, by_collisions) : by_collisions;
  }

  nb::handle callable_;
  const RunPlan& plan_;
  const ed::Simulation& simulation_;
  double begin_;
  std::uint64_t first_collision_;
  Ticks ticks_;
};

/// Times at which a callback is due: multiples of an interval, from the begin of a run on.
class CallTimes {
 public:
  CallTimes(const RunPlan& plan, double begin)
      : every_(plan.callback.is_valid() && !plan.callback.is_none() ? plan.every : 0), begin_(begin), end_(plan.end) {}

  double next() const {
    if (every_ == 0) return std::numeric_limits<double>::infinity();
    const double time = begin_ + count_ * every_;
    // The last of k intervals ends with the run although their sum is rounded.
    return std::abs(time - end_) <= 1e-9 * every_ ? end_ : time;
  }
  void advance() { ++count_; }

 private:
  double every_;
  double begin_;
  double end_;
  double count_ = 1;
};

/// Returns the simulation, constructed without the GIL. Ctrl-C ends that.
ed::Simulation constructed(const ed::System& system, ed::SimulationOptions options) {
  check_interrupts();
  options.poll = InterruptPoll();
  return unlocked([&] { return ed::Simulation(system, options); });
}

}  // namespace

PythonSimulation::PythonSimulation(const BodySystem& bodies, const ed::SimulationOptions& options)
    : PythonSimulation(constructed(bodies.system, options), options, bodies.groups) {
  const double used = simulation_.envelope();
  if (options.envelope == 0 || used == options.envelope) return;
  refuse_value("envelope", shown(options.envelope),
               (used < options.envelope ? "at most " : "at least ") + shown(used) + " in this box");
}

PythonSimulation::PythonSimulation(ed::Simulation simulation, const ed::SimulationOptions& options,
                                   std::vector<int> groups)
    : simulation_(std::move(simulation)),
      options_(options),
      groups_(std::move(groups)),
      seen_(simulation_.counters()),
      slice_(kFirstSlice) {}

const ed::Simulation& PythonSimulation::whole() const {
  if (is_busy_)
    throw std::runtime_error("the simulation is within an event; accepted: when run has returned, or calls back");
  if (is_broken_) {
    throw std::runtime_error(
        "the simulation was left within an event, by an exception in a shape; accepted: restoring a saved state");
  }
  return simulation_;
}

ed::Simulation& PythonSimulation::idle() {
  whole();
  if (is_running_) throw std::runtime_error("the simulation is running; accepted: when run has returned");
  return simulation_;
}

/// Runs a slice without the GIL. Ctrl-C in methods of shapes is thrown after it.
bool PythonSimulation::run_slice(double time, std::uint64_t most_collisions) {
  const auto events = static_cast<std::uint64_t>(kEventsOfACollision * slice_);
  const std::uint64_t number = std::min(static_cast<std::uint64_t>(slice_), most_collisions);
  KeptInterrupt interrupt;
  bool arrived = false;
  const Clock::time_point begin = Clock::now();
  try {
    const Busy busy(is_busy_);
    arrived = unlocked([&] { return simulation_.run_until(time, number, events); });
  } catch (...) {
    is_broken_ = true;
    throw;
  }
  const double seconds = std::chrono::duration<double>(Clock::now() - begin).count();
  // A slice that was cut short by its ends says nothing of longer ones.
  if ((!arrived && number < most_collisions) || seconds > kLook) {
    slice_ = std::clamp(slice_ * std::min(kGrowth, kLook / std::max(seconds, 1e-9)), 1.0, kLongestSlice);
  }
  if (interrupt.happened()) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw nb::python_error();
  }
  return arrived;
}

/// Runs to a time, or until the counter of collisions is `last_collision`; true if the time is reached.
bool PythonSimulation::advance(double time, std::uint64_t last_collision, const std::function<void()>& report) {
  while (!simulation_.stall()) {
    check_interrupts();
    const std::uint64_t collisions = simulation_.counters().collisions;
    if (collisions >= last_collision) return false;
    if (run_slice(time, last_collision - collisions)) return true;
    report();
  }
  return false;
}

double PythonSimulation::next_measurement() const {
  double next = std::numeric_limits<double>::infinity();
  for (const auto& m : measurements_) next = std::min(next, m->observables.next_time());
  return next;
}

void PythonSimulation::take_measurements(double time) {
  const Busy busy(is_busy_);
  unlocked([&] {
    for (const auto& m : measurements_) {
      if (m->observables.next_time() <= time) m->observables.measure(simulation_);
    }
  });
}

/// Throws NumericalError for what has happened since the last look.
void PythonSimulation::check_trouble() {
  const ed::Counters now = simulation_.counters();
  std::string text = trouble_text(std::exchange(seen_, now), now);
  if (const std::optional<ed::Stall>& stall = simulation_.stall()) {
    text += (text.empty() ? "" : "; ") + ed::describe(*stall);
  } else if (text.empty()) {
    return;
  } else {
    text += ", until time " + shown(simulation_.time()) + "; what follows is worthless";
  }
  raise_numerical_error(text, now, simulation_.failures(), simulation_.stall());
}

void PythonSimulation::run(nb::handle self, const RunPlan& plan) {
  if (!std::isfinite(plan.end)) refuse_rest("run to a number of collisions");
  idle();
  const Busy running(is_running_);
  run_to_end(self, plan);
}

void PythonSimulation::run_to_end(nb::handle self, const RunPlan& plan) {
  const GilAcquired calling;
  const std::uint64_t collisions = simulation_.counters().collisions;
  const std::uint64_t last = collisions + std::min(plan.collisions, ~std::uint64_t{0} - collisions);
  ProgressCalls progress(plan, simulation_);
  CallTimes calls(plan, simulation_.time());
  const auto report = [&] { progress(); };
  for (bool ended = false; !ended;) {
    const double call = calls.next();
    const double measurement = next_measurement();
    const double stop = std::min({plan.end, call, measurement});
    const bool arrived = advance(stop, last, report);
    if (arrived && stop == measurement) take_measurements(stop);
    ended = !arrived || stop == plan.end;
    if (!arrived || stop != call) continue;
    check_trouble();
    calls.advance();
    if (ends_run(plan.callback(self))) break;
  }
  check_trouble();
  progress.end();
}

/// Calls work(), which changes the simulation, without the GIL.
template <class Work>
void PythonSimulation::change(const Work& work) {
  const Busy running(is_running_);
  KeptInterrupt interrupt;
  try {
    const Busy busy(is_busy_);
    unlocked(work);
  } catch (...) {
    is_broken_ = true;
    throw;
  }
  if (interrupt.happened()) {
    PyErr_SetNone(PyExc_KeyboardInterrupt);
    throw nb::python_error();
  }
  check_interrupts();
  check_trouble();
}

double PythonSimulation::shrink_box(nb::handle target_box, double least_gain) {
  refuse_with_observables("shrink_box");
  const double target = positive(target_box, "target_box");
  if (target > simulation_.box()) {
    refuse_value("target_box", shown(target), "at most the box, " + shown(simulation_.box()));
  }
  if (options_.neighbours != ed::Neighbours::dilated) {
    throw std::runtime_error("shrink_box needs neighbours=\"dilated\"; this simulation has \"" +
                             std::string(to_string(options_.neighbours)) + '"');
  }
  double box = 0;
  change([&] { box = simulation_.shrink_box(target, least_gain); });
  return box;
}

void PythonSimulation::tune_envelopes() {
  refuse_with_observables("tune_envelopes");
  if (options_.neighbours == ed::Neighbours::cells) {
    throw std::runtime_error("tune_envelopes needs neighbours=\"dilated\" or \"obp\"; this simulation has \"cells\"");
  }
  refuse_rest("tune envelopes");
  Ticks ticks;
  std::exception_ptr interrupt;
  change([&] {
    simulation_.tune_envelopes([&] {
      if (!ticks.due()) return true;
      const GilAcquired gil;
      try {
        check_interrupts();
      } catch (...) {
        interrupt = std::current_exception();
      }
      return !interrupt;
    });
  });
  if (interrupt) std::rethrow_exception(interrupt);
}

/// Throws ValueError if no body moves: there will never be a collision.
void PythonSimulation::refuse_rest(const char* what) {
  if (idle().kinetic().energy() > 0) return;
  throw nb::value_error(
      (std::string("all bodies are at rest; accepted, to ") + what + ": bodies that move, as system.thermalized()")
          .c_str());
}

void PythonSimulation::refuse_with_observables(const char* what) {
  idle();
  if (measurements_.empty()) return;
  throw std::runtime_error(std::string(what) + " would disturb what is measured; accepted: before measure");
}

std::shared_ptr<Measurement> PythonSimulation::measure(ed::ObservablesOptions options) {
  if (idle().time() != 0) {
    throw nb::value_error(("time is " + shown(simulation_.time()) +
                           "; accepted: measuring begins at time 0: use Simulation(simulation.system)")
                              .c_str());
  }
  ed::Observables observables(options);
  measurements_.push_back(std::make_shared<Measurement>(Measurement{std::move(options), std::move(observables)}));
  return measurements_.back();
}

}  // namespace hardbody::python
