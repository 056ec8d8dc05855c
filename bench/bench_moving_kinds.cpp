/// Time of one contact prediction of spheres, capsules, boxes, polyhedra and a user's shape, by ed::time_of_contact and
/// by conservative advancement of first order, t += d / (largest possible |dd/dt|) until d is below a floor, with
/// ed::distance. Pairs are near neighbours of a fluid with a packing fraction of 0.40, searched over one time unit.
/// Ratios within this run; they flatter the advancement, which ends a floor away from the contact.

#include <common/ed/all_pairs.h>
#include <common/geom/shapes.h>

#include <ed/ed.h>

#include <geom/geom.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace {

constexpr double kHorizon = 1;
constexpr double kFloor = 1e-6;  // of the pair's size

struct Kind {
  std::string name;
  ed::Species species;
};

std::vector<Kind> all_kinds() {
  const auto uniform = [](const auto& shape) { return ed::uniform_species(shape); };
  const geom::Capsule rod(1, 0.5);
  const ed::CustomShape users(geom_test::Spherocylinder{1, 0.5}, {"rod", rod.volume(), 2, true});
  return {{"spheres", uniform(geom::Sphere(0.5))},
          {"capsules", uniform(rod)},
          {"rounded boxes", uniform(geom::Rounded<geom::Box>(geom::Box({0.5, 0.5, 0.5}), 0.05))},
          {"cubes", uniform(geom::Box({0.5, 0.5, 0.5}))},
          {"dodecahedra", uniform(geom::ConvexPolyhedron::in_principal_frame(geom::solid_vertices("dodecahedron")))},
          {"a user's spherocylinders", {users, 1, rod.inertia(1), true}}};
}

struct MovingPair {
  ed::Motion a, b;
};

std::vector<MovingPair> near_neighbours(const ed::Species& species) {
  ed::StartOptions options;
  options.number = 200;
  options.packing_fraction = 0.40;
  ed::Simulation simulation(ed::random_start(species, options));
  simulation.run_collisions(4000);
  const ed::System system = simulation.system();
  const double reach = 1.1 * 2 * ed::bounding_radius(species.shape);
  std::vector<MovingPair> pairs;
  const auto motion = [&](const ed::Body& body, const Eigen::Vector3d& position) -> ed::Motion {
    return {geom::Pose(body.rotation, position), body.velocity, body.angular_velocity, species.inertia, 0};
  };
  ed_test::for_each_pair(system, [&](const ed::Body& a, const ed::Body& b, const Eigen::Vector3d& r) {
    if (r.norm() < reach) pairs.push_back({motion(a, Eigen::Vector3d::Zero()), motion(b, r)});
  });
  return pairs;
}

struct Totals {
  long contacts = 0;
  long evaluations = 0;
};

Totals search(const ed::BodyShape& shape, const std::vector<MovingPair>& pairs) {
  Totals totals;
  for (const MovingPair& pair : pairs) {
    const ed::ContactResult found = ed::time_of_contact(shape, pair.a, shape, pair.b, kHorizon);
    totals.contacts += found.status == ed::ContactStatus::hit ? 1 : 0;
    totals.evaluations += found.evaluations;
  }
  return totals;
}

Totals advance(const ed::BodyShape& shape, const std::vector<MovingPair>& pairs) {
  Totals totals;
  const double radius = ed::bounding_radius(shape);
  for (const MovingPair& pair : pairs) {
    // Angular speeds of bodies whose moments differ change: the largest is bounded by the energy.
    const auto fastest = [](const ed::Motion& motion) {
      const Eigen::Vector3d omega = motion.pose.rotation().transpose() * motion.angular_velocity;
      return std::sqrt(motion.inertia.dot(omega.cwiseAbs2()) / motion.inertia.minCoeff());
    };
    const double rate = (pair.b.velocity - pair.a.velocity).norm() + radius * (fastest(pair.a) + fastest(pair.b));
    double t = 0;
    while (t < kHorizon) {
      ++totals.evaluations;
      const ed::Motion a = ed::propagate(pair.a, t);
      const ed::Motion b = ed::propagate(pair.b, t);
      const double d = ed::distance(shape, a.pose, shape, b.pose).distance;
      if (!(d > kFloor * 2 * radius)) {
        ++totals.contacts;
        break;
      }
      t += d / rate;
    }
  }
  return totals;
}

using Method = Totals (*)(const ed::BodyShape&, const std::vector<MovingPair>&);

void predictions(benchmark::State& timing, const ed::Species& species, Method method) {
  const std::vector<MovingPair> pairs = near_neighbours(species);
  Totals totals;
  for (auto _ : timing) totals = method(species.shape, pairs);
  const auto number = static_cast<double>(pairs.size());
  timing.counters["prediction"] =
      benchmark::Counter(number, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  timing.counters["evaluations"] = static_cast<double>(totals.evaluations) / number;
  timing.counters["contacts"] = static_cast<double>(totals.contacts) / number;
}

/// Prints as usual and keeps the time of a prediction.
class KeepTimes : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      if (run.error_occurred || (run.repetitions > 1 && run.aggregate_name != "median")) continue;
      times_[run.run_name.function_name] = run.counters.at("prediction").value;
    }
    benchmark::ConsoleReporter::ReportRuns(runs);
  }
  /// Returns the time in nanoseconds; NaN if the filter left that benchmark out.
  double of(const std::string& name) const {
    const auto found = times_.find(name);
    return found == times_.end() ? std::nan("") : 1e9 * found->second;
  }

 private:
  std::map<std::string, double> times_;
};

}  // namespace

int main(int argc, char** argv) {
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  for (const Kind& kind : all_kinds()) {
    const auto add = [&kind](const char* name, Method method) {
      benchmark::RegisterBenchmark((kind.name + name).c_str(), [kind, method](benchmark::State& timing) {
        predictions(timing, kind.species, method);
      })->Unit(benchmark::kMillisecond);
    };
    add("/certified", search);
    add("/advancement", advance);
  }
  KeepTimes times;
  benchmark::RunSpecifiedBenchmarks(&times);
  benchmark::Shutdown();
  std::printf("\n%-26s %12s %12s %22s\n", "", "certified", "advancement", "advancement/certified");
  for (const Kind& kind : all_kinds()) {
    const double certified = times.of(kind.name + "/certified");
    const double advancement = times.of(kind.name + "/advancement");
    std::printf("%-26s %12.0f %12.0f %22.1f\n", kind.name.c_str(), certified, advancement, advancement / certified);
  }
  std::printf("ns per prediction; floor of the advancement %g of the pair's size\n", kFloor);
}
