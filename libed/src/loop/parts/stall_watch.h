#pragma once

#include <ed/simulation.h>

#include <array>
#include <cstdint>
#include <map>
#include <optional>
#include <tuple>

namespace ed::internal {

/// Counts events by kind and bodies, to find the most frequent one.
class EventTally {
 public:
  /// `bodies`: of the event; -1 for one that it does not have.
  void add(EventKind kind, const std::array<std::int32_t, 2>& bodies);
  int events() const { return events_; }
  /// Returns kind, bodies and share of the most frequent event; of equally frequent ones, the first in order of kind
  /// and bodies.
  Stall most_frequent() const;

 private:
  std::map<std::tuple<EventKind, int, int>, int> times_;
  int events_ = 0;
};

/// Decides when to ask whether the run still makes progress, and keeps the answer.
class StallWatch {
 public:
  /// Number of events whose tally shows what a run is stuck in.
  static constexpr int kSample = 1000;

  explicit StallWatch(int number) : events_between_(kEvents * static_cast<std::uint64_t>(number)) {}

  /// Counts an event. Returns whether it is time to ask for progress.
  bool count() { return ++events_ >= events_between_; }
  /// Returns the simulated time since the last question. `time` is the time since the start of the run, here and below.
  double span(double time) const { return time - since_; }
  /// Sets the stall, made of the events since the last question; `sample` are the latest of them.
  void declare_stalled(const EventTally& sample, double time);
  /// Starts to count anew, after a question.
  void restart(double time) {
    events_ = 0;
    since_ = time;
  }
  const std::optional<Stall>& stall() const { return stall_; }

  /// Number of events since the last question, and its time.
  template <class Self>
  static auto members(Self& self) {
    return std::tie(self.events_, self.since_);
  }

 private:
  static constexpr std::uint64_t kEvents = 2000;  ///< number for each body between two questions

  std::uint64_t events_between_;
  std::uint64_t events_ = 0;
  double since_ = 0;
  std::optional<Stall> stall_;
};

}  // namespace ed::internal
