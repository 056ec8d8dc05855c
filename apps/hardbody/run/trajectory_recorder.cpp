#include "run/trajectory_recorder.h"

#include "io/text_file.h"
#include "trajectory/gsd/frames.h"
#include "trajectory/lammps/dump.h"
#include "trajectory/vtk.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <optional>
#include <stdexcept>
#include <utility>

namespace hardbody {
namespace {

/// Bytes in memory that frames may take while no file takes them.
constexpr std::size_t kMostWaiting = std::size_t{1} << 28;

/// Time of frame 1 at logarithmic times, in Config::time_unit: the shortest lag at which runs measure.
constexpr double kFirstLogTime = 2e-3;

std::size_t memory_of(const Frame& frame) {
  return frame.bodies.size() * (sizeof(FrameBody) + sizeof(ed::Body)) + frame.types.size() * sizeof(ed::Species);
}

/// Returns k times an interval to 15 digits, which is the decimal number that a user expects: 0.1 three times is 0.3. A
/// production of that length then has the frame, and so has a longer one.
double whole_multiple(double interval, std::uint64_t k) {
  return std::stod(fmt::format("{:.15g}", interval * static_cast<double>(k)));
}

std::unique_ptr<FrameFile> writer_of(TrajectoryFormat format, const RunDirectory& directory, std::uint64_t capacity) {
  switch (format) {
    case TrajectoryFormat::gsd:
      return std::make_unique<GsdWriter>(directory.file(kGsdFile), capacity);
    case TrajectoryFormat::lammps:
      return std::make_unique<LammpsWriter>(directory.file(kLammpsFile));
    case TrajectoryFormat::vtk:
      return std::make_unique<VtkWriter>(directory.file(kVtkFile), capacity);
  }
  throw std::logic_error("a trajectory format without a writer");
}

}  // namespace

Trajectory::Trajectory(const RunDirectory& directory, const Config& config, double planned)
    : groups_(config.numbers()),
      planned_(planned),
      every_(config.frames_every.value_or(0)),
      wanted_(config.trajectory.empty() ? 0
              : planned > 0             ? static_cast<std::uint64_t>(config.frames)
                                        : 1) {
  if (config.frames_spacing == FramesSpacing::log && wanted_ > 2) {
    // Many frames in a short production are as close together as evenly spaced ones at first.
    first_ = std::min(kFirstLogTime * config.time_unit, planned / static_cast<double>(wanted_ - 1));
  }
  for (const TrajectoryFormat format : config.trajectory) files_.push_back(writer_of(format, directory, wanted_));
}

double Trajectory::next_time() const {
  if (taken_ >= wanted_) return std::numeric_limits<double>::infinity();
  if (taken_ == 0) return 0;
  if (every_ > 0) {
    const double next = whole_multiple(every_, taken_);
    return next <= planned_ ? next : std::numeric_limits<double>::infinity();
  }
  // The end itself, not what rounding makes of it.
  if (taken_ + 1 == wanted_) return planned_;
  if (first_ > 0) {
    const double share = static_cast<double>(taken_ - 1) / static_cast<double>(wanted_ - 2);
    return first_ * std::pow(planned_ / first_, share);
  }
  return planned_ * static_cast<double>(taken_) / static_cast<double>(wanted_ - 1);
}

void Trajectory::check(const TrajectoryMark& mark) const {
  for (std::size_t k = 0; k < files_.size() && mark.frames > 0; ++k) {
    check_length(files_[k]->path(), k < mark.bytes.size() ? std::optional(mark.bytes[k]) : std::nullopt);
  }
}

void Trajectory::open(const TrajectoryMark& mark) {
  taken_ = mark.frames;
  last_time_ = mark.last_time;
  for (std::size_t k = 0; k < files_.size(); ++k) {
    files_[k]->open({mark.frames, mark.frames > 0 ? mark.bytes.at(k) : 0});
  }
}

void Trajectory::take_first(const ed::System& start, Log& log) {
  if (taken_ == 0 && wanted_ > 0) add(frame_of(start, groups_), 0, log);
}

void Trajectory::take(const ed::Simulation& simulation, Log& log) {
  add(frame_of(simulation, groups_, taken_), next_time(), log);
}

void Trajectory::take_last(const ed::Simulation& simulation, double time, Log& log) {
  if (taken_ < wanted_ && last_time_ < time && !(every_ > 0 && taken_ > 0))
    add(frame_of(simulation, groups_, taken_), time, log);
}

void Trajectory::add(Frame frame, double time, Log& log) {
  waiting_.push_back(std::move(frame));
  waiting_.back().time = time;  // as asked for; the simulation's own is rounded
  last_time_ = time;
  ++taken_;
  try {
    write_waiting();
    if (std::exchange(failing_, false)) log.line("trajectory: written again");
  } catch (const std::runtime_error& error) {
    if (waiting_.size() * memory_of(waiting_.front()) > kMostWaiting) throw;
    if (!std::exchange(failing_, true)) log.line(fmt::format("trajectory: {}; frames wait in memory", error.what()));
  }
}

void Trajectory::flush() {
  write_waiting();
  if (taken_ == 0) return;
  for (const auto& file : files_) flush_file(file->path());
}

void Trajectory::write_waiting() {
  const std::uint64_t first = taken_ - waiting_.size();
  for (const auto& file : files_) {
    while (file->mark().frames < taken_) file->append(waiting_[file->mark().frames - first]);
  }
  waiting_.clear();
}

TrajectoryMark Trajectory::mark() const {
  TrajectoryMark mark;
  mark.frames = taken_;
  mark.last_time = last_time_;
  for (const auto& file : files_) mark.bytes.push_back(file->mark().bytes);
  return mark;
}

}  // namespace hardbody
