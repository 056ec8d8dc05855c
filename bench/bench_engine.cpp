/// Collisions a second of the whole engine, one core, with the counters that explain them. First line: the state point
/// that everything else is compared with, N = 512, X0 = 3, packing fraction 0.40.

#include <ed/simulation.h>
#include <ed/start.h>

#include <benchmark/benchmark.h>

#include <cmath>

namespace {

constexpr int kNumber = 512;
constexpr std::uint64_t kCollisions = 50000;

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

BENCHMARK_CAPTURE(engine, X0_3_phi_0 .40, 3.0, 0.40, false);
BENCHMARK_CAPTURE(engine, X0_3_phi_0 .30, 3.0, 0.30, false);
BENCHMARK_CAPTURE(engine, X0_2_phi_0 .45, 2.0, 0.45, false);
BENCHMARK_CAPTURE(engine, X0_2_phi_0 .30, 2.0, 0.30, false);
BENCHMARK_CAPTURE(engine, X0_5_phi_0 .30, 5.0, 0.30, false);
BENCHMARK_CAPTURE(engine, X0_1 .25_phi_0.50, 1.25, 0.50, false);
BENCHMARK_CAPTURE(engine, spheres_phi_0 .40, 1.0, 0.40, false);
BENCHMARK_CAPTURE(engine, X0_0 .5_phi_0.40, 0.5, 0.40, false);
BENCHMARK_CAPTURE(engine, X0_0 .33_phi_0.40, 1.0 / 3, 0.40, false);
BENCHMARK_CAPTURE(engine, X0_3_phi_0 .40_with_spin, 3.0, 0.40, true);

}  // namespace

int main(int argc, char** argv) {
  benchmark::AddCustomContext("march", HARDBODY_ARCH_NAME);
  benchmark::Initialize(&argc, argv);
  benchmark::RunSpecifiedBenchmarks();
  benchmark::Shutdown();
}
