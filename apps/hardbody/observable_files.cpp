#include "observable_files.h"

#include <fmt/format.h>

#include <cmath>
#include <initializer_list>
#include <iterator>

namespace hardbody {
namespace {

void add_row(std::string& text, std::initializer_list<double> values) {
  const char* separator = "";
  for (const double value : values) {
    text += separator;
    if (std::isfinite(value)) fmt::format_to(std::back_inserter(text), "{}", value);
    separator = ",";
  }
  text += '\n';
}

}  // namespace

std::string msd_csv(const ed::Results& results) {
  std::string text = "t [l sqrt(m/kT)],msd [l^2],msd_error [l^2]\n";
  for (const ed::LagRow& row : results.lags) add_row(text, {row.lag, row.msd.value, row.msd.error});
  return text;
}

std::string rotational_msd_csv(const ed::Results& results) {
  std::string text =
      "t [l sqrt(m/kT)],rot_msd [rad^2],rot_msd_error [rad^2],rot_msd_body [rad^2],rot_msd_body_error "
      "[rad^2]\n";
  for (const ed::LagRow& row : results.lags) {
    add_row(text, {row.lag, row.rot_msd.value, row.rot_msd.error, row.rot_msd_body.value, row.rot_msd_body.error});
  }
  return text;
}

std::string c2_csv(const ed::Results& results) {
  std::string text = "t [l sqrt(m/kT)],c2 [1],c2_error [1]\n";
  for (const ed::LagRow& row : results.lags) add_row(text, {row.lag, row.c2.value, row.c2.error});
  return text;
}

std::string blocks_csv(const ed::Results& results) {
  std::string text =
      "begin [l sqrt(m/kT)],end [l sqrt(m/kT)],collision_rate [sqrt(kT/m)/l],Z [1],kT_trans [kT],kT_rot "
      "[kT],S [1]\n";
  for (const ed::BlockRow& row : results.blocks) {
    add_row(text, {row.begin, row.end, row.collision_rate, row.Z, row.translational_kT, row.rotational_kT, row.S});
  }
  return text;
}

std::string events_csv(const std::vector<ed::Collision>& collisions) {
  std::string text = "time,i,j\n";
  for (const ed::Collision& c : collisions) {
    fmt::format_to(std::back_inserter(text), "{:.17g},{},{}\n", c.time, c.i, c.j);
  }
  return text;
}

}  // namespace hardbody
