#pragma once

#include <stdexcept>
#include <string>

namespace test_common {

/// The message of the std::invalid_argument that f() throws; that there is none, if it throws none.
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
