#include "toml_document.h"

#include "errors.h"
#include "text_file.h"

#include <fmt/format.h>
#include <toml++/toml.h>

#include <algorithm>
#include <sstream>

namespace hardbody {
namespace {

constexpr std::size_t kShownLength = 60;

/// A value as the user would write it: toml++ prints reals with digits that nobody wrote.
std::string shown(const Value& value, const toml::node& node) {
  if (value.kind == Value::Kind::real) return toml_real(value.real);
  if (value.kind == Value::Kind::text) return one_line(fmt::format("\"{}\"", value.text), kShownLength);
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
  } else if (node.is_table()) {
    value.kind = Value::Kind::table;
  }
  value.shown = shown(value, node);
  return value;
}

int line_of(const toml::source_region& source) {
  return static_cast<int>(source.begin.line);
}

void add_entry(TomlDocument& document, std::string key, const toml::key& name, const toml::node& node) {
  // The line of the key, not of the value: a value may go over several lines.
  const int line = line_of(name.source());
  document.entries.push_back({std::move(key), fmt::format("{}:{}", document.name, line), line, value_of(node)});
}

void add_section(TomlDocument& document, const std::string& name, bool several, int line, const toml::table& section) {
  document.sections.push_back({name, several, fmt::format("{}:{}", document.name, line), line});
  for (const auto& [key, node] : section) add_entry(document, fmt::format("{}.{}", name, key.str()), key, node);
}

/// [name], or several [[name]]: name[1], name[2], ..
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

/// `text` as the value of a TOML assignment; a string if it is none.
Value parse_value(const std::string& text) {
  try {
    const toml::table table = toml::parse("value = " + text);
    // More than one key: the text had a line break in it and went on as another assignment.
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
  const std::string text = one_line(override_text.substr(equals + 1));
  if (text.empty()) throw InputError(fmt::format("{}: has no value; accepted: section.key=value", where));
  std::erase_if(document.entries, [&](const Entry& e) { return e.key == key; });
  document.entries.push_back({std::move(key), where, 0, parse_value(text)});
}

}  // namespace

std::string toml_real(double x) {
  std::string text = fmt::format("{}", x);
  if (text.find_first_of(".enf") == std::string::npos) text += ".0";
  return text;
}

const Entry* TomlDocument::find(std::string_view key) const {
  const auto found = std::find_if(entries.begin(), entries.end(), [&](const Entry& e) { return e.key == key; });
  return found == entries.end() ? nullptr : &*found;
}

std::string TomlDocument::where_of(std::string_view section) const {
  for (const Section& s : sections) {
    if (s.name == section) return s.where;
  }
  return name + ":1";
}

TomlDocument read_toml(std::string_view text, const std::string& name, const std::vector<std::string>& overrides) {
  TomlDocument document;
  document.name = name;
  const toml::table root = parse(text, name);
  for (const auto& [key, node] : root) {
    if (node.is_table() || node.is_array_of_tables()) {
      add_sections(document, key, node);
    } else {
      add_entry(document, std::string(key.str()), key, node);
    }
  }
  // toml++ keeps keys in alphabetical order; the first error reported should be the first in the file.
  std::stable_sort(document.entries.begin(), document.entries.end(),
                   [](const Entry& a, const Entry& b) { return a.line < b.line; });
  std::stable_sort(document.sections.begin(), document.sections.end(),
                   [](const Section& a, const Section& b) { return a.line < b.line; });
  for (const std::string& text_of_one : overrides) lay_over(document, text_of_one);
  return document;
}

}  // namespace hardbody
