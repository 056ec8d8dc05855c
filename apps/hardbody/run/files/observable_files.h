#pragma once

#include <ed/observables.h>
#include <ed/simulation.h>

#include <span>
#include <string>
#include <vector>

namespace hardbody {

/// CSV files: one header line, units in brackets in the column names; a value that is not known is an empty
/// field. Where there are several species, columns of each follow those of all bodies, with its number: msd_1, msd_2;
/// of bodies without an axis of revolution those of the body axes, c2_x, c2_y, c2_z (c2_2_x of species 2).
std::string msd_csv(const ed::Results& results);
std::string rotational_msd_csv(const ed::Results& results);
std::string alpha2_csv(const ed::Results& results);
/// f_self_q1, f_self_q2, ..: at each of the wave numbers (f_self_2_q1 of species 2).
std::string f_self_csv(const ed::Results& results);
/// Of velocities and angular velocities, from lag 0 on.
std::string velocity_csv(const ed::Results& results);
std::string c1_csv(const ed::Results& results);
std::string c2_csv(const ed::Results& results);
/// g(r) and g2(r) of all bodies, then of each species among its own.
std::string pairs_csv(const ed::Results& results);
/// S(q), the same.
std::string structure_csv(const ed::Results& results);
std::string blocks_csv(const ed::Results& results);

/// time,i,j with 17 significant digits, which give the same double back; the header and rows of events.csv.
/// @{
std::string events_header();
std::string events_rows(std::span<const ed::Collision> collisions);
/// @}

}  // namespace hardbody
