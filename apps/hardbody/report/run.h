#pragma once

/// Data of a run in the report. Private to the report's sources, because it includes the JSON library.

#include "config/config.h"
#include "report/curves.h"
#include "report/view.h"

#include <nlohmann/json.hpp>

#include <filesystem>
#include <optional>
#include <string>
#include <vector>

namespace hardbody {

/// Number that a reader looks for first.
struct Headline {
  std::string key;      ///< key in summary.json; of a body axis with the axis appended
  std::string symbol;   ///< symbol; the part after an underscore is an index
  std::string name;     ///< name in words
  std::string unit;     ///< unit; empty: a pure number
  std::string meaning;  ///< definition
  double value;         ///< value; NaN: there is none
  double error;         ///< standard error
  std::string missing;  ///< reason for which there is no value; empty if the summary does not give it
};

/// Remark about the run that a reader must know.
struct Remark {
  enum class Kind { good, warning, bad };
  Kind kind;
  std::string label;  ///< two or three words
  std::string text;   ///< a sentence
};

/// Returns the name, "good", ..
const char* to_string(Remark::Kind kind);

struct SpeciesReport {
  std::string title;
  bool oriented = true;  ///< false: spheres, of which nothing about orientation or rotation is shown
  std::vector<Headline> headlines;
};

struct RunReport {
  std::filesystem::path path;
  std::string name;   ///< name of the directory
  std::string title;  ///< description of the simulated system
  Config config;
  std::string config_text;
  std::string log;
  nlohmann::json summary;  ///< null: there is none
  std::vector<Remark> remarks;
  std::vector<Headline> headlines;
  std::vector<SpeciesReport> species;  ///< species of a mixture
  std::vector<Curves> curves;
  std::optional<View> view;
  bool oriented = true;          ///< false: all bodies are spheres
  long rotational_freedoms = 0;  ///< rotational degrees of freedom on which kT_rot is taken

  const Curves* find(std::string_view file) const;
};

enum class WithView { no, yes };

/// Reads a run. Throws InputError if the directory holds no run, or a file that cannot be read.
RunReport read_run_report(const std::filesystem::path& directory, WithView with_view);

/// Returns the member of an object; null if it has none of that name, or is no object.
const nlohmann::json& member(const nlohmann::json& json, const char* key);

/// Returns the last part of a directory's path, also for out/run/.
std::string name_of(const std::filesystem::path& directory);

/// Returns "512 hard ellipsoids, X0 = 3, packing fraction 0.4".
std::string title_of(const Config& config);

/// Returns the name, symbol, unit and meaning of a key of `observables`; for an unknown key the key itself.
Headline headline_named(const std::string& key);

/// Returns the headlines that the `observables` of a summary contain, in the order of interest; of bodies that are not
/// `oriented` those that are not about orientation.
std::vector<Headline> headlines_of(const nlohmann::json& observables, bool oriented);

/// Returns "0.1729 +- 0.0033"; without a value, the reason.
std::string headline_text(const Headline& headline);

}  // namespace hardbody
