#pragma once

#include "base/log.h"
#include "io/run_directory.h"
#include "run/record.h"

#include <ed/simulation.h>

#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <string_view>

namespace hardbody {

/// events.csv, which grows while a run goes on: collisions are appended in pieces, the last of them before the next
/// checkpoint is written, and what a checkpoint does not know of is cut off when the run is resumed.
class EventsFile {
 public:
  /// Collisions that may wait in memory for a disk that takes them: 256 MB.
  static constexpr std::size_t kMostWaiting = std::size_t{1} << 24;

  /// Prepares a file of `wanted` collisions; 0: there is no file. Writes nothing yet.
  EventsFile(const RunDirectory& directory, std::int64_t wanted, std::size_t most_waiting = kMostWaiting);

  /// Checks that the file is at least as long as a checkpoint says. Throws InputError.
  void check(EventsMark mark) const;

  /// Begins a new file (mark.bytes 0), or goes on from `mark`: cuts off what follows. From then on `simulation` records
  /// the collisions that are still wanted. Throws WriteError.
  void open(EventsMark mark, ed::Simulation& simulation);

  /// Appends what `simulation` has recorded, brings the file to the disk and lets it record the rest. Throws WriteError
  /// if it cannot be written; the file is then as it was, and the collisions are kept.
  void take(ed::Simulation& simulation);

  /// Does what take() does, once much has been recorded. Called often, it keeps memory from growing with the time
  /// between two checkpoints. What cannot be written is kept and tried again later, which is logged; throws WriteError
  /// when too many are waiting for that.
  void keep_up(ed::Simulation& simulation, Log& log);

  EventsMark mark() const { return mark_; }

 private:
  void append(std::string_view text);
  void append_recorded(ed::Simulation& simulation, Flush flush);
  void record_the_rest(ed::Simulation& simulation) const;

  std::filesystem::path path_;
  std::uint64_t wanted_;
  std::size_t most_waiting_;
  EventsMark mark_;
  std::size_t next_try_;  ///< collisions in memory at which they are written
  bool failing_ = false;  ///< the last attempt of keep_up
};

}  // namespace hardbody
