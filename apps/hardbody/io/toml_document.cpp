#include "io/toml_document.h"

#include "base/errors.h"
#include "base/find.h"
#include "io/text_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <utility>

namespace hardbody {
namespace {

/// Returns a value as the user would write it: toml++ prints reals with digits that nobody wrote.
std::string shown(const Value& value, const toml::node& node) {
  if (value.kind == Value::Kind::real) return toml_real(value.real);
  if (value.kind == Value::Kind::text) return one_line(fmt::format("\"{}\"", value.text), kShownLength);
  if (value.kind == Value::Kind::table) return one_line(toml_text(value), kShownLength);
  std::ostringstream text;
  if (value.kind == Value::Kind::array) {
    const char* separator = "[";
    for (const Value& item : value.items) {
      text << separator << item.shown;
      separator = ", ";
    }
    text << (value.items.empty() ? "[]" : "]");
  } else {
    node.visit([&](const auto& n) { text << n; });
  }
  return one_line(text.str(), kShownLength);
}

int line_of(const toml::source_region& source) {
  return static_cast<int>(source.begin.line);
}

Value value_of(const toml::node& node);

/// Returns the members in the order of the file; toml++ sorts them alphabetically.
std::vector<Member> members_of(const toml::table& table) {
  std::vector<std::pair<toml::source_position, Member>> found;
  for (const auto& [key, node] : table) {
    found.push_back({key.source().begin, {std::string(key.str()), line_of(key.source()), value_of(node)}});
  }
  std::stable_sort(found.begin(), found.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
  std::vector<Member> members;
  members.reserve(found.size());
  for (auto& [position, member] : found) members.push_back(std::move(member));
  return members;
}

Value value_of(const toml::node& node) {
  Value value;
  if (const auto boolean = node.value_exact<bool>()) {
    value.kind = Value::Kind::boolean;
    value.integer = *boolean ? 1 : 0;
  } else if (const auto integer = node.value_exact<std::int64_t>()) {
    value.kind = Value::Kind::integer;
    value.integer = *integer;
    value.real = static_cast<double>(*integer);
  } else if (const auto real = node.value_exact<double>()) {
    value.kind = Value::Kind::real;
    value.real = *real;
  } else if (const auto text = node.value_exact<std::string>()) {
    value.kind = Value::Kind::text;
    value.text = *text;
  } else if (const toml::array* array = node.as_array()) {
    value.kind = Value::Kind::array;
    for (const toml::node& item : *array) value.items.push_back(value_of(item));
  } else if (const toml::table* table = node.as_table()) {
    value.kind = Value::Kind::table;
    value.members = members_of(*table);
  }
  value.shown = shown(value, node);
  return value;
}

void add_entry(TomlDocument& document, std::string key, const toml::key& name, const toml::node& node) {
  // The line of the key, not of the value, which may span several lines.
  const int line = line_of(name.source());
  document.entries.push_back({std::move(key), document.where(line), line, value_of(node)});
}

void add_section(TomlDocument& document, const std::string& name, bool several, int line, const toml::table& section) {
  document.sections.push_back({name, several, document.where(line), line});
  for (const auto& [key, node] : section) add_entry(document, fmt::format("{}.{}", name, key.str()), key, node);
}

/// Adds [name], or several [[name]]: name[1], name[2], ..
void add_sections(TomlDocument& document, const toml::key& name, const toml::node& node) {
  if (const toml::table* section = node.as_table()) {
    add_section(document, std::string(name.str()), false, line_of(name.source()), *section);
    return;
  }
  int number = 0;
  for (const toml::node& one : *node.as_array()) {
    add_section(document, fmt::format("{}[{}]", name.str(), ++number), true, line_of(one.source()), *one.as_table());
  }
}

toml::table parse(std::string_view text, const std::string& name) {
  try {
    return toml::parse(text, name);
  } catch (const toml::parse_error& error) {
    throw InputError(fmt::format("{}:{}: is not valid TOML: {}; accepted: TOML 1.0", name, line_of(error.source()),
                                 one_line(error.description())));
  }
}

/// Parses `text` as the value of a TOML assignment; returns a string if it is not TOML.
Value parse_value(const std::string& text) {
  try {
    const toml::table table = toml::parse("value = " + text);
    // More than one key: the text contained a line break followed by another assignment.
    if (table.size() == 1 && table.contains("value")) return value_of(*table.get("value"));
  } catch (const toml::parse_error&) {
    // Not TOML: a bare word.
  }
  Value value;
  value.kind = Value::Kind::text;
  value.text = text;
  value.shown = one_line(fmt::format("\"{}\"", text), kShownLength);
  return value;
}

void lay_over(TomlDocument& document, const std::string& override_text) {
  const std::string where = one_line(fmt::format("--set {}", override_text));
  const std::size_t equals = override_text.find('=');
  if (equals == std::string::npos || equals == 0) {
    throw InputError(fmt::format("{}: is not an assignment; accepted: section.key=value", where));
  }
  std::string key = one_line(override_text.substr(0, equals));
  const std::string text = one_line(override_text.substr(equals + 1), override_text.size());
  if (text.empty()) throw InputError(fmt::format("{}: has no value; accepted: section.key=value", where));
  document.set({std::move(key), where, 0, parse_value(text)});
}

// ---- Writing

std::string key_text(std::string_view key) {
  const bool bare = !key.empty() && std::all_of(key.begin(), key.end(), [](char c) {
    return (c >= 'a' && c <= 'z') || (c >= 'A' && c <= 'Z') || (c >= '0' && c <= '9') || c == '_' || c == '-';
  });
  return bare ? std::string(key) : toml_string(key);
}

std::string array_text(const std::vector<Value>& items) {
  std::string text = "[";
  for (const Value& item : items) text += (text.size() > 1 ? ", " : "") + toml_text(item);
  return text + "]";
}

std::string table_text(const std::vector<Member>& members) {
  std::string text = "{";
  for (const Member& m : members) {
    text += fmt::format("{}{} = {}", text.size() > 1 ? ", " : "", key_text(m.key), toml_text(m.value));
  }
  return text + "}";
}

/// Returns the lines of a section; "": of the keys in no section.
std::string entries_text(const TomlDocument& document, const std::string& section) {
  std::string text;
  for (const Entry& entry : document.entries) {
    const bool of_any = std::any_of(document.sections.begin(), document.sections.end(),
                                    [&](const Section& s) { return entry.key.starts_with(s.name + "."); });
    const bool here = section.empty() ? !of_any : entry.key.starts_with(section + ".");
    if (!here) continue;
    const std::string key = section.empty() ? entry.key : entry.key.substr(section.size() + 1);
    text += fmt::format("{} = {}\n", key_text(key), toml_text(entry.value));
  }
  return text;
}

}  // namespace

const Member* Value::find(std::string_view key) const {
  return find_by(members, &Member::key, key);
}

std::string toml_string(std::string_view text) {
  std::string result = "\"";
  for (const char c : text) {
    const auto code = static_cast<unsigned char>(c);
    if (code < 0x20 || code == 0x7f) {
      result += fmt::format("\\u{:04X}", code);
      continue;
    }
    if (c == '"' || c == '\\') result += '\\';
    result += c;
  }
  return result + '"';
}

std::string toml_text(const Value& value) {
  switch (value.kind) {
    case Value::Kind::boolean:
      return value.integer != 0 ? "true" : "false";
    case Value::Kind::integer:
      return fmt::format("{}", value.integer);
    case Value::Kind::real:
      return toml_real(value.real);
    case Value::Kind::text:
      return toml_string(value.text);
    case Value::Kind::array:
      return array_text(value.items);
    case Value::Kind::table:
      return table_text(value.members);
    case Value::Kind::other:  // dates and times
      break;
  }
  return value.shown;
}

InputError bad(const Entry& entry, std::string_view accepted, std::string_view why) {
  return InputError(
      fmt::format("{}: {} is {}{}; accepted: {}", entry.where, entry.key, entry.value.shown, why, accepted));
}

bool is_number(const Value& value) {
  return (value.kind == Value::Kind::integer || value.kind == Value::Kind::real) && std::isfinite(value.real);
}

bool same_value(const Value& a, const Value& b) {
  const auto numeric = [](const Value& v) { return v.kind == Value::Kind::integer || v.kind == Value::Kind::real; };
  if (numeric(a) && numeric(b)) return a.real == b.real;
  if (a.kind != b.kind || a.items.size() != b.items.size() || a.members.size() != b.members.size()) return false;
  if (a.kind == Value::Kind::table) {
    return std::all_of(a.members.begin(), a.members.end(), [&](const Member& m) {
      const Member* other = b.find(m.key);
      return other != nullptr && same_value(m.value, other->value);
    });
  }
  if (a.kind != Value::Kind::array) return toml_text(a) == toml_text(b);
  return std::equal(a.items.begin(), a.items.end(), b.items.begin(), same_value);
}

std::string document_text(const TomlDocument& document) {
  std::string text = entries_text(document, "");
  for (const Section& section : document.sections) {
    const std::string name = section.several ? section.name.substr(0, section.name.find('[')) : section.name;
    const int brackets = section.several ? 2 : 1;
    text += fmt::format("\n{:[<{}}{}{:]<{}}\n", "", brackets, key_text(name), "", brackets);
    text += entries_text(document, section.name);
  }
  return text;
}

void TomlDocument::set(Entry entry) {
  const auto same = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == entry.key; });
  if (same == entries.end()) {
    entries.push_back(std::move(entry));
  } else {
    *same = std::move(entry);
  }
}

std::string toml_real(double x) {
  std::string text = fmt::format("{}", x);
  if (text.find_first_of(".enf") == std::string::npos) text += ".0";
  return text;
}

const Entry* TomlDocument::find(std::string_view key) const {
  return find_by(entries, &Entry::key, key);
}

std::string TomlDocument::where(int line) const {
  return lines == Lines::named ? fmt::format("{}:{}", name, line) : name;
}

std::string TomlDocument::where_of(std::string_view section) const {
  const Section* found = find_by(sections, &Section::name, section);
  return found != nullptr ? found->where : where(1);
}

TomlDocument read_toml(std::string_view text, const std::string& name, const std::vector<std::string>& overrides,
                       Lines lines) {
  TomlDocument document;
  document.name = name;
  document.lines = lines;
  const toml::table root = parse(text, name);
  for (const auto& [key, node] : root) {
    if (key.str().find('.') != std::string_view::npos) {
      throw InputError(fmt::format("{}: \"{}\" is one key with a dot in it; accepted: sections, or keys without quotes",
                                   document.where(line_of(key.source())), one_line(key.str(), 60)));
    }
    if (node.is_table() || node.is_array_of_tables()) {
      add_sections(document, key, node);
    } else {
      add_entry(document, std::string(key.str()), key, node);
    }
  }
  // toml++ sorts keys alphabetically, but the first error reported should be the first in the file.
  std::stable_sort(document.entries.begin(), document.entries.end(),
                   [](const Entry& a, const Entry& b) { return a.line < b.line; });
  std::stable_sort(document.sections.begin(), document.sections.end(),
                   [](const Section& a, const Section& b) { return a.line < b.line; });
  for (const std::string& text_of_one : overrides) lay_over(document, text_of_one);
  return document;
}

}  // namespace hardbody
