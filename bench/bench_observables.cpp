/// Share of a run that its observables take: N = 512, a production of 60 time units with the program's defaults,
/// against the same run without observables, in turn. Frames of a trajectory are not included: none are written by
/// default.

#include <ed/observables.h>
#include <ed/simulation.h>
#include <ed/start.h>

#include <geom/ellipsoid.h>
#include <geom/superellipsoid.h>

#include <benchmark/benchmark.h>

#include <algorithm>
#include <ctime>
#include <string>
#include <vector>

namespace {

constexpr double kDuration = 60;
constexpr int kRounds = 3;

struct Case {
  std::string name;
  std::vector<ed::Component> components;
  double packing_fraction;
};

std::vector<Case> all_cases() {
  const ed::Species prolate = ed::paper_species(geom::Ellipsoid({1, 1, 3}));
  const ed::Species oblate = ed::paper_species(geom::Ellipsoid({1, 1, 0.5}));
  const ed::Species sphere = ed::uniform_species(geom::Ellipsoid({1, 1, 1}));
  return {{"prolate X0=3 0.40", {{prolate, 512}}, 0.40},
          {"oblate X0=1/2 0.45", {{oblate, 512}}, 0.45},
          {"biaxial 0.7:1:1.6 0.40", {{ed::uniform_species(geom::Ellipsoid({0.7, 1, 1.6})), 512}}, 0.40},
          {"superballs p=4 0.40", {{ed::uniform_species(geom::Superellipsoid({1, 1, 1}, 0.5, 0.5)), 512}}, 0.40},
          {"prolate and oblate 0.40", {{prolate, 256}, {oblate, 256}}, 0.40},
          {"spheres 0.40", {{sphere, 512}}, 0.40}};
}

ed::ObservablesOptions options_for(const ed::System& system, const std::vector<ed::Component>& components) {
  ed::ObservablesOptions options{};
  options.number = system.size();
  options.duration = kDuration;
  options.time_unit = ed::time_unit(system);
  options.wave_numbers = ed::wave_numbers_about(ed::structure_peak(system));
  for (const ed::Component& c : components) {
    options.groups.push_back({c.number, ed::symmetry_axis(c.species) ? 2 : 3, !ed::is_sphere(c.species.shape)});
  }
  return options;
}

double processor_time() {
  return static_cast<double>(std::clock()) / CLOCKS_PER_SEC;
}

double time_without(const ed::System& system) {
  ed::Simulation simulation(system);
  const double begin = processor_time();
  simulation.run_until(kDuration);
  return processor_time() - begin;
}

double time_with(const ed::System& system, const ed::ObservablesOptions& options) {
  ed::Simulation simulation(system);
  ed::Observables observables(options);
  const double begin = processor_time();
  while (observables.next_time() <= kDuration) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  simulation.run_until(kDuration);
  return processor_time() - begin;
}

void observables(benchmark::State& timing, const Case& one) {
  ed::StartOptions start;
  start.packing_fraction = one.packing_fraction;
  const ed::System system = ed::random_start(one.components, start);
  const ed::ObservablesOptions options = options_for(system, one.components);
  std::vector<double> with, without;
  for (auto _ : timing) {
    for (int k = 0; k < kRounds; ++k) {
      without.push_back(time_without(system));
      with.push_back(time_with(system, options));
    }
  }
  const double least = *std::min_element(without.begin(), without.end());
  timing.counters["without, s"] = least;
  timing.counters["share %"] = 100 * (1 - least / *std::min_element(with.begin(), with.end()));
}

}  // namespace

int main(int argc, char** argv) {
  for (const Case& one : all_cases()) {
    benchmark::RegisterBenchmark(("observables/" + one.name).c_str(), observables, one)
        ->Iterations(1)
        ->Unit(benchmark::kSecond);
  }
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  benchmark::RunSpecifiedBenchmarks();
}
