#pragma once

#include "run/record.h"

#include <ed/analysis.h>

#include <string>
#include <vector>

namespace hardbody {

/// "0.2887 +- 0.0018": the error with two significant digits, the value with as many decimals; "-" for a
/// missing value.
std::string format_estimate(const ed::Estimate& estimate);

/// Returns a director as tables show it: "(0.013, 0.002, 1.000) +- 0.004".
std::string format_director(const ed::Director& director);

/// A run's headline numbers, with units and conventions, as shown on the terminal; `files`: where the rest was written.
std::string results_table(const RunRecord& record, const std::vector<std::string>& files);

}  // namespace hardbody
