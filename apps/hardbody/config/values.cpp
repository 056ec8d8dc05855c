#include "config/values.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace hardbody {

InputError bad(const Entry& entry, std::string_view accepted) {
  return InputError(fmt::format("{}: {} is {}; accepted: {}", entry.where, entry.key, entry.value.shown, accepted));
}

bool is_number(const Value& value) {
  return (value.kind == Value::Kind::integer || value.kind == Value::Kind::real) && std::isfinite(value.real);
}

void read_integer(const TomlDocument& document, std::string_view key, std::int64_t least, std::int64_t most,
                  std::int64_t& result) {
  const Entry* entry = document.find(key);
  if (entry == nullptr) return;
  if (entry->value.kind != Value::Kind::integer || entry->value.integer < least || entry->value.integer > most) {
    throw bad(*entry, most == std::numeric_limits<std::int64_t>::max()
                          ? fmt::format("an integer, at least {}", least)
                          : fmt::format("an integer from {} to {}", least, most));
  }
  result = entry->value.integer;
}

void read_choice(const TomlDocument& document, std::string_view key, std::initializer_list<std::string_view> names,
                 std::string& result) {
  const Entry* entry = document.find(key);
  if (entry == nullptr) return;
  const bool known =
      entry->value.kind == Value::Kind::text && std::find(names.begin(), names.end(), entry->value.text) != names.end();
  if (!known) throw bad(*entry, fmt::format("\"{}\"", fmt::join(names, "\", \"")));
  result = entry->value.text;
}

std::vector<double> read_positive(const Entry& entry, std::size_t size, std::string_view accepted) {
  const Value& value = entry.value;
  if (value.kind != Value::Kind::array || value.items.size() != size) throw bad(entry, accepted);
  std::vector<double> result;
  for (const Value& item : value.items) {
    if (!is_number(item) || !(item.real > 0)) throw bad(entry, accepted);
    result.push_back(item.real);
  }
  return result;
}

Eigen::Vector3d read_three(const Entry& entry, std::string_view accepted) {
  const std::vector<double> v = read_positive(entry, 3, accepted);
  return {v[0], v[1], v[2]};
}

}  // namespace hardbody
