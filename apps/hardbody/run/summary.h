#pragma once

#include "run/record.h"

#include <string>

namespace hardbody {

/// summary.json: observables without a value are null, never NaN, and say why.
std::string summary_json(const RunRecord& record);

}  // namespace hardbody
