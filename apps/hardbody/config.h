#pragma once

#include <ed/simulation.h>
#include <ed/system.h>

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

/// A run's configuration, checked: every value is one that the run can use.
struct Config {
  std::int64_t seed = 1;

  // [system]
  int number = 512;
  double packing_fraction = 0;

  // [shape]: exactly one of the two, as the user gave it
  std::optional<double> aspect_ratio;
  std::optional<Eigen::Vector3d> semi_axes;

  // [dynamics]
  std::string inertia = "paper";             ///< or "uniform", or "moments"
  Eigen::Vector3d inertia_moments{0, 0, 0};  ///< for "moments": as given, about the axes that semi_axes names
  std::string finder = "certified";
  double eps_d = 1e-6;
  std::string distance = "dual";
  std::string neighbours = "dilated";  ///< what "auto" chose
  bool neighbours_chosen = true;       ///< by "auto"

  std::optional<double> equilibration_time;  ///< nothing: "auto"
  std::optional<double> production_time;

  // [output]
  std::int64_t events = 0;
  std::string checkpoint_every = "60s";  ///< a number and s, m or h

  /// The bodies, in the program's units: (a b c)^(1/3) = 1, the axis of revolution along body z.
  ed::Species species;

  /// X0 = a/b, a along the axis of revolution.
  double true_aspect_ratio() const;
  double checkpoint_seconds() const;

  /// [dynamics], as the simulation takes it; `envelope`: the thickness of the neighbour-list envelopes, 0 for a guess.
  ed::SimulationOptions simulation_options(double envelope = 0) const;
};

/// Reads and checks a config. `overrides`: section.key=value. Throws InputError.
Config load_config(const std::string& path, const std::vector<std::string>& overrides);

/// The same from a text; `name` is what messages call it.
Config parse_config(std::string_view text, const std::string& name, const std::vector<std::string>& overrides = {});

}  // namespace hardbody
