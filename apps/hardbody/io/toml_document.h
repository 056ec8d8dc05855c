#pragma once

#include "base/errors.h"

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// Returns a real number in TOML: the shortest digits that read back as the same number, and never an integer.
std::string toml_real(double x);

/// Returns a string as TOML, in quotes.
std::string toml_string(std::string_view text);

struct Member;

/// Value of a TOML file, reduced to what a config needs.
struct Value {
  enum class Kind { boolean, integer, real, text, array, table, other };
  Kind kind = Kind::other;
  std::int64_t integer = 0;
  double real = 0;  ///< value as a real, also set for integers
  std::string text;
  std::vector<Value> items;     ///< elements of an array
  std::vector<Member> members;  ///< members of a table, in the order of the file
  std::string shown;            ///< value as TOML on one line, shortened, for messages

  const Member* find(std::string_view key) const;
};

struct Member {
  std::string key;
  int line = 0;
  Value value;
};

/// Returns a value as TOML on one line, reals to the last bit.
std::string toml_text(const Value& value);

/// Returns whether a value is an integer or a real, and finite.
bool is_number(const Value& value);

/// Returns whether a config treats both values alike: 2 and 2.0 are the same.
bool same_value(const Value& a, const Value& b);

/// Value with its origin.
struct Entry {
  std::string key;    ///< section.key, section[2].key of the second [[section]], or key at the top
  std::string where;  ///< file:line, or --set section.key=value: the beginning of every message about it
  int line = 0;       ///< line number; 0: from the command line
  Value value;
};

struct Section {
  std::string name;      ///< section, or section[2]
  bool several = false;  ///< true: [[section]]
  std::string where;
  int line = 0;
};

/// Whether messages name the line of a value: not if the text was made from something that has no lines.
enum class Lines { named, unnamed };

/// Returns "file:line: key is what was got{why}; accepted: ..".
InputError bad(const Entry& entry, std::string_view accepted, std::string_view why = "");

/// TOML file of two levels (keys at the top, keys in sections, of which several may have one name), with values from
/// the command line that replace those of the file.
struct TomlDocument {
  std::string name;  ///< name of the file
  Lines lines = Lines::named;
  std::vector<Section> sections;  ///< sections in the order of the file
  std::vector<Entry> entries;     ///< entries in the order of the file, then of the command line; each key once

  const Entry* find(std::string_view key) const;
  /// Sets a key, replacing its value if there is one.
  void set(Entry entry);
  /// Returns file:line, the beginning of messages.
  std::string where(int line) const;
  /// Returns file:line of the section's head, or file:1.
  std::string where_of(std::string_view section) const;
};

/// Reads a file's text and overrides. Throws InputError for text that is not TOML (duplicate keys included) and for an
/// override that is not key=value.
///
/// The value of an override is read as TOML; if it is not TOML it is taken as a string, so that a shell needs no second
/// quotes.
TomlDocument read_toml(std::string_view text, const std::string& name, const std::vector<std::string>& overrides,
                       Lines lines = Lines::named);

/// Returns a document as TOML, without comments: reading it gives the same values.
std::string document_text(const TomlDocument& document);

}  // namespace hardbody
