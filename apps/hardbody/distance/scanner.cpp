#include "distance/scanner.h"

#include <charconv>
#include <cmath>
#include <cstddef>
#include <system_error>

namespace hardbody {
namespace {

bool is_digit(char c) {
  return c >= '0' && c <= '9';
}

/// Reads from the front of a text. Every function returns whether it found what it reads; after the first failure the
/// position in the text is meaningless.
class Scanner {
 public:
  explicit Scanner(std::string_view text) : next_(text.data()), end_(text.data() + text.size()) {}

  bool at_end() {
    skip_blanks();
    return next_ == end_;
  }

  bool symbol(char c) {
    skip_blanks();
    if (next_ == end_ || *next_ != c) return false;
    ++next_;
    return true;
  }

  /// Reads a string in quotes: no escapes, and ASCII only.
  bool string(std::string_view& value) {
    if (!symbol('"')) return false;
    const char* begin = next_;
    while (next_ != end_ && *next_ >= ' ' && *next_ < 127 && *next_ != '\\' && *next_ != '"') ++next_;
    value = {begin, static_cast<std::size_t>(next_ - begin)};
    return next_ != end_ && *next_++ == '"';
  }

  bool number(double& value) {
    skip_blanks();
    const char* begin = next_;
    if (!number_text()) return false;
    const std::from_chars_result read = std::from_chars(begin, next_, value);
    return read.ec == std::errc() && read.ptr == next_ && std::isfinite(value);
  }

  template <std::size_t N>
  bool numbers(std::array<double, N>& values) {
    if (!symbol('[')) return false;
    for (std::size_t k = 0; k < N; ++k) {
      if ((k > 0 && !symbol(',')) || !number(values[k])) return false;
    }
    return symbol(']');
  }

  /// Reads a string, or an integer of at most 18 digits, whose text is the same as a JSON library would print.
  bool identity(std::string_view& text) {
    skip_blanks();
    const char* begin = next_;
    std::string_view ignored;
    const bool found = next_ != end_ && (*next_ == '"' ? string(ignored) : integer());
    text = {begin, static_cast<std::size_t>(next_ - begin)};
    return found;
  }

  /// Reads an object; `member(key)` reads the value. Each key must be one of `keys`, and none may occur twice.
  template <std::size_t N, class Member>
  bool object(const std::array<std::string_view, N>& keys, const Member& member) {
    if (!symbol('{')) return false;
    std::array<bool, N> seen{};
    do {
      std::string_view key;
      if (!string(key) || !symbol(':')) return false;
      std::size_t k = 0;
      while (k < N && keys[k] != key) ++k;
      if (k == N || seen[k] || !member(k)) return false;
      seen[k] = true;
    } while (symbol(','));
    return symbol('}');
  }

 private:
  void skip_blanks() {
    while (next_ != end_ && (*next_ == ' ' || *next_ == '\t' || *next_ == '\r' || *next_ == '\n')) ++next_;
  }

  bool digits() {
    const char* begin = next_;
    while (next_ != end_ && is_digit(*next_)) ++next_;
    return next_ != begin;
  }

  /// Reads -?(0|[1-9][0-9]*).
  bool integer_text() {
    if (next_ != end_ && *next_ == '-') ++next_;
    const bool zero = next_ != end_ && *next_ == '0';
    if (zero) return ++next_, next_ == end_ || !is_digit(*next_);
    return digits();
  }

  bool number_text() {
    if (!integer_text()) return false;
    if (next_ != end_ && *next_ == '.') {
      ++next_;
      if (!digits()) return false;
    }
    if (next_ != end_ && (*next_ == 'e' || *next_ == 'E')) {
      ++next_;
      if (next_ != end_ && (*next_ == '+' || *next_ == '-')) ++next_;
      if (!digits()) return false;
    }
    return true;
  }

  bool integer() {
    const char* begin = next_;
    if (!integer_text() || next_ - begin > 18) return false;
    const bool minus_zero = *begin == '-' && begin[1] == '0';
    return !minus_zero && (next_ == end_ || (*next_ != '.' && *next_ != 'e' && *next_ != 'E'));
  }

  const char* next_;
  const char* end_;
};

bool scan_shape(Scanner& in, ScannedBody& body) {
  static constexpr std::array<std::string_view, 3> kKeys{"kind", "semi_axes", "exponents"};
  std::string_view kind;
  bool axes = false;
  bool exponents = false;
  const bool good = in.object(kKeys, [&](std::size_t key) {
    if (key == 0) return in.string(kind);
    if (key == 1) return axes = in.numbers(body.semi_axes);
    return exponents = in.numbers(body.exponents);
  });
  const std::optional<ShapeKind> found = find_shape_kind(kind);
  body.kind = found.value_or(ShapeKind::ellipsoid);
  return good && axes && found && has_semi_axes(*found) && exponents == has_exponents(*found);
}

bool scan_body(Scanner& in, ScannedBody& body) {
  static constexpr std::array<std::string_view, 3> kKeys{"shape", "position", "orientation"};
  bool shape = false;
  bool position = false;
  const bool good = in.object(kKeys, [&](std::size_t key) {
    if (key == 0) return shape = scan_shape(in, body);
    if (key == 1) return position = in.numbers(body.position);
    return in.numbers(body.orientation.emplace());
  });
  return good && shape && position;
}

}  // namespace

std::optional<ScannedQuery> scan_query(std::string_view line) {
  static constexpr std::array<std::string_view, 7> kKeys{"a", "b", "id", "method", "seed", "query", "penetration"};
  Scanner in(line);
  ScannedQuery query;
  bool a = false;
  bool b = false;
  const bool good = in.object(kKeys, [&](std::size_t key) {
    switch (key) {
      case 0:
        return a = scan_body(in, query.a);
      case 1:
        return b = scan_body(in, query.b);
      case 2:
        return in.identity(query.id);
      case 3:
        return in.string(query.method) && !query.method.empty();
      case 4:
        return in.string(query.seed) && !query.seed.empty();
      case 5:
        return in.string(query.query) && query.query == "distance";
      default:
        return in.string(query.penetration) && !query.penetration.empty();
    }
  });
  if (!good || !a || !b || !in.at_end()) return {};
  return query;
}

}  // namespace hardbody
