#pragma once

#include "base/archive.h"
#include "base/large_vector.h"
#include "bodies/body_events.h"
#include "bodies/pair.h"
#include "loop/parts/epoch_clock.h"
#include "loop/parts/periodic_box.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <type_traits>
#include <utility>

namespace ed::internal {

/// Change that an event has made to its body.
enum class BodyChange {
  none,    ///< predictions stay as they are
  motion,  ///< exit and contacts of the body are predicted again
};

/// Kinds of single-body events beyond the loop's own, a parameter of the event loop. A kind is a class with
///
///     double predict(const Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& box);
///     BodyChange process(Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& box);
///
/// predict() returns the local time of the body's next event, not before clock.now(); kNever if there is none. It is
/// called at the start, when the motion of the body or the box has changed, and after each event. process() is called
/// at the time of the event; the event that predict() returns next must be another one. process() may change the
/// velocity of the body (set_velocity) and nothing else of it. States hold the times of the events, but not the kinds:
/// whoever restores a loop hands them in again. A loop without added kinds pays nothing for them.
template <class... Kinds>
class AddedEvents {
 public:
  static constexpr std::int32_t kNumber = sizeof...(Kinds);

  AddedEvents() = default;
  explicit AddedEvents(Kinds... kinds) requires(kNumber > 0) : kinds_(std::move(kinds)...) {}

  const std::tuple<Kinds...>& kinds() const { return kinds_; }

  /// BodyEvents::first of an event of kind number k.
  static constexpr std::int32_t first_of(std::int32_t k) { return BodyEvents::kExit - 1 - k; }
  /// Whether `first` is that of an added event.
  static constexpr bool has(std::int32_t first) { return first < BodyEvents::kExit && first >= first_of(kNumber - 1); }

  /// Makes room for the events of `number` bodies; none is predicted.
  void resize(int number) {
    for (LargeVector<double>& times : times_) times.assign(static_cast<std::size_t>(number), kNever);
  }
  /// Predicts all events of a body.
  template <class Bodies>
  void predict(const Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& box) {
    for_each_kind([&](auto k) { predict<k>(bodies, body, clock, box); });
  }
  /// Predicts the event of kind k.
  template <std::size_t k, class Bodies>
  void predict(const Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& box) {
    times_[k][static_cast<std::size_t>(body)] = std::get<k>(kinds_).predict(bodies, body, clock, box);
  }
  template <std::size_t k, class Bodies>
  BodyChange process(Bodies& bodies, int body, const EpochClock& clock, const PeriodicBox& box) {
    return std::get<k>(kinds_).process(bodies, body, clock, box);
  }

  /// Replaces time and BodyEvents::first of a body's earliest event where an added one comes earlier.
  void take_earlier(int body, double& earliest, std::int32_t& first) const {
    for_each_kind([&](auto k) {
      const double time = times_[k][static_cast<std::size_t>(body)];
      if (!(time < earliest)) return;
      earliest = time;
      first = first_of(static_cast<std::int32_t>(k));
    });
  }
  /// Measures all times from an epoch later.
  void start_epoch(double epoch) {
    for (LargeVector<double>& times : times_) {
      for (double& time : times) time -= epoch;
    }
  }

  /// Calls f(k) with each kind's number as a constant.
  template <class F>
  static void for_each_kind(const F& f) {
    [&f]<std::size_t... k>(std::index_sequence<k...> /*all*/) {
      (f(std::integral_constant<std::size_t, k>()), ...);
    }
    (std::index_sequence_for<Kinds...>());
  }

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    for (auto& times : self.times_) {
      const std::size_t number = times.size();
      archive(times);
      const bool fits = std::none_of(times.begin(), times.end(), [](double time) { return std::isnan(time); });
      expect(archive, times.size() == number && fits, "the times of added events");
    }
  }

 private:
  std::tuple<Kinds...> kinds_;
  std::array<LargeVector<double>, sizeof...(Kinds)> times_;  ///< times of each kind, for each body
};

}  // namespace ed::internal
