#include "base/number_text.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <system_error>

namespace hardbody {

std::optional<double> number_or_nan(std::string_view text) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  const char* const last = text.data() + text.size();
  double value = kNone;
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (end != last || (error != std::errc() && error != std::errc::result_out_of_range)) return std::nullopt;
  return error == std::errc() && std::isfinite(value) ? value : kNone;
}

std::optional<double> finite_number(std::string_view text) {
  const std::optional<double> value = number_or_nan(text);
  return value && std::isfinite(*value) ? value : std::nullopt;
}

std::optional<double> duration_seconds(std::string_view text) {
  if (text.size() < 2 || text.size() > 16) return std::nullopt;
  const std::string_view number = text.substr(0, text.size() - 1);
  const std::size_t unit = std::string_view("smh").find(text.back());
  if (number.find_first_not_of("0123456789.") != std::string_view::npos || unit > 2) return std::nullopt;
  const std::optional<double> value = finite_number(number);
  return value && *value > 0 ? std::optional(*value * std::array{1.0, 60.0, 3600.0}[unit]) : std::nullopt;
}

std::string freedoms_text(long freedoms, int number) {
  if (freedoms % number == 0) return fmt::format("{}N", freedoms / number);
  return fmt::format("{}", freedoms);
}

}  // namespace hardbody
