#pragma once

namespace ed {

/// Which arithmetic a run is made with: raised with every change that alters bits of some run (those that the hashes of
/// tests/golden show, and others). A state goes on with the same arithmetic or not at all.
inline constexpr int kArithmetic = 13;

}  // namespace ed
