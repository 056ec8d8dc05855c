#include "sweep/tasks/cost_model.h"

#include <algorithm>
#include <cmath>

namespace hardbody {
namespace {

/// Collisions of a body in a thermal time, divided by phi (1 - phi/2) / (1 - phi)^3: exp of a polynomial in the squared
/// logarithm of the largest over the smallest semi-axis. Fitted to the 607 points of data/paper/points.csv: 3.4 % off
/// (root mean square), 23 % at most.
constexpr double kRate[] = {1.920, 1.288, -0.1665};

/// Equilibration "auto" of a simple fluid, in thermal times: the median of those points is 8.
constexpr double kEquilibration = 9;
constexpr double kProductionOverEquilibration = 30;
constexpr double kLeastCollisions = 400;  ///< mean collision intervals that production "auto" lasts
/// Production with a target error: that of 0.03 for 512 bodies.
constexpr double kPreciseProduction = 300;
constexpr double kReferenceError = 0.03;
constexpr double kReferenceNumber = 512;

// Durations in seconds on one core, fitted to 28 runs of 108 to 4000 ellipsoids of revolution.
constexpr double kCollision = 3.1e-6;
constexpr double kOtherShapes = 11;        ///< factor of collisions of other shapes; two runs
constexpr double kThermalTime = 8e-6;      ///< measurements of a body in a thermal time
constexpr double kBody = 5e-4;             ///< start and results of a body
constexpr double kStartCollisions = 5e-5;  ///< start of a body, for each collision that it has in a thermal time
constexpr double kProcess = 0.03;          ///< start of a process, files

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

double mean_rate(const Config& config) {
  double sum = 0;
  double bodies = 0;
  for (const SpeciesConfig& species : config.species) {
    sum += species.number * collision_rate(elongation(species), config.packing_fraction);
    bodies += species.number;
  }
  return bodies > 0 ? sum / bodies : collision_rate(0, config.packing_fraction);
}

double equilibration(const Config& config) {
  return config.equilibration_time.value_or(std::min(kEquilibration * config.time_unit, config.equilibration_cap));
}

double production(const Config& config, double rate) {
  if (config.production_time) return *config.production_time;
  const double unit = config.time_unit;
  if (!config.target_error) {
    const double usual = kProductionOverEquilibration * std::max(equilibration(config), unit);
    return std::clamp(std::max(usual, kLeastCollisions / rate * unit), kLeastProduction * unit, kMostProduction * unit);
  }
  const double finer = kReferenceError / *config.target_error;
  const double longer = std::max(1.0, finer * finer * kReferenceNumber / config.number);
  return std::min(kPreciseProduction * longer, kMostProduction) * unit;
}

}  // namespace

Cost cost_by_config(const Config& config) {
  const double number = config.number;
  const double rate = mean_rate(config);
  const double times = (equilibration(config) + production(config, rate)) / config.time_unit;
  const double collisions = number / 2 * rate * times;
  const double harder = config.all_of_revolution() ? 1 : kOtherShapes;
  const double start = number * (kBody + harder * rate * kStartCollisions);
  return {kProcess + start + number * times * kThermalTime + harder * collisions * kCollision,
          kProgramMemory + number * kBodyMemory};
}

}  // namespace hardbody
