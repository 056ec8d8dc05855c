#pragma once

#include "base/log.h"
#include "config/config.h"
#include "io/run_directory.h"
#include "run/record.h"
#include "trajectory/writer.h"

#include <ed/simulation.h>

#include <deque>
#include <memory>
#include <vector>

namespace hardbody {

/// The trajectories of a run: frames at fixed times of production, the first at its begin, the last at its planned end,
/// appended to each of the files that were asked for. Times between are evenly spaced or grow by a factor; or frames
/// are taken at an interval, whatever the planned end. Taking a frame changes nothing in the run.
class Trajectory {
 public:
  /// Prepares the trajectories of a production of this length. Writes nothing yet.
  Trajectory(const RunDirectory& directory, const Config& config, double planned);

  /// Returns the time of the next frame, infinity if there is none.
  double next_time() const;

  /// Checks that the files are at least as long as a checkpoint says. Throws InputError.
  void check(const TrajectoryMark& mark) const;

  /// Begins new files, or continues those of a checkpoint and cuts off what follows. Throws std::runtime_error.
  void open(const TrajectoryMark& mark);

  /// Takes the first frame, unless there is one: the state that production begins with, bit for bit. A simulation may
  /// change the last bit of it.
  void take_first(const ed::System& start, Log& log);

  /// Takes the frame that is due, of a simulation at next_time(). A file that cannot be written gets it later, which is
  /// logged. Throws std::runtime_error when too many frames are waiting.
  void take(const ed::Simulation& simulation, Log& log);

  /// Takes the state in which production ends before its planned end, unless it has just been taken, or frames have an
  /// interval.
  void take_last(const ed::Simulation& simulation, double time, Log& log);

  /// Writes the frames that are waiting and flushes all files to the disk. Throws std::runtime_error.
  void flush();

  /// Returns the extent of the files; no frame may be waiting.
  TrajectoryMark mark() const;

 private:
  void write_waiting();
  void add(Frame frame, double time, Log& log);

  std::vector<int> groups_;
  double planned_;
  double every_ = 0;      ///< interval of the frames; 0: they are spread over all of production
  double first_ = 0;      ///< time of frame 1 at logarithmic times; 0: frames are evenly spaced
  std::uint64_t wanted_;  ///< frames, of an interval the most; 0: no trajectory
  std::uint64_t taken_ = 0;
  double last_time_ = -1;  ///< time of the last frame
  std::vector<std::unique_ptr<FrameFile>> files_;
  std::deque<Frame> waiting_;  ///< the last frames taken, those that some file lacks
  bool failing_ = false;       ///< the last attempt to write
};

}  // namespace hardbody
