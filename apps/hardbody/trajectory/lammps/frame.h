#pragma once

#include "trajectory/frame.h"

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>

namespace hardbody {

/// Iterates over the lines of a text.
class DumpLines {
 public:
  explicit DumpLines(std::string_view text) : text_(text) {}

  /// Returns the next line without its end; nullopt after the last one that has an end.
  std::optional<std::string_view> next() {
    const std::size_t end = text_.find('\n');
    if (end == std::string_view::npos) return std::nullopt;
    std::string_view line = text_.substr(0, end);
    text_.remove_prefix(end + 1);
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
  }
  std::string_view rest() const { return text_; }

 private:
  std::string_view text_;
};

/// Items that may precede the time step: options of dump_modify add them.
inline constexpr std::string_view kTimeItem = "ITEM: TIME";
inline constexpr std::string_view kUnitsItem = "ITEM: UNITS";

/// Reads frame k of a LAMMPS text dump from its own text. `name`: that of the file in messages. Throws InputError.
Frame read_dump_frame(std::string_view text, const std::string& name, std::uint64_t k);

}  // namespace hardbody
