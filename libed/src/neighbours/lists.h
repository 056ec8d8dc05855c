#pragma once

#include "base/archive.h"
#include "base/large_vector.h"
#include "base/prefetch.h"
#include "bodies/pair.h"

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <span>
#include <unordered_map>
#include <vector>

namespace ed::internal {

/// Neighbour lists: a pool of pairs, and for each body the pairs that it is in.
class NeighbourLists {
 public:
  explicit NeighbourLists(int number) : lengths_(static_cast<std::size_t>(number), 0) {}

  std::span<const std::int32_t> of(int body) const {
    const std::size_t length = lengths_[static_cast<std::size_t>(body)];
    if (length > room_) [[unlikely]]
      return long_.at(body);
    return {slots_.data() + static_cast<std::size_t>(body) * room_, length};
  }
  Pair& pair(std::int32_t index) { return pairs_[static_cast<std::size_t>(index)]; }
  const Pair& pair(std::int32_t index) const { return pairs_[static_cast<std::size_t>(index)]; }
  int number() const { return static_cast<int>(lengths_.size()); }

  /// Prefetches the list of the body.
  void fetch(int body) const {
    prefetch(lengths_[static_cast<std::size_t>(body)]);
    prefetch_line(slots_.data() + static_cast<std::size_t>(body) * room_);
  }

  /// Adds a pair of neighbours, owned by i, and returns its index.
  std::int32_t add(std::int32_t i, std::int32_t j, const Eigen::Vector3d& normal);
  /// Removes all pairs of a body, in the order of its list, each after `removing(index, partner)`.
  template <class Removing>
  void drop(std::int32_t body, const Removing& removing) {
    for (const std::int32_t index : of(body)) {
      const Pair& p = pair(index);
      const std::int32_t partner = p.partner(body);
      removing(index, partner);
      unlink(partner, p.i == partner ? p.slot_i : p.slot_j);
      free_.push_back(index);
    }
    lengths_[static_cast<std::size_t>(body)] = 0;
  }

  /// Makes room for lists to become twice as long as the longest is now, so that none has to grow while a run goes on.
  /// Returns that length.
  std::size_t reserve();

  /// Indices, slots and the order of everything as they are; read into lists of the same number of bodies.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.pairs_, self.free_);
    if constexpr (Archive::kReads) {
      std::vector<std::vector<std::int32_t>> lists;
      archive(lists);
      const bool fits = std::all_of(lists.begin(), lists.end(), [&](const auto& l) { return l.size() < lists.size(); });
      expect(archive, fits && lists.size() == self.lengths_.size(), "the neighbour lists of the bodies");
      self.assign(lists);
      expect(archive, self.linked(), "the neighbour lists do not fit together");
    } else {
      archive(std::uint64_t{self.lengths_.size()});
      for (int body = 0; body < self.number(); ++body) {
        const auto list = self.of(body);
        archive(std::vector<std::int32_t>(list.begin(), list.end()));
      }
    }
  }

  /// Returns whether the pair is one of this body's.
  bool lists(std::int32_t body, std::int32_t index) const;

 private:
  bool linked() const;
  std::int32_t append(std::int32_t body, std::int32_t index);
  void unlink(std::int32_t body, std::int32_t slot);
  void assign(const std::vector<std::vector<std::int32_t>>& lists);
  void make_room(std::size_t room);
  std::size_t most_room() const;
  /// Returns the list of a body, which fits its room.
  std::int32_t* list_of(std::size_t body) { return slots_.data() + body * room_; }

  LargeVector<Pair> pairs_;
  LargeVector<std::int32_t> free_;
  // A list stands where its body's number says: no pointer has to be read first. Lists that are longer than most, those
  // of the largest bodies of a mixture, stand elsewhere: with room for them at every body memory would be theirs.
  std::size_t room_ = 0;                                              ///< room for each list
  LargeVector<std::int32_t> slots_;                                   ///< room_ for each body
  LargeVector<std::uint32_t> lengths_;                                ///< lengths of the lists
  std::unordered_map<std::int32_t, std::vector<std::int32_t>> long_;  ///< whole lists; those of shorter ones are stale
};

}  // namespace ed::internal
