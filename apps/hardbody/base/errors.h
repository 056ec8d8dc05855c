#pragma once

#include <stdexcept>

namespace hardbody {

/// What the user gave cannot be used: the program prints this one line on stderr and ends with status 2.
///
/// The form is `where: what is got; accepted: ...`, where = file:line, file, or --set key=value. Everything
/// else that goes wrong is a std::exception of another type and status 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hardbody
