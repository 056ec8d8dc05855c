#pragma once

/// Texts for missing values: the reason, and what would help.

#include <ed/analysis.h>
#include <ed/observables.h>

#include <string>

namespace hardbody {

struct Part;
struct RunRecord;

/// Words that depend on the source of the values.
struct MissingWords {
  std::string length_unit = "l";
  std::string longer_lags;       ///< advice for longer lags: "a longer run helps"
  std::string end_of_ballistic;  ///< advice where the lag that fits begin with is unknown; empty: none
  std::string unwrapping;        ///< advice where positions are wrapped; empty: none
  std::string following;         ///< advice where bodies are not numbered; empty: none
};

/// Returns the words for the values of a run.
MissingWords missing_words(const RunRecord& record);

/// Returns the reason, and what would help, in one sentence without a full stop.
std::string missing_text(const ed::Missing& missing, const MissingWords& words);

/// Returns whether longer lags may give one of the values of a part that tables show.
bool longer_lags_help(const Part& part);

}  // namespace hardbody
