#pragma once

#include "base/shapes.h"

#include <ed/contact_options.h>
#include <ed/observables.h>
#include <ed/polydispersity.h>
#include <ed/simulation.h>
#include <ed/start.h>
#include <ed/system.h>

#include <Eigen/Core>

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <vector>

namespace hardbody {

enum class Inertia { paper, uniform, moments };
enum class TrajectoryFormat { gsd, lammps, vtk };
enum class FramesSpacing { even, log };
enum class BondOrder { steinhardt, hexatic };

/// Return the words that a config has for them.
const char* to_string(Inertia inertia);
const char* to_string(TrajectoryFormat format);
const char* to_string(FramesSpacing spacing);
const char* to_string(BondOrder order);

/// A shape as the user gave it: the keys of its kind (config/shape_forms.h) have values.
struct ShapeConfig {
  ShapeKind kind = ShapeKind::ellipsoid;
  // Exactly one of the two.
  std::optional<double> aspect_ratio;
  std::optional<Eigen::Vector3d> semi_axes;
  Eigen::Vector2d exponents{1, 1};  ///< e1, e2 of a superellipsoid
  std::optional<double> length;     ///< length of a cylinder or cone; distance of the centres of a capsule's caps
  std::optional<double> diameter;
  std::optional<Eigen::Vector3d> edges;  ///< edges of a box along body x, y, z
  // Exactly one of the two.
  std::optional<std::vector<Eigen::Vector3d>> vertices;  ///< corners of a polyhedron, in any frame
  std::optional<std::string> solid;                      ///< Platonic or Archimedean solid of circumradius 1
  double rounding = 0;                                   ///< radius of a ball that is swept over a shape with edges

  /// Returns a/b, a along the axis of revolution (of superellipsoids: body z) and b the two equal semi-axes across it,
  /// 1 for spheres; nullopt for shapes with three different semi-axes and shapes without semi-axes.
  std::optional<double> true_aspect_ratio() const;
};

/// Bodies of one kind, as the user gave them ([shape], or one of several [[species]]) and as the run takes them.
struct SpeciesConfig {
  ShapeConfig shape;
  Inertia inertia = Inertia::paper;
  Eigen::Vector3d inertia_moments{0, 0,
                                  0};  ///< moments of Inertia::moments, as given, about the axes that semi_axes names
  double mass = 1;
  std::optional<double> fraction;  ///< fraction of the number of bodies; nullopt: the number itself was given
  int number = 0;

  std::optional<ed::SizeDistribution> sizes;  ///< nullopt: all bodies have the same size
  double width = 0;                           ///< standard deviation / mean of the distribution of sizes
  std::optional<std::int64_t> size_seed;      ///< nullopt: the seed of the run

  /// Body of nominal size, in the program's units. An ellipsoid's axis of revolution is along body z.
  ed::Species body;
  /// Size of each body relative to the nominal one; empty: all 1.
  std::vector<double> factors;

  /// Returns the degrees of freedom of rotation that count as such: 2 of bodies of revolution (spin excluded), 3 of
  /// others.
  int rotation_axes() const;
};

/// Statistics of sizes that were drawn.
struct SizeStatistics {
  double mean;
  double deviation;  ///< standard, of the sample
  double smallest;
  double largest;
};
SizeStatistics statistics_of(const std::vector<double>& sizes);

bool is_sphere(const SpeciesConfig& species);

/// Limits of production "auto", in ed::time_unit of the bodies.
inline constexpr double kLeastProduction = 30;
inline constexpr double kMostProduction = 5000;

/// State in a file that a run starts from, as [start] names it.
struct StartFile {
  std::string file;                   ///< absolute
  std::optional<std::int64_t> frame;  ///< nullopt: the last
  bool mend = false;                  ///< bodies that overlap are moved apart
  bool reverse = false;               ///< all velocities are negated: time runs backwards
};

/// A run's configuration, checked: every value is one that the run can use.
struct Config {
  std::int64_t seed = 1;

  // [system]
  int number = 512;
  double packing_fraction = 0;
  std::optional<ed::Lattice> start;       ///< nullopt: "random"
  std::optional<std::string> start_from;  ///< directory of a run whose last state is compressed; instead of `start`
  std::optional<double>
      nematic_order;  ///< nematic order of the start; nullopt: uniform orientations, or on a lattice aligned ones

  std::optional<StartFile> start_file;  ///< state in a file that replaces a start of the run's own

  // [shape], or one or more [[species]]
  bool mixture = false;  ///< [[species]]: lengths are taken as they are given
  std::vector<SpeciesConfig> species;
  double time_unit = 1;  ///< ed::time_unit of the bodies: of all times that the user does not give

  // [dynamics]
  ed::Finder finder = ed::Finder::certified;
  double eps_d = 1e-6;
  ed::DistanceMethod distance = ed::DistanceMethod::dual;
  std::optional<ed::Neighbours> neighbours;  ///< nullopt: "auto" has not chosen yet
  bool neighbours_chosen = true;             ///< "auto" chose the neighbours

  std::optional<double> equilibration_time;  ///< nullopt: "auto"
  double equilibration_cap = 0;              ///< longest time of "auto"
  std::optional<double> production_time;
  std::optional<double> target_error;  ///< relative error of both diffusion coefficients at which "auto" ends
  std::optional<double> longest_lag;   ///< longest lag of correlations; nullopt: "auto"
  std::vector<BondOrder> order;        ///< orders of bonds that are measured, each once
  int order_neighbours = 12;           ///< number of nearest neighbours that a body has bonds with
  bool collective = false;             ///< whether F(q, t) / S(q) is measured, too
  std::vector<double> wave_numbers;  ///< wave numbers of F_self, 1/l; none: the first peak of S(q), and others about it

  // [output]
  std::int64_t events = 0;
  std::vector<TrajectoryFormat> trajectory;  ///< each once
  std::int64_t frames = 100;                 ///< frames of each trajectory
  FramesSpacing frames_spacing = FramesSpacing::even;
  std::optional<double> frames_every;    ///< time between two frames; nullopt: they are spread over all of production
  std::string checkpoint_every = "60s";  ///< a number and s, m or h

  /// Returns what is measured of bonds.
  ed::BondOptions bonds() const;
  /// Returns the bodies in the order of their species; of a species with sizes one component a body.
  std::vector<ed::Component> components() const;
  /// Returns the species as the observables take them.
  std::vector<ed::BodyGroup> groups() const;
  /// Returns the numbers of bodies of the species, whose temperatures are set separately.
  std::vector<int> numbers() const;
  /// Whether all bodies have an axis of revolution.
  bool all_of_revolution() const;

  double checkpoint_seconds() const;

  /// Returns the options of a start on a lattice; nullopt for another start.
  std::optional<ed::LatticeOptions> lattice() const;

  /// Returns `neighbours`; dilated as long as "auto" has not chosen.
  ed::Neighbours neighbour_search() const;
  /// Returns [dynamics] as the simulation takes it; `envelope`: thickness of the neighbour-list envelopes, 0 for a
  /// guess.
  ed::SimulationOptions simulation_options(double envelope = 0) const;
};

struct StartFrame;
struct TomlDocument;

/// Reads and checks a config. Where it starts from a file and leaves something to that file, the frame that was read
/// for it is handed out in `frame`. Throws InputError.
Config read_config(const TomlDocument& document, std::optional<StartFrame>* frame = nullptr);

/// Reads and checks the config in a file, with `overrides` (section.key=value) laid over it. Throws InputError.
Config load_config(const std::string& path, const std::vector<std::string>& overrides,
                   std::optional<StartFrame>* frame = nullptr);

/// Reads and checks a config from a text; `name` is what messages call it. Throws InputError.
Config parse_config(std::string_view text, const std::string& name, const std::vector<std::string>& overrides = {});

}  // namespace hardbody
