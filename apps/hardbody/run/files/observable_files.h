#pragma once

#include "registry/curves.h"

#include <ed/observables.h>
#include <ed/simulation.h>

#include <span>
#include <string>
#include <vector>

namespace hardbody {

/// Returns a file of observables/ as CSV: one header line, units in brackets in the column names; a value that is not
/// known is an empty field. Where there are several species, columns of each follow those of all bodies, with its
/// number: msd_1, msd_2; of bodies without an axis of revolution those of the body axes, c2_x, c2_y, c2_z (c2_2_x of
/// species 2); of F_self each wave number, f_self_q1, f_self_q2, .. (f_self_2_q1 of species 2). g(r) and S(q) of a
/// species are of its own bodies; those of two species follow: g_1_2, S_1_2. Species of spheres have no columns of what
/// depends on orientations.
std::string curve_csv(const CurveFile& file, const ed::Results& results, Units units = Units::of_runs);

/// Numbers of a file of observables/, without their units.
struct CurveTable {
  std::vector<std::string> columns{};
  std::vector<std::string> units{};
  std::vector<std::vector<double>> rows{};  ///< NaN: not known
};

/// Returns the numbers that curve_csv writes.
CurveTable curve_table(const CurveFile& file, const ed::Results& results);

/// time,i,j with 17 significant digits, which give the same double back; the header and rows of events.csv.
/// @{
std::string events_header();
std::string events_rows(std::span<const ed::Collision> collisions);
/// @}

}  // namespace hardbody
