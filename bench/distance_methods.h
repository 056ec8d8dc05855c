#pragma once

/// Every way to the distance of two ellipsoids, on the same pairs: ours, the paper's from each seed, other libraries'.

#include <map>
#include <string>

namespace bench {

inline constexpr int kMethodPairs = 1000;

/// Registers one benchmark a method and gap, each a pass over kMethodPairs pairs.
void register_method_benchmarks();

/// Time and accuracy of each, `ns` a pair by the benchmark's name; what the filter left out is not in `ns` nor printed.
void print_method_table(const std::map<std::string, double>& ns);

}  // namespace bench
