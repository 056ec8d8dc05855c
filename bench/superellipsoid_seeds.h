#pragma once

namespace bench {

/// Of superellipsoids: each seed, and the paper's Newton method from it, on the same pairs. Counters: seconds a pair,
/// pairs declined, and the largest error of the distance (a seed's: between its points) over the size of the pair.
void register_seed_benchmarks();

}  // namespace bench
