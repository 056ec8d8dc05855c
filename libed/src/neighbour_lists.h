#pragma once

#include <ed/internal/archive.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <limits>
#include <vector>

namespace ed::internal {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// What is known of a pair of neighbours.
enum class PairEvent : std::int32_t {
  clear,    ///< certified: no contact while both bodies stay in their envelopes (up to the earlier exit bound)
  bound,    ///< certified: no contact before `time`; to be looked at again then
  contact,  ///< they touch at `time`
};

struct Pair {
  double time = kNever;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< from i to j: the last one found, or zero
  std::int32_t i = -1;
  std::int32_t j = -1;
  std::int32_t slot_i = -1;  ///< where the pair stands in the list of i
  std::int32_t slot_j = -1;
  std::int32_t owner = -1;  ///< in whose calendar entry the pair counts: i or j
  PairEvent event = PairEvent::clear;

  std::int32_t partner(std::int32_t body) const { return i == body ? j : i; }
};

template <class Archive, Is<Pair> T>
void fields(Archive& archive, T& pair) {
  archive(pair.time, pair.normal, pair.i, pair.j, pair.slot_i, pair.slot_j, pair.owner, pair.event);
}

/// Neighbour lists: a pool of pairs, and for each body the pairs that it is in.
class NeighbourLists {
 public:
  explicit NeighbourLists(int number) : of_body_(static_cast<std::size_t>(number)) {}

  const std::vector<std::int32_t>& of(int body) const { return of_body_[static_cast<std::size_t>(body)]; }
  Pair& pair(std::int32_t index) { return pairs_[static_cast<std::size_t>(index)]; }
  const Pair& pair(std::int32_t index) const { return pairs_[static_cast<std::size_t>(index)]; }
  int number() const { return static_cast<int>(of_body_.size()); }

  /// A new pair of neighbours, owned by i; returns its index.
  std::int32_t add(std::int32_t i, std::int32_t j, const Eigen::Vector3d& normal);
  void remove(std::int32_t index);

  /// Makes room for every list to become twice as long as the longest is now, so that none has to grow while a run goes
  /// on. Returns that length.
  std::size_t reserve();

  /// Indices, slots and the order of everything as they are; read into lists of the same number of bodies.
  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    const std::size_t number = self.of_body_.size();
    archive(self.pairs_, self.free_, self.of_body_);
    expect(archive, self.of_body_.size() == number && self.linked(), "the neighbour lists do not fit together");
  }

  /// Whether the pair is one of this body's.
  bool lists(std::int32_t body, std::int32_t index) const;

 private:
  bool linked() const;
  void unlink(std::int32_t body, std::int32_t slot);

  std::vector<Pair> pairs_;
  std::vector<std::int32_t> free_;
  std::vector<std::vector<std::int32_t>> of_body_;
};

}  // namespace ed::internal
