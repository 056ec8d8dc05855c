// The event loop's state as bytes. Apart from the loop, which the compiler inlines less of in a larger source.

#include "base/archive.h"
#include "contact/body_shapes.h"
#include "loop/event_loop.h"

#include "bodies/general.h"
#include "bodies/uniaxial.h"
#include "loop/factory.h"

#include <ed/archive_simulation.h>

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <string>

namespace ed::internal {
namespace {

/// What a state must be loaded with; without the seed function.
std::string bytes_of_choice(const SimulationOptions& options) {
  return bytes_of(options.neighbours) + bytes_of(options.contact);
}

}  // namespace

std::unique_ptr<AnyEventLoop> load_event_loop(const System& system, const SimulationOptions& options, Reader& reader) {
  if (UniaxialBodies::can_hold(system)) return std::make_unique<EventLoop<UniaxialBodies>>(system, options, reader);
  return std::make_unique<EventLoop<GeneralBodies>>(system, options, reader);
}

template <class Bodies>
EventLoop<Bodies>::EventLoop(const System& system, const SimulationOptions& options, Reader& reader)
    : EventLoop(system, options, Unbuilt()) {
  if (reader.value<std::string>() != bytes_of_choice(options)) {
    throw std::invalid_argument("state: was made with another finder or other neighbours");
  }
  const auto thickness = reader.value<double>();
  // Cells are counted by int: 1e8 of them along an edge are more than any run has.
  const double R = bodies_.bounding_radius();
  expect(reader, box_ <= 1e8 * R, "the box");
  expect(reader, thickness >= 0 && thickness <= box_, "the thickness of the envelopes");
  // What is read replaces the contents of both.
  envelopes_ = make_envelopes(bodies_, options_, thickness, 1, box_);
  envelopes_->load(reader);
  const bool fits = envelopes_->reach() >= R && envelopes_->reach() <= 2 * box_;
  expect(reader, envelopes_->thickness() == thickness && fits, "the size of the envelopes");
  cells_.emplace(number(), box_, envelopes_->reach(), options_.batches);
  fields(reader, *this);
  // Else cells would be too narrow for what is looked for in them, now or when the box has shrunk on.
  const double least = envelopes_->least_scale();
  const bool shrinks = list_scale_ > 0 && list_scale_ <= 1 && list_scale_ >= least * (1 - 1e-9);
  expect(reader, least > 0 && shrinks && cells_->cover(envelopes_->reach() * (list_scale_ / least)), "the cells");
  load_failures(reader);
  expect(reader, events_fit(), "the events do not fit the lists");
  reserve_for_events();
  collisions_.reserve(std::min(collisions_wanted_, kCollisionsReserved));
}

/// Not here: what only lives while an event is processed (queue_, orphans_, near_, meetings_, old_pairs_, unsolved_),
/// and what the constructor has made of species and options.
template <class Bodies>
template <class Archive, class Self>
void EventLoop<Bodies>::fields(Archive& archive, Self& self) {
  archive(self.bodies_, self.images_, *self.cells_, self.lists_, self.calendar_);
  archive(self.list_scale_, self.epoch_, self.now_, self.epochs_, self.virial_, self.virial_tensor_, self.counters_,
          self.collisions_of_, self.finder_);
  archive(self.collisions_, self.collisions_wanted_, self.failures_of_, self.events_, self.stall_watch_);
}

template <class Bodies>
void EventLoop<Bodies>::save(Writer& writer) const {
  writer(bytes_of_choice(options_), envelopes_->thickness());
  envelopes_->save(writer);
  fields(writer, *this);
  writer(std::uint64_t{failures_.size()});
  for (const FailedPair& failed : failures_) fields_but_shapes(writer, failed);
}

template <class Bodies>
void EventLoop<Bodies>::load_failures(Reader& reader) {
  const auto number_of_failures = reader.value<std::uint64_t>();
  expect(reader, number_of_failures <= kReasons * kMaxFailuresRecorded, "the failed pairs");
  for (std::uint64_t k = 0; k < number_of_failures; ++k) {
    FailedPair& failed = failures_.emplace_back();
    fields_but_shapes(reader, failed);
    expect(reader, std::min(failed.i, failed.j) >= 0 && std::max(failed.i, failed.j) < number(), "a failed pair");
    failed.shape_i = species_[at(species_of_[at(failed.i)])].shape;
    failed.shape_j = species_[at(species_of_[at(failed.j)])].shape;
  }
}

/// Whether what was read can be run: one entry a body, each that of a pair which the body owns, or its exit.
template <class Bodies>
bool EventLoop<Bodies>::events_fit() const {
  const std::size_t n = at(number());
  if (images_.size() != n || collisions_of_.size() != n) return false;
  if (!std::isfinite(now_ + epochs_) || !(epoch_ > 0) || !std::isfinite(epoch_)) return false;
  for (int i = 0; i < number(); ++i) {
    const std::int32_t first = bodies_.events(i).first;
    if (std::isnan(bodies_.events(i).exit)) return false;
    if (first != kExit && !(lists_.lists(i, first) && lists_.pair(first).owner == i)) return false;
  }
  return true;
}

template void EventLoop<UniaxialBodies>::save(Writer& writer) const;
template void EventLoop<GeneralBodies>::save(Writer& writer) const;

}  // namespace ed::internal
