#pragma once

#include <cstdint>
#include "base/archive.h"

namespace ed::internal {

/// When the next events of a body come. Bodies keep it for the event loop: next to the motion, where that is small.
struct BodyEvents {
  static constexpr std::int32_t kExit = -1;

  double exit = 0;             ///< lower bound of when the body leaves its envelope
  std::int32_t first = kExit;  ///< what its calendar entry is: a pair, or kExit

  template <class Archive, class Self>
  static void fields(Archive& archive, Self& self) {
    archive(self.exit, self.first);
  }
};

}  // namespace ed::internal
