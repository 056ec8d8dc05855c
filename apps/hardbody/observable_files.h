#pragma once

#include <ed/observables.h>
#include <ed/simulation.h>

#include <string>
#include <vector>

namespace hardbody {

/// CSV files: one header line, units in brackets in the column names; a value that is not known is an empty
/// field.
std::string msd_csv(const ed::Results& results);
std::string rotational_msd_csv(const ed::Results& results);
std::string c2_csv(const ed::Results& results);
std::string blocks_csv(const ed::Results& results);

/// time,i,j with 17 significant digits, which give the same double back.
std::string events_csv(const std::vector<ed::Collision>& collisions);

}  // namespace hardbody
