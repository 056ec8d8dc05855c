#pragma once

/// What the report says of a run. Private to the report's sources: it brings the JSON library along.

#include "config/config.h"
#include "report/curves.h"
#include "report/view.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// A number that a reader looks for first.
struct Headline {
  std::string key;      ///< in summary.json; with the axis behind it for a body axis
  std::string symbol;   ///< what follows an underscore is an index
  std::string name;     ///< in words
  std::string unit;     ///< empty: a pure number
  std::string meaning;  ///< its definition
  double value;         ///< NaN: there is none
  double error;         ///< standard
  std::string missing;  ///< why there is no value; empty where the summary does not say
};

/// Something about the run that a reader must know.
struct Remark {
  enum class Kind { good, warning, bad };
  Kind kind;
  std::string label;  ///< two or three words
  std::string text;   ///< a sentence
};

struct SpeciesReport {
  std::string title;
  std::vector<Headline> headlines;
};

struct RunReport {
  std::filesystem::path path;
  std::string name;   ///< of the directory
  std::string title;  ///< what was simulated
  Config config;
  std::string config_text;
  std::string log;
  nlohmann::json summary;  ///< null: there is none
  std::vector<Remark> remarks;
  std::vector<Headline> headlines;
  std::vector<SpeciesReport> species;  ///< of a mixture
  std::vector<Curves> curves;
  std::optional<View> view;
  long rotational_freedoms = 0;  ///< that kT_rot is taken on

  const Curves* find(std::string_view file) const;
};

enum class WithView { no, yes };

/// Throws InputError if the directory holds no run, or a file that cannot be read.
RunReport read_run_report(const std::filesystem::path& directory, WithView with_view);

/// "512 hard ellipsoids, X0 = 3, packing fraction 0.4"
std::string title_of(const Config& config);

/// What a key of `observables` is called; of an unknown one the key itself.
Headline headline_named(const std::string& key);

/// Those of `observables` in a summary that it has, in the order of interest.
std::vector<Headline> headlines_of(const nlohmann::json& observables);

/// "0.1729 +- 0.0033"; without a value, why there is none.
std::string headline_text(const Headline& headline);

}  // namespace hardbody
