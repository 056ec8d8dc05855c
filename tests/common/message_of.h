#pragma once

#include <stdexcept>
#include <string>

namespace test_common {

/// The message of the std::invalid_argument that f() throws; "accepted", if it throws none.
template <class F>
std::string message_of(const F& f) {
  try {
    static_cast<void>(f());
  } catch (const std::invalid_argument& error) {
    return error.what();
  }
  return "accepted";
}

}  // namespace test_common
