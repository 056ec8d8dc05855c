#pragma once

/// Observables as JSON. Private to the sources that write JSON: it brings the library along.

#include "registry/observables.h"
#include "run/missing.h"

#include <nlohmann/json.hpp>

namespace hardbody {

enum class Measured { in_run, in_frames };

/// Returns the observables of a part under their keys, in the order of summary.json; in_frames: only those that stored
/// frames tell. A number is {"value": ..., "error": ...}; without a value it has the reason, "missing": "...".
nlohmann::ordered_json observables_json(const Part& part, const MissingWords& words, Measured measured);

}  // namespace hardbody
