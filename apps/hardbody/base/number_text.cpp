#include "base/number_text.h"

#include <charconv>
#include <cmath>
#include <system_error>

namespace hardbody {

std::optional<double> finite_number(std::string_view text) {
  const char* const last = text.data() + text.size();
  double value = 0;
  const auto [end, error] = std::from_chars(text.data(), last, value);
  if (error != std::errc() || end != last || !std::isfinite(value)) return std::nullopt;
  return value;
}

std::string freedoms_text(long freedoms, int number) {
  if (freedoms % number == 0) return fmt::format("{}N", freedoms / number);
  return fmt::format("{}", freedoms);
}

}  // namespace hardbody
