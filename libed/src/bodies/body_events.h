#pragma once

#include "base/archive.h"

#include <cmath>
#include <cstdint>

namespace ed::internal {

/// Times of the next events of a body. Bodies keep it for the event loop, beside the motion where that is small.
struct BodyEvents {
  static constexpr std::int32_t kExit = -1;

  double exit = 0;             ///< lower bound of the time when the body leaves its envelope
  std::int32_t first = kExit;  ///< event of its calendar entry: a pair's index, kExit, or an added one (added_events.h)

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.exit, self.first);
    expect(archive, !std::isnan(self.exit), "the exit of a body is not a number");
  }
};

}  // namespace ed::internal
