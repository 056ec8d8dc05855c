#pragma once

#include <ed/export.h>

#include <geom/ellipsoid.h>

#include <Eigen/Core>

#include <vector>

namespace ed {

/// What all bodies of one kind share: an ellipsoid of revolution and its inertia.
struct Species {
  geom::Ellipsoid shape{Eigen::Vector3d::Ones()};
  double mass = 1;
  Eigen::Vector3d inertia = Eigen::Vector3d::Ones();  ///< principal moments about body x, y, z
  /// False: the bodies have no angular velocity about their axis of revolution (the paper's choice; without friction it
  /// would never change). The moment about that axis is then irrelevant.
  bool spins = true;
};

/// State of one body. World frame.
struct Body {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< body to world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
};

/// Bodies in a periodic cubic box.
struct System {
  double box = 0;  ///< edge length
  Species species;
  std::vector<Body> bodies;

  /// The number of bodies.
  int size() const { return static_cast<int>(bodies.size()); }
};

/// "paper": 2/5 m min(a, b)^2 across the axis of revolution (the paper, section Methods), no spin.
/// Throws std::invalid_argument for bodies that are not of revolution.
ED_EXPORT Species paper_species(const geom::Ellipsoid& shape, double mass = 1);

/// Uniform density, with spin.
ED_EXPORT Species uniform_species(const geom::Ellipsoid& shape, double mass = 1);

/// Volume of the bodies over volume of the box.
ED_EXPORT double packing_fraction(const System& system);

/// Edge of the cubic box in which `number` bodies of this shape have that packing fraction.
ED_EXPORT double box_for(const geom::Ellipsoid& shape, int number, double packing_fraction);

/// What keeps the list of the bodies that a body can meet short.
enum class Neighbours {
  dilated,  ///< bodies whose shapes, made thicker by the envelope's thickness, meet
  obp,      ///< the paper's: bodies whose oriented bounding parallelepipeds meet
  cells,    ///< the paper's plain algorithm: bodies in the same or an adjacent cell; no thickness
};

/// The smallest number of bodies whose box at this packing fraction is large enough for one image of every pair to be
/// the only one that matters: box / 2 > 2 R + 4 delta_min, with R the bounding radius and delta_min the thinnest
/// neighbour-list envelope in use; for cells, box > 6 R, three cells.
ED_EXPORT int smallest_number(const geom::Ellipsoid& shape, double packing_fraction,
                              Neighbours neighbours = Neighbours::dilated);

/// Kinetic energies and what they give for kT.
struct KineticState {
  double translational_energy = 0;
  double rotational_energy = 0;  ///< of the motion across the axes of revolution
  double spin_energy = 0;        ///< about the axes of revolution
  double translational_kT = 0;   ///< on 3N - 3 degrees of freedom (momentum is zero)
  double rotational_kT = 0;      ///< on 2N
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  /// All three together.
  double energy() const { return translational_energy + rotational_energy + spin_energy; }
};

/// Distances of all pairs that are near (bounding spheres that meet, or within a mean distance of it), and the kinetic
/// state.
struct Audit {
  double minimum_distance;  ///< over all pairs (nearest image), < 0: overlap; box if none are near
  int closest_i = -1;
  int closest_j = -1;
  int overlaps = 0;    ///< pairs closer than -kAuditOverlap
  int unanswered = 0;  ///< pairs whose distance query declined
  bool finite = true;  ///< all numbers of the state are finite
  KineticState kinetic;
};

/// A pair counts as overlapping in an audit when its distance is below -kAuditOverlap (length).
inline constexpr double kAuditOverlap = 1e-12;

/// Sums over all bodies, in units of kT where m and kT are 1. Throws std::invalid_argument for bodies that are not of
/// revolution.
ED_EXPORT KineticState kinetic_state(const System& system);

/// Checks a state from scratch by `geom::distance`, sharing nothing with the event loop. Distances are exact to 1e-13
/// times the pair's size. Throws std::invalid_argument for bodies that are not of revolution or a rotation that is not
/// one; numbers that are not finite are reported, not thrown.
ED_EXPORT Audit audit(const System& system);

}  // namespace ed
