#include "base/archive.h"
#include "cells/choose.h"
#include "loop/any_event_loop.h"
#include "loop/checks.h"
#include "loop/parts/kernel_trial.h"
#include "neighbours/cell.h"
#include "system/bounding_radii.h"

#include <ed/archive_simulation.h>
#include <ed/simulation.h>

#include <geom/pose.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <limits>
#include <memory>
#include <optional>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace ed {

class Simulation::Impl {
 public:
  Impl(std::unique_ptr<internal::AnyEventLoop> loop, const SimulationOptions& options) : loop_(std::move(loop)) {
    using geom::InstructionSet;
    if (options.batches != InstructionSet::best || !loop_->has_kernels()) return;
    const InstructionSet usual = internal::chosen_in_the_loop(InstructionSet::best);
    for (const InstructionSet other : {InstructionSet::avx2, InstructionSet::avx512}) {
      if (usual > InstructionSet::portable && other != usual && geom::is_available(other)) trial_.emplace(usual, other);
    }
  }
  internal::AnyEventLoop* operator->() { return loop_.get(); }
  const internal::AnyEventLoop* operator->() const { return loop_.get(); }

  bool run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events);

 private:
  std::unique_ptr<internal::AnyEventLoop> loop_;
  std::optional<internal::KernelTrial> trial_;  ///< trial that is not over yet
};

bool Simulation::Impl::run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) {
  // Slices do not know how many events they process.
  while (trial_ && max_events == ~std::uint64_t{0} && max_collisions > 0) {
    const std::uint64_t before = loop_->counters().collisions;
    const std::uint64_t slice = std::min(max_collisions, trial_->left());
    const auto begin = std::chrono::steady_clock::now();
    const bool reached = loop_->run_until(time, slice, max_events);
    const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
    const std::uint64_t done = loop_->counters().collisions - before;
    const geom::InstructionSet used = trial_->current();
    trial_->add(done, seconds.count());
    if (trial_->current() != used) loop_->use(trial_->current());
    if (trial_->over()) trial_.reset();
    max_collisions -= done;
    if (done < slice) return reached;
  }
  return loop_->run_until(time, max_collisions, max_events);
}

namespace {

/// Throws std::invalid_argument if all bodies are at rest, which they are not once they have collided.
void check_moving(const Simulation& simulation, const std::string& function) {
  if (simulation.counters().collisions > 0 || simulation.kinetic().energy() > 0) return;
  throw std::invalid_argument(function +
                              ": all bodies are at rest: there will be no collision; accepted: bodies that move");
}

/// Raised by every change of what save() writes.
constexpr std::uint32_t kSimulationFormat = 8;

/// Work of a stretch of the run in units of 50 ns, from counters alone so that it is the same on every machine. The
/// weights are fitted to the times of runs of three states, X0 = 1/3, 2 and 3, with envelopes from 0.6 to 2 times as
/// thick as the best: they explain them to 2 %, one by one and in vectors alike.
double work(const Counters& from, const Counters& to) {
  const auto difference = [](std::uint64_t a, std::uint64_t b) { return static_cast<double>(b - a); };
  return 0.2 * difference(from.kernel_calls, to.kernel_calls) + 1.2 * difference(from.predictions, to.predictions) +
         0.4 * difference(from.candidate_tests, to.candidate_tests) +
         7 * difference(from.neighbour_rebuilds, to.neighbour_rebuilds);
}

void check_start(const System& system, const std::function<void()>& poll) {
  if (system.size() < 2) {
    throw std::invalid_argument("number is " + std::to_string(system.size()) + "; accepted: at least 2");
  }
  if (!(system.box > 0 && system.box <= geom::kMaxCoordinate)) {
    std::ostringstream message;
    message << "box is " << system.box << "; accepted: a positive number, at most " << geom::kMaxCoordinate;
    throw std::invalid_argument(message.str());
  }
  check_species(system);
  internal::check_speeds(system);
  // Before the audit, whose overlaps of a body with its own image would hide what is wrong.
  const std::vector<double> radii = internal::bounding_radii(system);
  internal::check_box(system, *std::max_element(radii.begin(), radii.end()));
  const Audit state = audit(system, poll);
  if (!state.finite) throw std::invalid_argument("a position, orientation or velocity is not finite");
  if (state.overlaps == 0 && state.unanswered == 0) return;
  std::ostringstream message;
  message << state.overlaps + state.unanswered << " pairs of bodies overlap at the start";
  if (state.overlaps > 0) {
    message << ", the deepest by " << -state.minimum_distance << " (bodies " << state.closest_i << " and "
            << state.closest_j << ")";
  } else {
    message << ", too deeply to say how much";
  }
  message << "; accepted: none deeper than " << kAuditOverlap << " of their size";
  throw std::invalid_argument(message.str());
}

/// Returns whether the numbers of a state that has been read are finite. Throws std::invalid_argument for a matrix that
/// is no rotation, and for a position that is not finite.
bool is_finite(const internal::AnyEventLoop& loop) {
  const System system = loop.system();
  for (const Body& body : system.bodies) {
    static_cast<void>(geom::Pose(body.rotation, body.position));
    if (!body.velocity.allFinite() || !body.angular_velocity.allFinite()) return false;
  }
  return std::isfinite(loop.virial()) && loop.virial_tensor().allFinite();
}

/// Mean number of bodies in 27 cells below which cells are faster, by at least 5 % where the choice matters: measured
/// for X0 = 1/3 to 10, phi = 0.02 to 0.15 (bench_engine, dilute/...; the unit test has the rows).
constexpr double kFewInCells = 33;
constexpr double kFewInCellsBracketing = 12;

}  // namespace

Counters& Counters::operator+=(const Counters& other) {
  for (const auto count :
       {&Counters::collisions, &Counters::predictions, &Counters::evaluations, &Counters::kernel_calls,
        &Counters::refinements, &Counters::cold_restarts, &Counters::rescues, &Counters::neighbour_rebuilds,
        &Counters::envelope_checks, &Counters::candidate_tests, &Counters::overlaps, &Counters::declined,
        &Counters::parting_contacts, &Counters::unrecorded_failures}) {
    this->*count += other.*count;
  }
  return *this;
}

const char* to_string(FailureReason reason) {
  switch (reason) {
    case FailureReason::overlap:
      return "the bodies overlap by more than rounding";
    case FailureReason::distance:
      return "Newton's method for the distance gave no answer";
    case FailureReason::declined:
      return "no method tells whether the bodies overlap";
  }
  return "unknown";
}

const char* to_string(EventKind kind) {
  switch (kind) {
    case EventKind::exit:
      return "exit";
    case EventKind::look:
      return "look";
    case EventKind::contact:
      return "contact";
    case EventKind::added:
      return "added";
  }
  return "unknown";
}

std::string describe(const Stall& stall) {
  std::ostringstream text;
  text << "stalled at time " << stall.time << ": " << stall.events << " events in " << stall.span << " time units, "
       << static_cast<int>(100 * stall.share) << " % of the latest ";
  switch (stall.kind) {
    case EventKind::exit:
      text << "body " << stall.i << " leaving its envelope";
      break;
    case EventKind::look:
      text << "looks at bodies " << stall.i << " and " << stall.j;
      break;
    case EventKind::contact:
      text << "contacts of bodies " << stall.i << " and " << stall.j;
      break;
    case EventKind::added:
      text << "events of body " << stall.i << " of an added kind";
      break;
  }
  return text.str();
}

Neighbours fastest_neighbours(const BodyShape& shape, int number, double packing_fraction, Finder finder) {
  const double R = bounding_radius(shape);
  const int cells = internal::CellLayout::cells_along(box_for(shape, number, packing_fraction), R);
  if (cells < internal::CellLayout::kLeastCells || R == inscribed_radius(shape)) return Neighbours::dilated;
  const double in_cells = 27.0 * number / (static_cast<double>(cells) * cells * cells);
  const double few = finder == Finder::certified ? kFewInCells : kFewInCellsBracketing;
  return in_cells < few ? Neighbours::cells : Neighbours::dilated;
}

Simulation::Simulation(const System& system, const SimulationOptions& options) {
  check_start(system, options.poll);
  impl_ = std::make_unique<Impl>(internal::make_event_loop(system, options), options);
}

Simulation::Simulation(std::unique_ptr<Impl> impl) : impl_(std::move(impl)) {}

std::string Simulation::save() const {
  std::string bytes;
  save([&bytes](std::string_view piece) { bytes += piece; });
  return bytes;
}

void Simulation::save(const std::function<void(std::string_view)>& sink) const {
  const System now = system();
  internal::Writer writer(sink);
  writer(kSimulationFormat, internal::bytes_of(now.species), now.box, std::uint64_t{now.bodies.size()});
  for (const Body& body : now.bodies) writer(body.species);
  (*impl_)->save(writer);
  writer.flush();
}

Simulation Simulation::restore(std::string_view state, const std::vector<Species>& species,
                               const SimulationOptions& options) {
  internal::Reader reader(state);
  internal::check_format(reader, kSimulationFormat);
  System system;
  system.species = species;
  if (reader.value<std::string>() != internal::bytes_of(species)) {
    throw std::invalid_argument("state: is one of other species");
  }
  reader(system.box);
  internal::expect(reader, system.box > 0 && std::isfinite(system.box), "the box");
  const auto number = reader.value<std::uint64_t>();
  internal::expect(reader, number >= 2 && number <= reader.left() / sizeof(int), "the number of bodies");
  system.bodies.resize(number);
  for (Body& body : system.bodies) reader(body.species);
  check_species(system);
  internal::expect(reader, packing_fraction(system) < 1, "more bodies than the box has room for");
  auto loop = internal::load_event_loop(system, options, reader);
  reader.finish();
  internal::expect(reader, is_finite(*loop), "a number is not finite");
  return Simulation(std::make_unique<Impl>(std::move(loop), options));
}

Simulation::~Simulation() = default;
Simulation::Simulation(Simulation&&) noexcept = default;
Simulation& Simulation::operator=(Simulation&&) noexcept = default;

double Simulation::time() const {
  return (*impl_)->time();
}
double Simulation::box() const {
  return (*impl_)->box();
}
double Simulation::envelope() const {
  return (*impl_)->envelope();
}
std::uint64_t Simulation::collisions_of(int first, int end) const {
  const int number = (*impl_)->number();
  if (first >= 0 && first <= end && end <= number) return (*impl_)->collisions_of(first, end);
  throw std::invalid_argument("collisions_of: bodies " + std::to_string(first) + " to " + std::to_string(end) +
                              "; accepted: 0 to " + std::to_string(number) + ", rising");
}
double Simulation::virial() const {
  return (*impl_)->virial();
}
Eigen::Matrix3d Simulation::virial_tensor() const {
  return (*impl_)->virial_tensor();
}
KineticState Simulation::kinetic() const {
  return kinetic_state(system());
}
System Simulation::system() const {
  return (*impl_)->system();
}
void Simulation::sample(Snapshot& snapshot) const {
  (*impl_)->sample(snapshot);
}
void Simulation::sample_translations(Snapshot& snapshot) const {
  (*impl_)->sample_translations(snapshot);
}
void Simulation::record_collisions(std::size_t number) {
  (*impl_)->record_collisions(number);
}
const std::vector<Collision>& Simulation::collisions() const {
  return (*impl_)->collisions();
}
const std::vector<FailedPair>& Simulation::failures() const {
  return (*impl_)->failures();
}
const std::optional<Stall>& Simulation::stall() const {
  return (*impl_)->stall();
}

Counters Simulation::counters() const {
  return (*impl_)->counters();
}

bool Simulation::run_until(double time, std::uint64_t max_collisions, std::uint64_t max_events) {
  if (std::isnan(time)) throw std::invalid_argument("run_until: time is not a number");
  return impl_->run_until(time, max_collisions, max_events);
}

void Simulation::run_collisions(std::uint64_t number) {
  if (number > 0) check_moving(*this, "run_collisions");
  (void)run_until(std::numeric_limits<double>::infinity(), number);
}

double Simulation::shrink_box(double target_box, double least_gain) {
  if ((*impl_)->neighbours() != Neighbours::dilated) {
    throw std::logic_error("shrink_box: needs the neighbour lists of dilated bodies");
  }
  return (*impl_)->shrink_box(target_box, least_gain);
}

void Simulation::tune_envelopes(const std::function<bool()>& keep_going) {
  if ((*impl_)->neighbours() == Neighbours::cells) return;
  check_moving(*this, "tune_envelopes");
  constexpr std::uint64_t kSlice = 100;
  constexpr std::uint64_t kLeastStretch = 4096;  // collisions; of fewer, chance would decide between neighbouring steps
  constexpr std::uint64_t kSliceEvents = 100000;
  bool stopped = false;
  const auto collisions = [&] { return (*impl_)->counters().collisions; };
  const auto run = [&](std::uint64_t number) {
    for (const std::uint64_t last = collisions() + number; collisions() < last && !stopped;) {
      (void)run_until(std::numeric_limits<double>::infinity(), std::min(kSlice, last - collisions()), kSliceEvents);
      stopped = stall() || (keep_going && !keep_going());
    }
  };
  const auto stretch = std::max(kLeastStretch, 2 * static_cast<std::uint64_t>((*impl_)->number()));
  const auto cost = [&](double thickness) {
    (*impl_)->set_envelope(thickness);
    run(stretch / 2);
    const Counters before = (*impl_)->counters();
    run(stretch);
    return stopped ? std::numeric_limits<double>::infinity() : work(before, (*impl_)->counters());
  };
  // Walk in steps of 25 % from the current thickness, in the direction that gets cheaper.
  constexpr double kStep = 1.25;
  double best = (*impl_)->envelope();
  double best_cost = cost(best);
  for (const double factor : {kStep, 1 / kStep}) {
    bool improved = false;
    for (int step = 0; step < 6 && !stopped; ++step) {
      const double trial = best * factor;
      const double trial_cost = cost(trial);
      if (!(trial_cost < best_cost) || (*impl_)->envelope() != trial) break;
      best = trial;
      best_cost = trial_cost;
      improved = true;
    }
    if (improved) break;
  }
  (*impl_)->set_envelope(best);
}

}  // namespace ed
