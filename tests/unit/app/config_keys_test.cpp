#include "config/keys.h"
#include "config/rules.h"
#include "io/text_file.h"

#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include <filesystem>
#include <map>
#include <regex>
#include <sstream>
#include <string>

namespace {

using hardbody::Config;
using hardbody::Key;
using hardbody::PlacedKey;

constexpr const char* kOneShape = "[system]\npacking_fraction = 0.1\n[shape]\naspect_ratio = 2\n";
constexpr const char* kOneSpecies = "[system]\npacking_fraction = 0.1\n[[species]]\naspect_ratio = 2\n";

using Defaults = std::map<std::string, std::string>;

/// Adds the keys of a row of docs/configuration.md; `section` is that of the row, which may begin another one.
void add_row(const std::string& row, std::string& section, Defaults& defaults) {
  static const std::regex cells(R"(^\|([^|]*)\|([^|]*)\|)");
  static const std::regex names(R"(`([^`]*)`)");
  static const std::regex link(R"(\[([^\]]*)\]\([^)]*\))");
  std::smatch found;
  if (!std::regex_search(row, found, cells)) return;
  const std::string keys = found[1];
  std::string usual = std::regex_replace(std::regex_replace(found[2].str(), link, "$1"), std::regex("^ +| +$|`"), "");
  for (auto name = std::sregex_iterator(keys.begin(), keys.end(), names); name != std::sregex_iterator(); ++name) {
    const std::string text = (*name)[1];
    if (text.starts_with("[")) {
      section = text.substr(1, text.size() - 2) + ".";
    } else {
      defaults[section + text] = usual;
    }
  }
}

/// Reads the tables of keys in docs/configuration.md.
Defaults documented() {
  const std::filesystem::path file = std::filesystem::path(HARDBODY_REFERENCE_DIR) / "../../docs/configuration.md";
  std::istringstream lines(hardbody::read_file(file, 1 << 20));
  Defaults defaults;
  std::string section;
  bool in_table = false;
  for (std::string line; std::getline(lines, line);) {
    if (line.starts_with("| key ")) {
      in_table = true;
      section = line.find("[[species]]") == std::string::npos ? "" : "species.";
    } else if (in_table && !line.starts_with("|")) {
      in_table = false;
    } else if (in_table) {
      add_row(line, section, defaults);
    }
  }
  return defaults;
}

TEST(ConfigKeys, StandInTheDocumentationWithTheirDefaults) {
  Defaults table;
  for (const Key& key : hardbody::keys()) table[std::string(key.name)] = key.usual;
  EXPECT_THAT(documented(), testing::ContainerEq(table));
}

/// Returns the value of a TOML text; an "other" if it is none.
hardbody::Value value_of(std::string_view text) {
  try {
    return hardbody::read_toml("x = " + std::string(text), "value", {}).entries.at(0).value;
  } catch (const hardbody::InputError&) {
    return {};
  }
}

TEST(ConfigKeys, HaveTheDefaultsThatTheTableNames) {
  int compared = 0;
  for (const char* text : {kOneShape, kOneSpecies}) {
    const Config config = hardbody::parse_config(text, "memory");
    for (const PlacedKey& key : hardbody::keys_of(config)) {
      const hardbody::Value usual = value_of(key.key->usual);
      if (usual.kind == hardbody::Value::Kind::other) continue;  // words, or none
      if (key.name == "dynamics.neighbours") continue;           // what "auto" has chosen
      EXPECT_TRUE(same_value(value_of(key.key->rule.text(key.place)), usual)) << key.name;
      ++compared;
    }
  }
  EXPECT_GT(compared, 20);
}

TEST(ConfigKeys, RefuseAValueOfNoKindNamingWhatIsAccepted) {
  for (const Key& key : hardbody::keys()) {
    Config config = hardbody::parse_config(kOneSpecies, "memory");
    config.start_file.emplace();
    config.species[0].sizes = ed::SizeDistribution::uniform;
    const hardbody::Taken taken = key.rule.take({}, {config, &config.species[0]});
    ASSERT_TRUE(taken.has_value()) << key.name;
    EXPECT_FALSE(taken->accepted.empty()) << key.name;
  }
}

TEST(ConfigKeys, AreReadWhereverTheyMayStand) {
  // A date is a value of no kind: a key that takes it has not been read.
  for (const Key& key : hardbody::keys()) {
    const std::string name(key.name);
    if (name.starts_with("species.")) continue;  // read with those of the shape
    std::map<std::string, std::map<std::string, std::string>> sections = {{"system", {{"packing_fraction", "0.1"}}},
                                                                          {"shape", {{"aspect_ratio", "2"}}}};
    const std::size_t dot = name.find('.');
    const std::string section = dot == std::string::npos ? "" : name.substr(0, dot);
    sections[section][dot == std::string::npos ? name : name.substr(dot + 1)] = "1979-05-27";
    std::string text;
    for (const auto& [head, entries] : sections) {
      if (!head.empty()) text += "[" + head + "]\n";
      for (const auto& [entry, value] : entries) text += entry + " = " + value + "\n";
    }
    try {
      (void)hardbody::parse_config(text, "memory");
      ADD_FAILURE() << name << " is accepted and not read";
    } catch (const hardbody::InputError& error) {
      EXPECT_THAT(error.what(), testing::HasSubstr(name)) << text;
    }
  }
}

TEST(ConfigKeys, AreComparedByTheirValues) {
  const auto parse = [](const std::string& more) { return hardbody::parse_config(kOneShape + more, "memory"); };
  const Config config = parse("");
  EXPECT_FALSE(difference(config, parse("[production]\ntime = \"auto\"\n")).has_value());
  EXPECT_FALSE(difference(config, parse("[dynamics]\nneighbours = \"cells\"\n")).has_value());
  const auto found = difference(config, parse("[output]\ntrajectory = [\"vtk\"]\n"));
  ASSERT_TRUE(found.has_value());
  EXPECT_EQ(found->key, "output.trajectory");
  EXPECT_EQ(found->here, "[]");
  EXPECT_EQ(found->there, "[\"vtk\"]");
  const auto missing = difference(config, parse("[production]\ntarget_error = 0.1\n"));
  ASSERT_TRUE(missing.has_value());
  EXPECT_EQ(missing->here, "nothing");
  const auto species = difference(hardbody::parse_config(kOneSpecies, "memory"), config);
  ASSERT_TRUE(species.has_value());
  EXPECT_EQ(species->key, "species[1].kind");
}

}  // namespace
