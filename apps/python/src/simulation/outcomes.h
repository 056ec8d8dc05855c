#pragma once

/// Outcomes of simulations: counters, failed pairs, and the error that they make.

#include <ed/simulation.h>

#include <nanobind/nanobind.h>

#include <optional>
#include <string>
#include <vector>

namespace hardbody::python {

namespace nb = nanobind;

/// Throws hardbody.NumericalError with the outcome of a simulation.
[[noreturn]] void raise_numerical_error(const std::string& message, const ed::Counters& counters,
                                        const std::vector<ed::FailedPair>& failures,
                                        const std::optional<ed::Stall>& stall);

/// Returns what makes results worthless among the events that are counted in `now` and not in `before`, in words; empty
/// if nothing does.
std::string trouble_text(const ed::Counters& before, const ed::Counters& now);

}  // namespace hardbody::python
