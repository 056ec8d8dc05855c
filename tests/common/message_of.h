#pragma once

#include <stdexcept>
#include <string>

namespace test_common {

/// Returns the message of the std::invalid_argument that f() throws, or a text that says that it throws none.
template <class F>
std::string message_of(const F& f) {
  try {
    static_cast<void>(f());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "no std::invalid_argument";
}

}  // namespace test_common
