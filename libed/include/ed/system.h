#pragma once

#include <ed/export.h>
#include <ed/shape.h>

#include <geom/ellipsoid.h>

#include <Eigen/Core>

#include <optional>
#include <vector>

namespace ed {

/// What all bodies of one kind share.
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
  int species = 0;  ///< number in System::species
};

/// Bodies in a periodic cubic box.
struct System {
  double box = 0;                ///< edge length
  std::vector<Species> species;  ///< one or more; of a polydisperse system one a body
  std::vector<Body> bodies;

  /// The number of bodies.
  int size() const { return static_cast<int>(bodies.size()); }
  /// What body i is.
  const Species& species_of(int i) const {
    return species[static_cast<std::size_t>(bodies[static_cast<std::size_t>(i)].species)];
  }
};

/// Some bodies of one species, as a start wants them.
struct Component {
  Species species;
  int number = 0;
};

/// "paper": 2/5 m min(a, b)^2 across the axis of revolution (the paper, section Methods), no spin.
/// Throws std::invalid_argument for bodies that are not of revolution.
ED_EXPORT Species paper_species(const geom::Ellipsoid& shape, double mass = 1);

/// Uniform density, with spin. Throws std::invalid_argument for a CustomShape, whose moments are not known.
ED_EXPORT Species uniform_species(const BodyShape& shape, double mass = 1);

/// The body axis (0, 1, 2) that shape and inertia are both symmetric about, so that no contact changes the spin about
/// it; nothing if there is none.
ED_EXPORT std::optional<int> symmetry_axis(const Species& species);

/// Throws std::invalid_argument, naming the field, unless mass and moments are those of a body that can be, spin is
/// only denied to bodies of revolution, and the exponents are within [kMinExponentInMotion, kMaxExponentInMotion].
ED_EXPORT void check_species(const Species& species);
/// The same for all species, and that there is one for every body.
ED_EXPORT void check_species(const System& system);

/// The time in which a body moves by its size at kT = 1: l sqrt(m), with l the radius of the sphere of its volume.
ED_EXPORT double thermal_time(const Species& species);

/// The mean thermal time of the bodies, rounded to a power of two, so that its multiples are exact. What lasts so long
/// in one system lasts k times as long in one that is k times as large: times that nobody states are in this unit. 1
/// where mass and (abc)^(1/3) are 1.
ED_EXPORT double time_unit(const std::vector<Component>& components);
/// The same for a state.
ED_EXPORT double time_unit(const System& system);

/// Volume of the bodies over volume of the box.
ED_EXPORT double packing_fraction(const System& system);

/// Edge of the cubic box in which `number` bodies of this shape have that packing fraction.
ED_EXPORT double box_for(const BodyShape& shape, int number, double packing_fraction);
/// The same for a mixture.
ED_EXPORT double box_for(const std::vector<Component>& components, double packing_fraction);

/// What keeps the list of the bodies that a body can meet short.
enum class Neighbours {
  dilated,  ///< bodies whose shapes, made thicker by the envelope's thickness, meet
  obp,      ///< the paper's: bodies whose oriented bounding parallelepipeds meet
  cells,    ///< the paper's plain algorithm: bodies in the same or an adjacent cell; no thickness
};

/// The enumerator's name.
ED_EXPORT const char* to_string(Neighbours neighbours);

/// The smallest box in which one image of every pair of these bodies is the only one that matters: box / 2 > 2 R + 4
/// delta_min, with R the largest bounding radius and delta_min the thinnest neighbour-list envelope in use; for cells,
/// box > 6 R, three cells; for obp of other bodies than ellipsoids of revolution, box / 2 > 2 R + 4 s, with s how far a
/// centre can move while its body stays in the thinnest box around it, which octahedra and cubes can turn in.
ED_EXPORT double smallest_box(const std::vector<Component>& components, Neighbours neighbours = Neighbours::dilated);

/// The smallest number of bodies of this shape and of uniform density whose box at this packing fraction is that large;
/// the largest int if it is larger. Throws std::invalid_argument if packing_fraction is not above 0.
ED_EXPORT int smallest_number(const BodyShape& shape, double packing_fraction,
                              Neighbours neighbours = Neighbours::dilated);

/// Kinetic energies and what they give for kT.
struct KineticState {
  double translational_energy = 0;
  double rotational_energy = 0;  ///< of bodies of revolution: of the motion across their axes only
  double spin_energy = 0;        ///< of bodies of revolution, about their axes
  double translational_kT = 0;   ///< on 3N - 3 degrees of freedom (momentum is zero)
  double rotational_kT = 0;      ///< on rotational_freedoms
  int rotational_freedoms = 0;   ///< 2 a body of revolution, 3 for others
  int spin_freedoms = 0;         ///< 1 a body of revolution that spins
  Eigen::Vector3d axis_energy =
      Eigen::Vector3d::Zero();  ///< of rotation about body x, y, z; these sum up the two above
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
  int overlaps = 0;    ///< pairs that overlap by more than kAuditOverlap allows
  int unanswered = 0;  ///< pairs whose distance query declined
  bool finite = true;  ///< all numbers of the state are finite
  KineticState kinetic;
};

/// A pair counts as overlapping in an audit when its distance is below -kAuditOverlap times the sum of its bounding
/// radii.
inline constexpr double kAuditOverlap = 1e-12;

/// Sums over all bodies, in units of kT where m and kT are 1.
ED_EXPORT KineticState kinetic_state(const System& system);

/// Checks a state from scratch by `geom::distance`, sharing nothing with the event loop. Distances are exact to 1e-13
/// times the pair's size (of bodies with flat faces or edges as geom/distance.h says). Throws std::invalid_argument for
/// a rotation that is not one; numbers that are not finite are reported, not thrown.
ED_EXPORT Audit audit(const System& system);

}  // namespace ed
