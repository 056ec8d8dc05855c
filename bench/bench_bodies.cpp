/// Collisions a second of the event loop for bodies beyond ellipsoids of revolution, one core, N = 512, packing
/// fraction 0.40, with the counters that explain them. Beside each its share of the rate of ellipsoids of revolution
/// with X0 = 3 in the same run, which no machine changes much.

#include "engine_rates.h"

#include <ed/simulation.h>
#include <ed/start.h>

#include <geom/geom.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <cstdio>
#include <numbers>
#include <optional>
#include <string>
#include <vector>

namespace {

constexpr int kNumber = 512;
constexpr double kPacking = 0.40;
constexpr int kStretches = 5;
const char* const kReference = "ellipsoids 1:1:3";

struct Bodies {
  std::string name;
  ed::Species species;
  std::uint64_t collisions = 20000;                  ///< collisions of a stretch
  std::optional<ed::Species> beside = std::nullopt;  ///< species of half of the bodies
};

/// A user's shape, as that of docs/user-shapes.md.
struct Spherocylinder {
  double half_length, radius;

  geom::Support support(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d end(0, 0, std::copysign(half_length, n.z()));
    return {half_length * std::abs(n.z()) + radius * n.norm(), end + radius * n.normalized()};
  }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d m = n.normalized();
    return radius / n.norm() * (Eigen::Matrix3d::Identity() - m * m.transpose());
  }
  double bounding_radius() const { return half_length + radius; }
  double inscribed_radius() const { return radius; }
  double min_curvature_radius() const { return radius; }
};

/// Semi-axis of ellipsoids 1:1:3 with the volume of capsules with L/D = 2, D = 1.
const double kSameVolume = std::cbrt((2 + 2.0 / 3) / 16);

std::vector<Bodies> all_bodies() {
  const auto uniform = [](const auto& shape) { return ed::uniform_species(shape); };
  const auto superellipsoid = [&](const Eigen::Vector3d& axes, double e) {
    return uniform(geom::Superellipsoid(axes, e, e));
  };
  const double volume = std::numbers::pi * 0.25 * (2 + 2.0 / 3);
  const ed::CustomShape rod(Spherocylinder{1, 0.5}, {"rod", volume, 2, true});
  return {
      {kReference, uniform(geom::Ellipsoid({1, 1, 3}))},
      {"ellipsoids 1:0.8:0.5", uniform(geom::Ellipsoid({1, 0.8, 0.5}))},
      {"superballs p=2.5", superellipsoid({1, 1, 1}, 0.8)},
      {"superballs p=4", superellipsoid({1, 1, 1}, 0.5)},
      {"superellipsoids 1:1:2 e=0.5", superellipsoid({1, 1, 2}, 0.5)},
      {"superellipsoids 1:1:3 e=1", superellipsoid({1, 1, 3}, 1)},
      {"spheres", uniform(geom::Sphere(0.5)), 100000},
      {"capsules L/D=2", uniform(geom::Capsule(1, 0.5))},
      {"capsules L/D=5", uniform(geom::Capsule(2.5, 0.5))},
      {"capsules L/D=2 and ellipsoids 1:1:3", uniform(geom::Capsule(1, 0.5)), 20000,
       uniform(geom::Ellipsoid(kSameVolume * Eigen::Vector3d(1, 1, 3)))},
      {"rounded boxes 0.05", uniform(geom::Rounded<geom::Box>(geom::Box({0.5, 0.5, 0.5}), 0.05)), 4000},
      {"cubes", uniform(geom::Box({0.5, 0.5, 0.5})), 4000},
      {"dodecahedra", uniform(geom::ConvexPolyhedron::in_principal_frame(geom::solid_vertices("dodecahedron"))), 2000},
      {"cylinders L/D=2", uniform(geom::Cylinder(1, 0.5)), 2000},
      {"cones L/D=1", uniform(geom::Cone(1, 0.5)), 2000},
      {"a user's spherocylinders", {rod, 1, {0.7, 0.7, 0.12}, true}, 1000}};
}

void engine(benchmark::State& timing, const Bodies& bodies) {
  ed::StartOptions options;
  options.packing_fraction = kPacking;
  std::vector<ed::Component> components{{bodies.species, kNumber}};
  if (bodies.beside) components = {{bodies.species, kNumber / 2}, {*bodies.beside, kNumber / 2}};
  ed::Simulation simulation(ed::random_start(components, options));
  simulation.run_collisions(bodies.collisions);
  simulation.tune_envelopes();
  const ed::Counters before = simulation.counters();
  for (auto _ : timing) simulation.run_collisions(bodies.collisions);
  hardbody_bench::report_rates(timing, before, simulation.counters());
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::AddCustomContext("march", HARDBODY_ARCH_NAME);
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  for (const Bodies& bodies : all_bodies()) {
    benchmark::RegisterBenchmark(bodies.name.c_str(), [bodies](benchmark::State& timing) { engine(timing, bodies); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(kStretches);
  }
  hardbody_bench::KeepRates rates;
  benchmark::RunSpecifiedBenchmarks(&rates);
  benchmark::Shutdown();
  const double reference = rates.rate(kReference);
  if (std::isnan(reference)) return 0;
  std::printf("\nshare of the rate of %s\n", kReference);
  for (const Bodies& bodies : all_bodies()) {
    std::printf("%-30s %.2f\n", bodies.name.c_str(), rates.rate(bodies.name) / reference);
  }
}
