#pragma once

/// Observables as JSON. Private to the sources that write JSON: it brings the library along.

#include "registry/observables.h"
#include "run/missing.h"

#include <nlohmann/json.hpp>

namespace hardbody {

/// Source of observables: a run, or stored frames, which tell some of them only.
enum class Source { run, frames };

/// Returns the observables of a part under their keys, in the order of summary.json; Source::frames: only those that
/// stored frames tell. A number is {"value": ..., "error": ...}; without a value it has the reason, "missing": "...".
nlohmann::ordered_json observables_json(const Part& part, const MissingWords& words, Source source);

}  // namespace hardbody
