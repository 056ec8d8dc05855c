#pragma once

namespace bench {

/// Registers benchmarks for superellipsoids: each seed, and the paper's Newton method from it, on the same pairs.
/// Counters: seconds a pair, pairs declined, and the largest error of the distance (for a seed, of the distance between
/// its points) over the size of the pair.
void register_seed_benchmarks();

}  // namespace bench
