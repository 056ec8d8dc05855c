#pragma once

#include "run_record.h"

#include <string>

namespace hardbody {

/// summary.json: observables that the run was too short for are null, never NaN.
std::string summary_json(const RunRecord& record);

}  // namespace hardbody
