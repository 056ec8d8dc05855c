#include "run/files/events_file.h"

#include "io/text_file.h"
#include "run/files/observable_files.h"

#include <fmt/format.h>

#include <algorithm>
#include <span>
#include <utility>

namespace hardbody {
namespace {

/// Collisions that are appended at a time, about 2 MB in memory and twice as much as text.
constexpr std::size_t kPiece = std::size_t{1} << 17;

}  // namespace

EventsFile::EventsFile(const RunDirectory& directory, std::int64_t wanted, std::size_t most_waiting)
    : path_(directory.file(kEventsFile)),
      wanted_(static_cast<std::uint64_t>(wanted)),
      most_waiting_(most_waiting),
      next_try_(kPiece) {}

void EventsFile::check(EventsMark mark) const {
  if (wanted_ > 0 && mark.bytes > 0) check_length(path_, mark.bytes);
}

void EventsFile::open(EventsMark mark, ed::Simulation& simulation) {
  if (wanted_ == 0) return;
  mark_ = mark;
  if (mark.bytes == 0) append(events_header());
  record_the_rest(simulation);
}

void EventsFile::take(ed::Simulation& simulation) {
  if (wanted_ == 0) return;
  append_recorded(simulation, Flush::now);
}

void EventsFile::keep_up(ed::Simulation& simulation, Log& log) {
  const std::size_t waiting = simulation.collisions().size();
  if (waiting < next_try_) return;
  try {
    append_recorded(simulation, Flush::later);
    if (std::exchange(failing_, false)) log.line("events.csv: written again");
  } catch (const WriteError& error) {
    if (waiting > most_waiting_) throw;
    next_try_ = waiting + kPiece;
    if (!std::exchange(failing_, true)) log.line(fmt::format("{}; collisions wait in memory", error.what()));
  }
}

void EventsFile::append_recorded(ed::Simulation& simulation, Flush flush) {
  const std::span<const ed::Collision> all = simulation.collisions();
  std::uint64_t end = mark_.bytes;
  try {
    for (std::size_t done = 0; done < all.size(); done += kPiece) {
      const std::string text = events_rows(all.subspan(done, std::min(kPiece, all.size() - done)));
      write_at(path_, end, text, Flush::later);
      end += text.size();
    }
    if (flush == Flush::now) write_at(path_, end, "");
  } catch (const WriteError&) {
    cut_off(path_, mark_.bytes);
    throw;
  }
  mark_.bytes = end;
  mark_.rows += all.size();
  next_try_ = kPiece;
  record_the_rest(simulation);
}

void EventsFile::append(std::string_view text) {
  write_at(path_, mark_.bytes, text);
  mark_.bytes += text.size();
}

void EventsFile::record_the_rest(ed::Simulation& simulation) const {
  simulation.record_collisions(wanted_ - mark_.rows);
}

}  // namespace hardbody
