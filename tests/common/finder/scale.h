#pragma once

#include <common/full_form.h>

namespace finder_test {

/// Returns the number of draws: `count`, `full` in the full form, or a tenth of `count` in a slow build and in the
/// quick form.
inline int scaled(int count, int full) {
  return full_form() ? full : repetitions(count);
}

}  // namespace finder_test
