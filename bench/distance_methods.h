#pragma once

/// Comparison of all methods for the distance of two ellipsoids on the same pairs: this library's, the paper's from
/// each seed, other libraries'.

#include <map>
#include <string>

namespace bench {

inline constexpr int kMethodPairs = 1000;

/// Registers one benchmark for each method and gap, each a pass over kMethodPairs pairs.
void register_method_benchmarks();

/// Prints time and accuracy of each method; `ns`: time of a pair by the benchmark's name. Benchmarks that the filter
/// left out are not in `ns` and not printed.
void print_method_table(const std::map<std::string, double>& ns);

}  // namespace bench
