#pragma once

#include "run_record.h"

#include <ed/analysis.h>

#include <string>

namespace hardbody {

/// "0.2887 +- 0.0018": the error with two significant digits, the value with as many decimals; "-" for a
/// value that the run was too short for.
std::string format_estimate(const ed::Estimate& estimate);

/// A run's headline numbers, with units and conventions, as shown on the terminal.
std::string results_table(const RunRecord& record, const std::string& directory);

}  // namespace hardbody
