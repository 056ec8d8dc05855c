/// Collisions a second of the whole engine, one core, with the counters that explain them. First line: the state point
/// that everything else is compared with, N = 512, X0 = 3, packing fraction 0.40.

#include <ed/simulation.h>
#include <ed/start.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <string>

namespace {

constexpr int kNumber = 512;
constexpr std::uint64_t kCollisions = 50000;  // of an iteration
constexpr int kStretches = 6;

/// Started, tuned and warmed up as the program does it.
ed::Simulation prepare(double X0, double packing_fraction, bool uniform) {
  const geom::Ellipsoid shape({std::pow(X0, -1.0 / 3), std::pow(X0, -1.0 / 3), std::pow(X0, 2.0 / 3)});
  ed::StartOptions options;
  options.number = kNumber;
  options.packing_fraction = packing_fraction;
  ed::Simulation simulation(ed::random_start(uniform ? ed::uniform_species(shape) : ed::paper_species(shape), options));
  simulation.tune_envelopes();
  simulation.run_collisions(kCollisions);
  return simulation;
}

void engine(benchmark::State& state, double X0, double packing_fraction, bool uniform) {
  ed::Simulation simulation = prepare(X0, packing_fraction, uniform);
  const ed::Counters before = simulation.counters();
  for (auto _ : state) simulation.run_collisions(kCollisions);
  const ed::Counters after = simulation.counters();
  const auto collisions = static_cast<double>(after.collisions - before.collisions);
  const auto each = [&](std::uint64_t ed::Counters::*counter) {
    return static_cast<double>(after.*counter - before.*counter) / collisions;
  };
  state.counters["collisions/s"] = benchmark::Counter(collisions, benchmark::Counter::kIsRate);
  state.counters["evaluations"] = each(&ed::Counters::evaluations);
  state.counters["refinements"] = each(&ed::Counters::refinements);
  state.counters["kernel_calls"] = each(&ed::Counters::kernel_calls);
  state.counters["rebuilds"] = each(&ed::Counters::neighbour_rebuilds);
  state.counters["rescues"] = static_cast<double>(after.rescues);
}

void add(double X0, double packing_fraction, bool uniform) {
  std::ostringstream name;
  name << std::setprecision(3) << "engine/X0:" << X0 << "/phi:" << packing_fraction << (uniform ? "/spin" : "");
  benchmark::RegisterBenchmark(name.str().c_str(),
                               [=](benchmark::State& state) { engine(state, X0, packing_fraction, uniform); })
      ->Unit(benchmark::kMillisecond)
      ->Iterations(kStretches);  // fixed: a start takes longer than the stretches that are timed
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::AddCustomContext("march", HARDBODY_ARCH_NAME);
  benchmark::AddCustomContext("number", std::to_string(kNumber));
  benchmark::Initialize(&argc, argv);
  add(3, 0.40, false);
  for (const double X0 : {1.0 / 3, 0.5, 1.0, 2.0, 3.0, 5.0}) {
    for (const double packing_fraction : {0.30, 0.40}) {
      if (X0 != 3 || packing_fraction != 0.40) add(X0, packing_fraction, false);
    }
  }
  // State points that other codes were measured at, and what spin costs.
  add(2, 0.45, false);
  add(1.25, 0.50, false);
  add(3, 0.40, true);
  add(0.5, 0.40, true);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
