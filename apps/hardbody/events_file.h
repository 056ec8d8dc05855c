#pragma once

#include "run_directory.h"
#include "run_record.h"

#include <ed/simulation.h>

#include <cstdint>
#include <string_view>

namespace hardbody {

/// events.csv, which grows while a run goes on: the collisions since the last checkpoint are appended before the next
/// one is written, and what a checkpoint does not know of is cut off when the run is resumed.
class EventsFile {
 public:
  /// Of `wanted` collisions; 0: there is no file. Nothing is written yet.
  EventsFile(const RunDirectory& directory, std::int64_t wanted);

  /// Whether the file is at least as long as a checkpoint says. Throws InputError if not.
  void check(EventsMark mark) const;

  /// Begins a new file (mark.bytes 0), or goes on from `mark`: cuts off what follows. From then on `simulation` records
  /// the collisions that are still wanted. Throws std::runtime_error.
  void open(EventsMark mark, ed::Simulation& simulation);

  /// Appends what `simulation` has recorded and lets it record the rest. Throws std::runtime_error if it cannot be
  /// written; the file is then as it was, and the collisions are kept.
  void take(ed::Simulation& simulation);

  EventsMark mark() const { return mark_; }

 private:
  void append(std::string_view text);
  void record_the_rest(ed::Simulation& simulation) const;

  std::filesystem::path path_;
  std::uint64_t wanted_;
  EventsMark mark_;
};

}  // namespace hardbody
