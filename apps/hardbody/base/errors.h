#pragma once

#include <stdexcept>

namespace hardbody {

/// Invalid input from the user: the program prints this message in one line on stderr and exits with status 2.
///
/// The form is `where: what was found; accepted: ...`, where = file:line, file, or --set key=value. All other errors
/// are exceptions of other types derived from std::exception and give status 1.
class InputError : public std::runtime_error {
 public:
  using std::runtime_error::runtime_error;
};

}  // namespace hardbody
