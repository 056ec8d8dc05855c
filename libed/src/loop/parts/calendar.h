#pragma once

#include "base/archive.h"
#include "base/large_vector.h"
#include "base/prefetch.h"

#include <algorithm>
#include <array>
#include <bit>
#include <cassert>
#include <cmath>
#include <cstddef>
#include <limits>
#include <vector>

namespace ed::internal {

/// Event calendar: finds the body with the earliest event, in O(log N) operations for each update.
///
/// It is a tournament of eights. The times of eight bodies' earliest events stand in one cache line, the earliest of
/// each eight in a line of the next level, and so on up to a single line. Ties go to the body with the lower number.
class Calendar {
 public:
  static constexpr int kFewestInParts = 64;  ///< eight lines of eight

  explicit Calendar(int number) : number_(static_cast<std::size_t>(number)) {
    std::size_t groups = number_;
    do {
      first_of_level_.push_back(groups_.size());
      groups = (groups + kGroup - 1) / kGroup;
      groups_.resize(groups_.size() + groups);
    } while (groups > 1);
    for (std::size_t entries = number_; entries >= kFewestInParts; entries = (entries + kGroup - 1) / kGroup) {
      ++level_of_parts_;
    }
  }

  double time(int i) const { return groups_[at(i) / kGroup].times[at(i) % kGroup]; }

  void set(int i, double time) {
    std::size_t k = at(i);
    for (const std::size_t first : first_of_level_) {
      Group& group = groups_[first + k / kGroup];
      double& old = group.times[k % kGroup];
      // Nothing changes above a group whose earliest time stays.
      if (old == time) return;
      old = time;
      time = group.earliest();
      k /= kGroup;
    }
  }

  /// Prefetches the place of body i's time.
  void fetch(int i) const { prefetch(groups_[at(i) / kGroup]); }

  /// Earliest time of some bodies that are numbered one after another; at level 0 of a single one.
  struct Entry {
    std::size_t level;
    std::size_t index;
  };
  /// Returns the number of parts, fewer than 64, into which all bodies are divided. Each part is an entry. Parts are
  /// single bodies if these are fewer than kFewestInParts.
  std::size_t parts() const {
    return level_of_parts_ == 0 ? number_ : first_of_level_[level_of_parts_] - first_of_level_[level_of_parts_ - 1];
  }
  Entry part(std::size_t k) const { return {level_of_parts_, k}; }
  double time(Entry e) const { return groups_[first_of_level_[e.level] + e.index / kGroup].times[e.index % kGroup]; }
  /// Returns the entry of the level below that has this one's time, for an entry above level 0.
  Entry earliest_below(Entry e) const {
    const Group& group = group_below(e);
    return {e.level - 1, kGroup * e.index + group.place_of(group.earliest())};
  }
  /// Prefetches what earliest_below(e) reads.
  void fetch_below(Entry e) const { prefetch(group_below(e)); }

  double earliest_time() const { return groups_.back().earliest(); }

  int earliest() const {
    const double time = earliest_time();
    std::size_t k = 0;
    for (std::size_t level = first_of_level_.size(); level-- > 0;) {
      k = kGroup * k + groups_[first_of_level_[level] + k].place_of(time);
    }
    return static_cast<int>(k);
  }

  /// The times; read into a calendar of the same number of bodies.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    std::vector<double> times;
    if constexpr (!Archive::kReads) {
      for (int i = 0; i < static_cast<int>(self.number_); ++i) times.push_back(self.time(i));
    }
    archive(times);
    if constexpr (Archive::kReads) {
      const bool fits = std::none_of(times.begin(), times.end(), [](double time) { return std::isnan(time); });
      expect(archive, times.size() == self.number_ && fits, "the times of the events");
      for (int i = 0; i < static_cast<int>(self.number_); ++i) self.set(i, times[at(i)]);
    }
  }

 private:
  static constexpr std::size_t kGroup = 8;
  static_assert(kFewestInParts == kGroup * kGroup);

  struct alignas(64) Group {
    std::array<double, kGroup> times;

    Group() { times.fill(std::numeric_limits<double>::infinity()); }
    double earliest() const {
      const auto& t = times;
      const auto least = [](double a, double b) { return b < a ? b : a; };
      return least(least(least(t[0], t[1]), least(t[2], t[3])), least(least(t[4], t[5]), least(t[6], t[7])));
    }
    /// The first place at which this time stands; the last, if it stands nowhere.
    std::size_t place_of(double time) const {
      unsigned places = 1U << (kGroup - 1);
      for (unsigned k = 0; k < kGroup - 1; ++k) places |= static_cast<unsigned>(times[k] == time) << k;
      return static_cast<std::size_t>(std::countr_zero(places));
    }
  };
  static_assert(sizeof(Group) == 64);

  static std::size_t at(int i) { return static_cast<std::size_t>(i); }
  const Group& group_below(Entry e) const {
    assert(e.level > 0);
    return groups_[first_of_level_[e.level - 1] + e.index];
  }

  std::size_t number_;  ///< number of bodies
  std::size_t level_of_parts_ = 0;
  std::vector<std::size_t> first_of_level_;  ///< first group of each level; the bodies' own level first
  LargeVector<Group> groups_;
};

}  // namespace ed::internal
