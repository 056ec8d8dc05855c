#include "events_file.h"

#include "errors.h"
#include "observable_files.h"
#include "text_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <system_error>

namespace hardbody {

EventsFile::EventsFile(const RunDirectory& directory, std::int64_t wanted)
    : path_(directory.file(kEventsFile)), wanted_(static_cast<std::uint64_t>(wanted)) {}

void EventsFile::check(EventsMark mark) const {
  if (wanted_ == 0 || mark.bytes == 0) return;
  std::error_code error;
  const std::uintmax_t bytes = std::filesystem::file_size(path_, error);
  if (!error && bytes >= mark.bytes) return;
  throw InputError(fmt::format("{}: has {} bytes, {} when the checkpoint was written; accepted: the file of the run",
                               path_.string(), error ? 0 : bytes, mark.bytes));
}

void EventsFile::open(EventsMark mark, ed::Simulation& simulation) {
  if (wanted_ == 0) return;
  mark_ = mark;
  if (mark.bytes == 0) append(events_header());
  record_the_rest(simulation);
}

void EventsFile::take(ed::Simulation& simulation) {
  if (wanted_ == 0) return;
  append(events_rows(simulation.collisions()));
  mark_.rows += simulation.collisions().size();
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
