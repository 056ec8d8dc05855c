#pragma once

/// Rules of a config's keys: how a value of TOML becomes a member of Config, and how that member is written and
/// compared.

#include "config/keys.h"

#include <fmt/format.h>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <optional>
#include <string>
#include <string_view>
#include <type_traits>
#include <utility>
#include <vector>

namespace hardbody {

/// Returns the part of a config that has the members of class C.
template <class C, class P>
auto& part(const P& place) {
  if constexpr (std::is_same_v<C, Config>) {
    return place.config;
  } else if constexpr (std::is_same_v<C, SpeciesConfig>) {
    return *place.species;
  } else if constexpr (std::is_same_v<C, ShapeConfig>) {
    return place.species->shape;
  } else {
    static_assert(std::is_same_v<C, StartFile>);
    return *place.config.start_file;
  }
}

// ---- Writing

/// Returns a value as TOML; of lists and vectors the items.
template <class T>
std::string value_text(const T& value) {
  if constexpr (std::is_same_v<T, bool>) {
    return value ? "true" : "false";
  } else if constexpr (std::is_integral_v<T>) {
    return fmt::format("{}", value);
  } else if constexpr (std::is_floating_point_v<T>) {
    return toml_real(value);
  } else if constexpr (std::is_enum_v<T>) {
    return toml_string(to_string(value));
  } else if constexpr (std::is_convertible_v<T, std::string_view>) {
    return toml_string(value);
  } else {
    std::string text;
    for (const auto& item : value) text += (text.empty() ? "" : ", ") + value_text(item);
    return "[" + text + "]";
  }
}

template <class T>
std::string value_text(const std::optional<T>& value) {
  return value ? value_text(*value) : "";
}

// ---- Rules

/// Returns the rule of a member that `read`(value, place, member) takes, or refuses as Rule::take does.
template <class C, class T, class Read>
Rule bound(T C::*member, Read read) {
  return {[=](const Value& value, const Target& to) { return read(value, Place(to), part<C>(to).*member); },
          [=](const Place& at) { return value_text(part<C>(at).*member); },
          [=](const Place& a, const Place& b) { return part<C>(a).*member == part<C>(b).*member; }};
}

/// Accepts integers from `least` to `most`.
template <class C, class T>
Rule integer(T C::*member, std::int64_t least, std::int64_t most = std::numeric_limits<std::int64_t>::max()) {
  return bound(member, [=](const Value& value, const Place&, T& result) -> Taken {
    if (value.kind != Value::Kind::integer || value.integer < least || value.integer > most) {
      const bool any = most == std::numeric_limits<std::int64_t>::max();
      return Refusal{any ? fmt::format("an integer, at least {}", least)
                         : fmt::format("an integer from {} to {}", least, most)};
    }
    using Integer = std::conditional_t<std::is_same_v<T, int>, int, std::int64_t>;
    result = static_cast<Integer>(value.integer);
    return std::nullopt;
  });
}

/// Interval of numbers; its ends belong to it unless they are said not to.
struct Range {
  double least;
  double most;
  bool with_least = true;
  bool with_most = true;

  bool contains(double x) const { return (with_least ? x >= least : x > least) && (with_most ? x <= most : x < most); }
};

/// Takes a number of the range; `meaning` stands in the message.
template <class T>
Taken take_number(const Value& value, const Range& range, std::string_view meaning, T& result) {
  if (is_number(value) && range.contains(value.real)) {
    result = value.real;
    return std::nullopt;
  }
  const char* text = !range.with_least  ? "a number above {:g}, at most {:g}"
                     : !range.with_most ? "a number at least {:g}, below {:g}"
                                        : "a number from {:g} to {:g}";
  const std::string accepted = fmt::format(fmt::runtime(text), range.least, range.most);
  return Refusal{meaning.empty() ? accepted : fmt::format("{} ({})", accepted, meaning)};
}

template <class C, class T>
Rule number(T C::*member, Range range, const char* meaning = "") {
  return bound(member,
               [=](const Value& value, const Place&, T& result) { return take_number(value, range, meaning, result); });
}

/// Accepts the words of the choices; `none`: word of nullopt.
template <class C, class T>
Rule choice(T C::*member, const std::vector<T>& choices, const char* none = "") {
  const auto word = [none](const T& choice) {
    const std::string text = value_text(choice);
    return text.empty() ? toml_string(none) : text;
  };
  Rule rule = bound(member, [=](const Value& value, const Place&, T& result) -> Taken {
    std::string words;
    for (const T& choice : choices) {
      result = choice;
      if (toml_text(value) == word(choice)) return std::nullopt;
      words += (words.empty() ? "" : ", ") + word(choice);
    }
    return Refusal{words};
  });
  rule.text = [=](const Place& at) { return word(part<C>(at).*member); };
  return rule;
}

/// Accepts true and false.
template <class C>
Rule flag(bool C::*member) {
  return bound(member, [](const Value& value, const Place&, bool& result) -> Taken {
    result = value.integer == 1;
    return value.kind == Value::Kind::boolean ? Taken() : Refusal{"true or false"};
  });
}

/// Accepts strings that are `good`.
template <class C, class T>
Rule text(T C::*member, bool (*good)(const std::string&), const char* accepted) {
  return bound(member, [=](const Value& value, const Place&, T& result) -> Taken {
    result = value.text;
    return value.kind == Value::Kind::text && good(value.text) ? Taken() : Refusal{accepted};
  });
}

/// Returns `rule`, which accepts nothing (but `accepted`) where `when` holds.
inline Rule unless(bool (*when)(const Place&), const char* accepted, Rule rule) {
  auto take = [=, take = std::move(rule.take)](const Value& value, const Target& to) {
    return when(to) ? Refusal{accepted} : take(value, to);
  };
  return {std::move(take), std::move(rule.text), std::move(rule.same)};
}

/// Takes a list of numbers above 0 that fills the vector. Returns whether the value is one.
template <class Vector>
bool take_positive(const Value& value, Vector& result) {
  if (value.kind != Value::Kind::array || value.items.size() != static_cast<std::size_t>(result.size())) return false;
  for (std::size_t k = 0; k < value.items.size(); ++k) result[static_cast<int>(k)] = value.items[k].real;
  return std::all_of(value.items.begin(), value.items.end(), [](const Value& v) { return is_number(v) && v.real > 0; });
}

}  // namespace hardbody
