#include "sweep/tasks/cost_model.h"

#include "run/phases/production.h"

#include <algorithm>
#include <cmath>

namespace hardbody {
namespace {

/// Collisions of a body in a thermal time, divided by phi (1 - phi/2) / (1 - phi)^3: exp of a polynomial in the squared
/// logarithm of the largest over the smallest semi-axis. Fitted to the 607 points of data/paper/points.csv: 3.4 % off
/// (root mean square), 23 % at most.
constexpr double kRate[] = {1.920, 1.288, -0.1665};

// Equilibration "auto" in thermal times: a mean of powers of four terms. Fitted by tools/paper/equilibration_fit.py to
// the points of that file that equilibrated and are isotropic: 13 % off (root mean square), a factor of 2.6 at most. l
// is the logarithm of the largest over the smallest semi-axis, Gamma the rate of collisions.
constexpr double kLeastEquilibration = 8;
constexpr double kMostEquilibration = 60;        ///< limit near a transition; what orders may take longer
constexpr double kTurns = 0.8606;                ///< factor of 1 / (Gamma l^2): near spheres hardly turn in a collision
constexpr double kNematic[] = {0.9163, 0.3348};  ///< packing fraction of the transition to a nematic, down with l
constexpr double kElongated = 0.5;               ///< least l of what becomes nematic
constexpr double kNearNematic = 2.278;           ///< factor of 1 / (relative distance from that transition)
constexpr double kGlass[] = {17.74, 22.70, 2.389};  ///< time at 0.5; growth with the packing fraction; decay with l
constexpr double kSharpness = 8;                    ///< power of the mean: the longest term dominates

/// Relative error of a diffusion coefficient, of 512 bodies, at the first test of a target error.
constexpr double kReferenceError = 0.03;
constexpr double kReferenceNumber = 512;

// Durations in seconds on one core, fitted to 30 runs of 512 ellipsoids of revolution: 14 % off (root mean square).
constexpr double kCollision = 4.0e-6;
constexpr double kElongation = 0.25;         ///< growth of the time of a collision, and of a start, with l
constexpr double kThermalTime = 1.2e-5;      ///< measurements of a body in a thermal time
constexpr double kBody = 5e-4;               ///< start and results of a body
constexpr double kStartCollisions = 2.9e-4;  ///< start of a body, for each collision that it has in a thermal time
constexpr double kProcess = 0.03;            ///< start of a process, files
// Factors of collisions, by docs/performance.md.
constexpr double kSpheres = 0.25;
constexpr double kNorms = 4;  ///< superellipsoids, and ellipsoids with three axes or moments
constexpr double kCores = 5;  ///< boxes, polyhedra and other shapes with edges

// Bytes.
constexpr double kProgramMemory = 1.5e7;
constexpr double kBodyMemory = 1.2e4;

/// Logarithm of the largest over the smallest semi-axis; of other shapes of their radii.
double elongation(const SpeciesConfig& species) {
  const ShapeConfig& shape = species.shape;
  if (!has_semi_axes(shape.kind)) {
    return std::log(ed::bounding_radius(species.body.shape) / ed::inscribed_radius(species.body.shape));
  }
  if (shape.semi_axes) return std::log(shape.semi_axes->maxCoeff() / shape.semi_axes->minCoeff());
  return std::abs(std::log(shape.aspect_ratio.value_or(1)));
}

double collision_rate(double elongation, double phi) {
  const double x = elongation * elongation;
  const double contact = phi * (1 - phi / 2) / std::pow(1 - phi, 3);
  // Beyond the fit's range, aspect ratios of 5, the polynomial would come down again.
  const double within = std::min(x, 2.6);
  return contact * std::exp(kRate[0] + kRate[1] * within + kRate[2] * within * within);
}

/// Mean over the bodies of what a function says of their species.
template <class Function>
double mean(const Config& config, Function&& of) {
  double sum = 0;
  double bodies = 0;
  for (const SpeciesConfig& species : config.species) {
    sum += species.number * of(species);
    bodies += species.number;
  }
  return bodies > 0 ? sum / bodies : of(config.species.front());
}

/// Time of a collision, relative to that of nearly spherical ellipsoids of revolution.
double hardness(const Config& config, const SpeciesConfig& species) {
  if (is_sphere(species)) return kSpheres;
  const double elongated = 1 + kElongation * elongation(species);
  if (config.all_of_revolution()) return elongated;
  return elongated * (has_semi_axes(species.shape.kind) ? kNorms : kCores);
}

/// Thermal times until a fluid of one kind of bodies has equilibrated.
double relaxation(double elongation, double phi) {
  const double nematic = kNematic[0] - kNematic[1] * elongation;
  const double near_nematic = elongation > kElongated ? kNearNematic / std::max(1 - phi / nematic, 0.02) : 0;
  const double near_glass = kGlass[0] * std::exp(kGlass[1] * (phi - 0.5) - kGlass[2] * elongation);
  const double turns = collision_rate(elongation, phi) * elongation * elongation;
  double sum = 0;
  for (const double term : {kLeastEquilibration, turns > 0 ? kTurns / turns : 0, near_nematic, near_glass}) {
    sum += std::pow(term, kSharpness);
  }
  return std::min(std::pow(sum, 1 / kSharpness), kMostEquilibration);
}

double equilibration(const Config& config) {
  if (config.equilibration_time) return *config.equilibration_time;
  double longest = kLeastEquilibration;
  for (const SpeciesConfig& species : config.species) {
    longest = std::max(longest, relaxation(elongation(species), config.packing_fraction));
  }
  return std::min(longest * config.time_unit, config.equilibration_cap);
}

double production(const Config& config, double equilibration, double rate) {
  const double length =
      production_times(config, equilibration, config.number / 2.0 * rate * equilibration / config.time_unit).length;
  if (config.production_time || !config.target_error) return length;
  const double finer = kReferenceError / *config.target_error;
  return std::min(length * std::max(1.0, finer * finer * kReferenceNumber / config.number),
                  kMostProduction * config.time_unit);
}

}  // namespace

Cost cost_by_config(const Config& config) {
  const double number = config.number;
  const double phi = config.packing_fraction;
  const double rate = mean(config, [phi](const SpeciesConfig& s) { return collision_rate(elongation(s), phi); });
  const double harder = mean(config, [&config](const SpeciesConfig& s) { return hardness(config, s); });
  const double first = equilibration(config);
  const double times = (first + production(config, first, rate)) / config.time_unit;
  const double collisions = number / 2 * rate * times;
  const double start = number * (kBody + harder * rate * kStartCollisions);
  return {kProcess + start + number * times * kThermalTime + harder * collisions * kCollision,
          kProgramMemory + number * kBodyMemory};
}

}  // namespace hardbody
