#pragma once

#include <ed/export.h>
#include <ed/shape.h>

#include <geom/ellipsoid.h>

#include <Eigen/Core>

#include <functional>
#include <optional>
#include <vector>

namespace ed {

/// Properties shared by all bodies of one kind.
struct Species {
  BodyShape shape = geom::Ellipsoid(Eigen::Vector3d::Ones());
  double mass = 1;
  Eigen::Vector3d inertia = Eigen::Vector3d::Ones();  ///< principal moments about body x, y, z, at the shape's centre
  /// False: the bodies have no angular velocity about their axis of revolution (the paper's choice; without friction it
  /// would never change). The moment about that axis is then irrelevant. True for bodies that are not of revolution.
  bool spins = true;
};

/// State of one body. World frame.
struct Body {
  Eigen::Vector3d position = Eigen::Vector3d::Zero();
  Eigen::Matrix3d rotation = Eigen::Matrix3d::Identity();  ///< body to world
  Eigen::Vector3d velocity = Eigen::Vector3d::Zero();
  Eigen::Vector3d angular_velocity = Eigen::Vector3d::Zero();
  int species = 0;  ///< index into System::species
};

/// Bodies in a periodic cubic box.
struct System {
  double box = 0;                ///< edge length
  std::vector<Species> species;  ///< one or more; in a polydisperse system one for each body
  std::vector<Body> bodies;

  /// Returns the number of bodies.
  int size() const { return static_cast<int>(bodies.size()); }
  /// Returns the species of body i.
  const Species& species_of(int i) const {
    return species[static_cast<std::size_t>(bodies[static_cast<std::size_t>(i)].species)];
  }
};

/// Number of bodies of one species, the input of a start.
struct Component {
  Species species;
  int number = 0;
};

/// Returns a species with the moments of inertia of the paper: 2/5 m min(a, b)^2 across the axis of revolution (the
/// paper, section Methods), no spin. Throws std::invalid_argument for bodies that are not of revolution.
ED_EXPORT Species paper_species(const geom::Ellipsoid& shape, double mass = 1);

/// Returns a species of uniform density, with spin. Throws std::invalid_argument for a CustomShape, whose moments are
/// not known.
ED_EXPORT Species uniform_species(const BodyShape& shape, double mass = 1);

/// Returns the body axis (0, 1, 2) that shape and inertia are both symmetric about, so that no contact changes the spin
/// about it; nullopt if there is none.
ED_EXPORT std::optional<int> symmetry_axis(const Species& species);

/// Throws std::invalid_argument, naming the field, unless mass and moments are physically possible, spin is excluded
/// only for bodies of revolution, and the exponents are within [kMinExponentInMotion, kMaxExponentInMotion].
ED_EXPORT void check_species(const Species& species);
/// Overload for all species; also checks that every body has one.
ED_EXPORT void check_species(const System& system);

/// Returns the time in which a body moves by its size at kT = 1: l sqrt(m), with l the radius of the sphere of its
/// volume.
ED_EXPORT double thermal_time(const Species& species);

/// Returns the mean thermal time of the bodies, rounded to a power of two, so that its multiples are exact; 1 if mass
/// and (abc)^(1/3) are 1. Default times are in this unit, so that they scale with the system: with bodies k times as
/// large they are k times as long.
ED_EXPORT double time_unit(const std::vector<Component>& components);
/// Overload for a state.
ED_EXPORT double time_unit(const System& system);

/// Returns the volume of the bodies over the volume of the box.
ED_EXPORT double packing_fraction(const System& system);

/// Returns the edge of the cubic box in which `number` bodies of this shape have this packing fraction.
ED_EXPORT double box_for(const BodyShape& shape, int number, double packing_fraction);
/// Overload for a mixture.
ED_EXPORT double box_for(const std::vector<Component>& components, double packing_fraction);

/// Kind of neighbour list, which limits the pairs that are tested for contact.
enum class Neighbours {
  dilated,  ///< bodies whose shapes overlap when dilated by the envelope's thickness
  obp,      ///< the paper's: bodies whose oriented bounding parallelepipeds overlap
  cells,    ///< the paper's plain algorithm: bodies in the same or an adjacent cell; no thickness
};

/// Returns the enumerator's name.
ED_EXPORT const char* to_string(Neighbours neighbours);

/// Returns the smallest box in which only one image of every pair of these bodies matters: box / 2 > 2 R + 4 delta_min,
/// with R the largest bounding radius and delta_min the thinnest neighbour-list envelope in use; for cells, box > 6 R,
/// three cells; for obp of bodies beyond the fast case of Simulation, box / 2 > 2 R + 4 s, with s the distance that
/// a centre can move while its body stays in the thinnest box around it, in which octahedra and cubes can rotate.
ED_EXPORT double smallest_box(const std::vector<Component>& components, Neighbours neighbours = Neighbours::dilated);

/// Returns the smallest number of bodies of this shape and of uniform density whose box at this packing fraction is at
/// least smallest_box; the largest int if that number does not fit into an int. Throws std::invalid_argument if
/// packing_fraction is not above 0.
ED_EXPORT int smallest_number(const BodyShape& shape, double packing_fraction,
                              Neighbours neighbours = Neighbours::dilated);

/// Kinetic energies and the temperatures kT that follow from them.
struct KineticState {
  double translational_energy = 0;
  double rotational_energy = 0;           ///< bodies of revolution: only the motion across their axes
  double spin_energy = 0;                 ///< bodies of revolution: rotation about their axes
  double translational_kT = 0;            ///< temperature on 3N - 3 degrees of freedom (momentum is zero)
  double rotational_kT = 0;               ///< temperature on rotational_degrees_of_freedom
  int rotational_degrees_of_freedom = 0;  ///< degrees of freedom: 2 for each body of revolution, 3 for others
  int spin_degrees_of_freedom = 0;        ///< degrees of freedom: 1 for each body of revolution that spins
  /// Energy of rotation about body x, y, z; these add up to rotational_energy + spin_energy.
  Eigen::Vector3d axis_energy = Eigen::Vector3d::Zero();
  Eigen::Vector3d momentum = Eigen::Vector3d::Zero();
  /// Returns the sum of all three energies.
  double energy() const { return translational_energy + rotational_energy + spin_energy; }
};

/// Distances of all near pairs (bounding spheres that overlap, or are within a mean distance of that), and the kinetic
/// state.
struct Audit {
  double minimum_distance;  ///< minimum over the pairs and images that were tried, < 0: overlap; box if none are near
  int closest_i = -1;       ///< body of that distance; -1: none are near
  int closest_j = -1;       ///< the other one, >= closest_i; equal: a body and an image of it
  int overlaps = 0;         ///< pairs that overlap by more than kAuditOverlap allows
  int unanswered = 0;       ///< pairs whose distance query declined
  bool finite = true;       ///< whether all numbers of the state are finite
  KineticState kinetic;
};

/// Overlap criterion of an audit: distance < -kAuditOverlap times the sum of both bounding radii.
inline constexpr double kAuditOverlap = 1e-12;

/// Returns sums over all bodies, in units of kT where m and kT are 1.
ED_EXPORT KineticState kinetic_state(const System& system);

/// Checks a state from scratch by `geom::distance`, independently of the event loop. Distances are exact to 1e-13 times
/// the pair's size (for bodies with flat faces or edges see geom/distance.h). In a box where a body could touch two
/// images of another, or one of itself, all images are tried, each of which counts as a pair; elsewhere those with the
/// nearest centres, the only ones that can overlap. Throws std::invalid_argument for a matrix that is not a rotation,
/// and for a box below a quarter of the largest bounding radius; numbers that are not finite are reported, not thrown.
/// Unless `poll` is empty it is called once every few hundred bodies or images; an exception that it throws ends the
/// audit.
ED_EXPORT Audit audit(const System& system, const std::function<void()>& poll = {});

}  // namespace ed
