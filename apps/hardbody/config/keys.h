#pragma once

/// Table of a config's keys. It drives reading and its messages, the names that are known, the text of config.toml and
/// of `hardbody init`, the comparison of two configs, and docs/configuration.md, which a test compares with it.

#include "config/config.h"
#include "io/toml_document.h"

#include <cstddef>
#include <cstdint>
#include <functional>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Keys that other sources name too.
inline constexpr const char* kSeedKey = "seed";
inline constexpr const char* kNumberKey = "system.number";
inline constexpr const char* kPackingKey = "system.packing_fraction";
inline constexpr const char* kStartKey = "system.start";
inline constexpr const char* kOrderKey = "system.nematic_order";
inline constexpr const char* kStartFromKey = "system.start_from";
inline constexpr const char* kStartFileKey = "start.file";
inline constexpr const char* kStartFrameKey = "start.frame";
inline constexpr const char* kMendKey = "start.mend";
inline constexpr const char* kInertiaKey = "dynamics.inertia";
inline constexpr const char* kFinderKey = "dynamics.finder";
inline constexpr const char* kDistanceKey = "dynamics.distance";
inline constexpr const char* kSpacingKey = "output.frames_spacing";
inline constexpr const char* kFramesKey = "output.frames";
inline constexpr const char* kEveryKey = "output.frames_every";

inline constexpr std::int64_t kMostBodies = 1'000'000;

/// Config that a value belongs to; for values of bodies also the species.
struct Place {
  const Config& config;
  const SpeciesConfig* species = nullptr;
};

/// Config that values are read into, as Place.
struct Target {
  Config& config;
  SpeciesConfig* species = nullptr;

  operator Place() const { return {config, species}; }
};

/// Reason why a value is not taken: "key is VALUE{why}; accepted: {accepted}".
struct Refusal {
  std::string accepted;
  std::string why = {};
};

using Taken = std::optional<Refusal>;  ///< nullopt: the value has been taken

/// Rule of a key: how a value becomes a member of Config, and how that member is written and compared.
struct Rule {
  /// Takes a value into its member, if it is accepted.
  std::function<Taken(const Value&, const Target&)> take;
  /// Returns the member as TOML; empty: it has no value.
  std::function<std::string(const Place&)> text;
  /// Whether the member is the same in two configs.
  std::function<bool(const Place&, const Place&)> same;
};

/// Comment of a key in config.toml, lines separated by '\n'; it names the unit.
struct Comment {
  std::function<std::string(const Place&)> at;

  Comment(const char* text) : at([text](const Place&) { return text; }) {}
  template <class F>
  Comment(F text) : at(text) {}
};

struct Key {
  std::string name;        ///< section.key; of a [[species]] species.key
  std::string_view usual;  ///< default, as docs/configuration.md has it; empty: none
  Rule rule;
  Comment comment;
  bool (*written)(const Place&) = nullptr;  ///< whether it belongs into config.toml; nullptr: always
  const char* without = "";                 ///< comment in config.toml where the key has no value
  bool may_change = false;                  ///< whether hardbody resume --set may change it, which changes no result
};

/// Returns the table, in the order of config.toml.
const std::vector<Key>& keys();

/// Returns the keys of the shape in a section, "shape" or "species".
std::vector<Key> form_keys(const std::string& section);

/// Returns the last part of the table: the keys of [equilibration], [production] and [output].
std::vector<Key> run_keys();

/// Refuses sections and keys that no config has, with the nearest known name. Throws InputError.
void check_names(const TomlDocument& document);

/// Refuses assignments, key=value, to keys that a run which has begun may not change. Throws InputError.
void check_may_change(const std::vector<std::string>& overrides);

/// Returns the section of a name: "species" of species.mass; empty for keys at the top.
std::string_view section_of(std::string_view name);

/// Returns species.mass of species[2].mass; other names as they are.
std::string without_index(std::string_view name);

/// Returns the name of a species' section in a document: "species[2]" for index 1.
std::string species_name(std::size_t index);

/// Reads `entry` by the rule of the key that the table calls `name`. Throws InputError.
void read_entry(const Entry& entry, std::string_view name, const Target& target);

/// Reads the key, if the document has it.
void read_key(const TomlDocument& document, std::string_view name, const Target& target);

/// Reads all keys of a section that the document has, but inertia, which has rules of its own. `section`: as the
/// document calls it, "species[2]".
void read_section(const TomlDocument& document, const std::string& section, const Target& target);

/// Returns the refusal of a document without the key `name`; `where`: place to blame; `of`: " of a superellipsoid".
InputError missing(const std::string& where, const std::string& name, const Target& target, std::string_view of = "");

/// Key of a config in its place.
struct PlacedKey {
  std::string name;  ///< name in a document: species[2].mass
  const Key* key;
  Place place;
};

/// Returns the keys that belong into the config.toml of a config, those without a value included.
std::vector<PlacedKey> keys_of(const Config& config);

/// Key whose value is not the same in two configs; "nothing" where it has none.
struct Difference {
  std::string key;
  std::string here;
  std::string there;
};

/// Returns the first difference that may change results; nullopt if all keys that may have the same values.
std::optional<Difference> difference(const Config& here, const Config& there);

}  // namespace hardbody
