#pragma once

#include <algorithm>
#include <cmath>

namespace ed::internal {

/// Simulated time of an event loop, counted in epochs.
///
/// Local times, which all events and flights have, are measured from the start of the current epoch. At its end all
/// bodies are moved there and every time is shifted, so that no digits are lost however long a run lasts.
class EpochClock {
 public:
  double now() const { return now_; }                              ///< current local time
  double epoch() const { return epoch_; }                          ///< length of an epoch
  double time() const { return time_at(now_); }                    ///< time since the start of the run
  double time_at(double t) const { return epochs_ * epoch_ + t; }  ///< time since the start, of a local one
  /// Returns a time since the start as a local one.
  double local(double time) const { return time - epochs_ * epoch_; }

  void set_epoch(double epoch) { epoch_ = epoch; }
  /// Goes on to the local time t, if that is later.
  void advance(double t) { now_ = std::max(now_, t); }
  void go_to_end_of_epoch() { now_ = epoch_; }
  /// Starts the next epoch, at the end of the current one.
  void start_epoch() {
    now_ = 0;
    epochs_ += 1;
  }

  /// Whether its numbers can be those of a run.
  bool is_sound() const {
    return std::isfinite(epochs_) && epoch_ > 0 && std::isfinite(epoch_) && now_ >= 0 && now_ <= epoch_;
  }

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.epoch_, self.now_, self.epochs_);
  }

 private:
  double epoch_ = 1;
  double now_ = 0;
  double epochs_ = 0;
};

}  // namespace ed::internal
