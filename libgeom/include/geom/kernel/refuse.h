#pragma once

#include <geom/export.h>

#include <string>

namespace geom::kernel {

/// Throws std::invalid_argument(message). A library compiled with -fno-exceptions writes the message to standard error
/// and calls std::abort instead. Headers throw by calling this, so that they compile with -fno-exceptions.
[[noreturn]] GEOM_EXPORT void refuse(const std::string& message);

}  // namespace geom::kernel
