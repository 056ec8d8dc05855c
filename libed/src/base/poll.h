#pragma once

#include <functional>

namespace ed::internal {

/// Calls `poll`, unless it is empty, for one in 256 consecutive bodies: their work is some milliseconds.
inline void poll_at(int body, const std::function<void()>& poll) {
  if (body % 256 == 0 && poll) poll();
}

}  // namespace ed::internal
