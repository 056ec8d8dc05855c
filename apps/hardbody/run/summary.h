#pragma once

#include "io/run_directory.h"
#include "run/record.h"

#include <nlohmann/json_fwd.hpp>

#include <string>

namespace hardbody {

/// summary.json: observables without a value are null, never NaN, and say why.
std::string summary_json(const RunRecord& record);

/// Returns the summary in a run's directory; null if there is none, or it is damaged.
nlohmann::json stored_summary(const RunDirectory& directory);

}  // namespace hardbody
