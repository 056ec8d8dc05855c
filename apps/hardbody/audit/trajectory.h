#pragma once

#include "trajectory/reader.h"

#include <ed/system.h>

#include <string>

namespace hardbody {

/// Prints a row of the report of `hardbody check`.
void report_row(const char* name, const std::string& value);

/// Returns the audit of a state. Throws InputError for an impossible one; `where` says which.
ed::Audit audited(const ed::System& system, const std::string& where);

/// Checks every frame that has positions and prints the result, for `hardbody check`. Returns 0 if every frame is
/// sound; 1 if one is not, or if something could not be tested, which the last line then says. Throws InputError.
int check_trajectory(const TrajectoryReader& reader);

}  // namespace hardbody
