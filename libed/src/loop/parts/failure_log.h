#pragma once

#include "base/archive.h"

#include <ed/archive_simulation.h>
#include <ed/simulation.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstdint>
#include <tuple>
#include <vector>

namespace ed::internal {

/// The first pairs that could not be predicted as they should, at most kMaxRecorded for each reason.
class FailureLog {
 public:
  static constexpr std::size_t kMaxRecorded = 16;

  /// `species_of`: number of each body's species. Both must outlive this.
  FailureLog(const std::vector<Species>& species, const std::vector<int>& species_of)
      : species_(&species), species_of_(&species_of) {
    pairs_.reserve(kReasons * kMaxRecorded);
  }

  const std::vector<FailedPair>& pairs() const { return pairs_; }

  /// Returns a new entry, with reason, numbers and shapes set; null if there is no more room for this reason. Copies
  /// of users' shapes may allocate; nothing else does.
  FailedPair* add(FailureReason reason, int i, int j) {
    std::size_t& recorded = recorded_[static_cast<std::size_t>(reason)];
    if (recorded == kMaxRecorded) return nullptr;
    ++recorded;
    FailedPair& failed = pairs_.emplace_back();  // reserved
    failed.reason = reason;
    failed.i = i;
    failed.j = j;
    set_shapes(failed);
    return &failed;
  }

  /// Numbers of recorded pairs by reason; states hold them apart from the pairs.
  template <class Self>
  static auto members(Self& self) {
    return std::tie(self.recorded_);
  }

  void save(Writer& writer) const {
    writer(std::uint64_t{pairs_.size()});
    for (const FailedPair& failed : pairs_) fields_but_shapes(writer, failed);
  }
  void load(Reader& reader) {
    const auto number = reader.value<std::uint64_t>();
    expect(reader, number <= kReasons * kMaxRecorded, "the failed pairs");
    const auto bodies = static_cast<int>(species_of_->size());
    for (std::uint64_t k = 0; k < number; ++k) {
      FailedPair& failed = pairs_.emplace_back();
      fields_but_shapes(reader, failed);
      expect(reader, std::min(failed.i, failed.j) >= 0 && std::max(failed.i, failed.j) < bodies, "a failed pair");
      set_shapes(failed);
    }
  }

 private:
  static constexpr std::size_t kReasons = 1 + static_cast<std::size_t>(FailureReason::declined);

  const BodyShape& shape_of(int i) const {
    const int species = (*species_of_)[static_cast<std::size_t>(i)];
    return (*species_)[static_cast<std::size_t>(species)].shape;
  }
  void set_shapes(FailedPair& failed) const {
    failed.shape_i = shape_of(failed.i);
    failed.shape_j = shape_of(failed.j);
  }

  const std::vector<Species>* species_;
  const std::vector<int>* species_of_;
  std::vector<FailedPair> pairs_;
  std::array<std::size_t, kReasons> recorded_{};  ///< numbers of recorded pairs by reason
};

}  // namespace ed::internal
