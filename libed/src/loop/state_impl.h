#pragma once

/// Members of EventLoop that write and read its state as bytes.

#include "base/archive.h"
#include "loop/event_loop.h"

#include <ed/archive_simulation.h>

#include <cmath>
#include <stdexcept>
#include <string>
#include <utility>

namespace ed::internal {

/// Returns the options that a state must be loaded with, as bytes; without the seed function.
inline std::string bytes_of_choice(const SimulationOptions& options) {
  return bytes_of(options.neighbours) + bytes_of(options.contact);
}

template <class Bodies, CollisionLaw Law, class Added>
EventLoop<Bodies, Law, Added>::EventLoop(const System& system, const SimulationOptions& options, Reader& reader,
                                         Law law, Added added)
    : EventLoop(system, options, Unbuilt(), std::move(law), std::move(added)) {
  if (reader.value<std::string>() != bytes_of_choice(options)) {
    throw std::invalid_argument("state: was made with another finder or other neighbours");
  }
  const auto thickness = reader.value<double>();
  // Cells are counted by int: 1e8 of them along an edge are more than any run has.
  const double R = parts_.bodies.bounding_radius();
  expect(reader, box() <= 1e8 * R, "the box");
  expect(reader, thickness >= 0 && thickness <= box(), "the thickness of the envelopes");
  // What is read replaces the contents of envelopes and cells.
  Neighbourhood<Bodies>& neighbourhood = parts_.neighbourhood;
  neighbourhood.set_envelopes(make_envelopes(parts_.bodies, parts_.options, thickness, 1, box()));
  neighbourhood.load_envelopes(reader);
  const Envelopes<Bodies>& envelopes = neighbourhood.envelopes();
  const bool fits = envelopes.reach() >= R && envelopes.reach() <= 2 * box();
  expect(reader, envelopes.thickness() == thickness && fits, "the size of the envelopes");
  neighbourhood.make_cells();
  fields(reader, *this);
  expect(reader, neighbourhood.is_sound(), "the cells");
  parts_.failures.load(reader);
  const bool sized = parts_.collisions.number() == at(number()) && parts_.clock.is_sound();
  expect(reader, sized && parts_.schedule.is_sound(), "the events do not fit the lists");
  // Flights are not longer than the run: integrals of omega over longer ones would not end.
  for (int i = 0; i < number(); ++i) {
    const double flight = parts_.now() - parts_.bodies.flight_start(i);
    expect(reader, std::abs(flight) <= parts_.clock.time() + parts_.clock.epoch(), "the start of a flight");
  }
  parts_.reserve();
  parts_.collisions.reserve();
}

/// Names what states hold, in their order. Left out: what only lives while an event is processed (lists of orphans, of
/// queued pairs and of candidates), and what the constructor has made of species and options.
template <class Bodies, CollisionLaw Law, class Added>
template <class Archive, class Self>
void EventLoop<Bodies, Law, Added>::fields(Archive& archive, Self& self) {
  auto& parts = self.parts_;
  auto [cells, lists, list_scale] = Neighbourhood<Bodies>::members(parts.neighbourhood);
  auto [virial, virial_tensor, collisions_of, recorded, wanted] = CollisionLog::members(parts.collisions);
  auto [finder] = Predictor<Bodies>::members(parts.predictor);
  auto [failures_of] = FailureLog::members(parts.failures);
  auto [events, since] = StallWatch::members(self.watch_);
  archive(parts.bodies, parts.box, cells, lists, parts.schedule.calendar());
  archive(list_scale, parts.clock, virial, virial_tensor, parts.counters, collisions_of, finder);
  archive(recorded, wanted, failures_of, events, since, parts.added);
}

template <class Bodies, CollisionLaw Law, class Added>
void EventLoop<Bodies, Law, Added>::save(Writer& writer) const {
  writer(bytes_of_choice(parts_.options), envelope());
  parts_.neighbourhood.envelopes().save(writer);
  fields(writer, *this);
  parts_.failures.save(writer);
}

}  // namespace ed::internal
