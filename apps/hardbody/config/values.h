#pragma once

/// Reading the values of a config, with the messages that they get. Private to the sources that read configs.

#include "base/errors.h"
#include "io/toml_document.h"

#include <Eigen/Core>

#include <cstdint>
#include <initializer_list>
#include <limits>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// "file:line: key is what was got; accepted: .."
InputError bad(const Entry& entry, std::string_view accepted);

/// An integer or a real, finite.
bool is_number(const Value& value);

/// An integer from `least` to `most`; without the key `result` stays. The same for the functions below.
void read_integer(const TomlDocument& document, std::string_view key, std::int64_t least, std::int64_t most,
                  std::int64_t& result);

/// One of the names.
void read_choice(const TomlDocument& document, std::string_view key, std::initializer_list<std::string_view> names,
                 std::string& result);

/// `size` finite numbers above 0; the message is `accepted`.
std::vector<double> read_positive(const Entry& entry, std::size_t size, std::string_view accepted);

/// Three of them.
Eigen::Vector3d read_three(const Entry& entry, std::string_view accepted);

}  // namespace hardbody
