#pragma once

/// Why a value is missing, as the program prints it.

#include "run/record.h"

#include <ed/analysis.h>
#include <ed/observables.h>

#include <string>

namespace hardbody {

/// Words that depend on where the values are from.
struct MissingWords {
  std::string length_unit = "l";
  std::string longer_lags;       ///< what to do for longer lags: "a longer run helps"
  std::string end_of_ballistic;  ///< what to do where the lag that fits begin with is unknown; empty: nothing
  std::string unwrapping;        ///< what to do where positions are wrapped; empty: nothing
  std::string following;         ///< what to do where bodies are not numbered; empty: nothing
};

/// Words for the values of a run.
MissingWords missing_words(const RunRecord& record);

/// The reason, and what would help, in one sentence without a full stop.
std::string missing_text(const ed::Missing& missing, const MissingWords& words);

/// Whether longer lags may give one of the values of `results`.
bool longer_lags_help(const ed::GroupResults& results);

}  // namespace hardbody
