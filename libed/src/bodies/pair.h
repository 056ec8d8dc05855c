#pragma once

#include "base/archive.h"

#include <Eigen/Core>

#include <cstdint>
#include <limits>

namespace ed::internal {

inline constexpr double kNever = std::numeric_limits<double>::infinity();

/// Kind of a pair's next event.
enum class PairEvent : std::int32_t {
  clear,    ///< certified: no contact while both bodies stay in their envelopes (up to the earlier exit bound)
  bound,    ///< search from `time` on; certified: no contact before
  contact,  ///< contact at `time`
};

/// A pair of neighbours. It is one cache line: a collision reads tens of pairs, each somewhere else in memory.
struct alignas(64) Pair {
  double time = kNever;
  Eigen::Vector3d normal = Eigen::Vector3d::Zero();  ///< last one found, from i to j, or zero
  std::int32_t i = -1;
  std::int32_t j = -1;
  std::int32_t slot_i = -1;  ///< place of the pair in the list of i
  std::int32_t slot_j = -1;
  std::int32_t owner = -1;  ///< body in whose calendar entry the pair counts: i or j
  PairEvent event = PairEvent::clear;

  std::int32_t partner(std::int32_t body) const { return i == body ? j : i; }
};

template <class Archive, Is<Pair> T>
void fields(Archive& archive, T& pair) {
  archive(pair.time, pair.normal, pair.i, pair.j, pair.slot_i, pair.slot_j, pair.owner, pair.event);
}

static_assert(sizeof(Pair) == 64);

}  // namespace ed::internal
