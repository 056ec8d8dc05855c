#pragma once

namespace ed {

/// Version of the arithmetic of a run, raised with every change that alters bits of some run (those whose hashes are in
/// tests/golden, and others). A saved state can only be resumed with the same version.
inline constexpr int kArithmetic = 19;

}  // namespace ed
