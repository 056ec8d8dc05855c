#pragma once

#include "base/errors.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// A real as TOML writes it: the shortest digits that read back as the same number, and never an integer.
std::string toml_real(double x);

/// Returns a string as TOML, in quotes.
std::string toml_string(std::string_view text);

struct Member;

/// A value of a TOML file, as much of it as a config needs.
struct Value {
  enum class Kind { boolean, integer, real, text, array, table, other };
  Kind kind = Kind::other;
  std::int64_t integer = 0;
  double real = 0;  ///< also set for integers
  std::string text;
  std::vector<Value> items;     ///< of an array
  std::vector<Member> members;  ///< of a table, in the order of the file
  std::string shown;            ///< as TOML on one line, shortened, for messages

  const Member* find(std::string_view key) const;
};

struct Member {
  std::string key;
  int line = 0;
  Value value;
};

/// A value as TOML on one line, reals to the last bit.
std::string toml_text(const Value& value);

/// Whether a value is an integer or a real, and finite.
bool is_number(const Value& value);

/// Whether they are the same to a config: 2 and 2.0 are.
bool same_value(const Value& a, const Value& b);

/// A value and the place it came from.
struct Entry {
  std::string key;    ///< section.key, section[2].key of the second [[section]], or key at the top
  std::string where;  ///< file:line, or --set section.key=value: the start of every message about it
  int line = 0;       ///< 0: from the command line
  Value value;
};

struct Section {
  std::string name;      ///< section, or section[2]
  bool several = false;  ///< [[section]]
  std::string where;
  int line = 0;
};

/// Returns "file:line: key is what was got{why}; accepted: ..".
InputError bad(const Entry& entry, std::string_view accepted, std::string_view why = "");

/// A TOML file of two levels (keys at the top, keys in sections, of which there may be several of one name) with values
/// from the command line laid over it.
struct TomlDocument {
  std::string name;               ///< of the file
  std::vector<Section> sections;  ///< in the order of the file
  std::vector<Entry> entries;     ///< in the order of the file, then of the command line; each key once

  const Entry* find(std::string_view key) const;
  /// In place of what the key has, if anything.
  void set(Entry entry);
  /// file:line of the section's head, or file:1.
  std::string where_of(std::string_view section) const;
};

/// Throws InputError for what is not TOML (duplicate keys included) and for an override that is not
/// key=value.
///
/// The value of an override is read as TOML; what is none is taken as a string, so that a shell needs no
/// second quotes.
TomlDocument read_toml(std::string_view text, const std::string& name, const std::vector<std::string>& overrides);

/// A document as TOML, without comments: reading it gives the same values.
std::string document_text(const TomlDocument& document);

}  // namespace hardbody
