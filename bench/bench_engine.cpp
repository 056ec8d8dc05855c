/// Collisions a second of the whole engine, one core, with the counters that explain them.
///
/// engine/...: the default path. First line: the state point that everything else is compared with, N = 512, X0 = 3,
/// packing fraction 0.40. methods/...: every finder, kind of neighbour list and distance method. dilute/...: dilated
/// envelopes against cells, the choice of neighbours = "auto". rescues/...: the share of the distances that Newton's
/// method declines. vectors/...: pairs looked at one by one, and in the vectors of each instruction set. scale/...:
/// from 10^3 to 10^6 bodies, with the seconds that the start takes and the memory. The tables at the end give ratios
/// within the run.

#include "engine_rates.h"

#include <ed/simulation.h>
#include <ed/start.h>

#include <benchmark/benchmark.h>

#include <malloc.h>
#include <unistd.h>

#include <algorithm>
#include <chrono>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <fstream>
#include <iomanip>
#include <map>
#include <optional>
#include <sstream>
#include <string>
#include <utility>
#include <vector>

namespace {

using hardbody_bench::KeepRates;

constexpr int kNumber = 512;
constexpr int kStretches = 6;

struct StatePoint {
  double X0;
  double packing_fraction;
  bool uniform = false;  // inertia; with spin
  int number = kNumber;

  std::string name() const {
    std::ostringstream text;
    text << std::setprecision(3) << "X0:" << X0 << "/phi:" << packing_fraction << (uniform ? "/spin" : "");
    return text.str();
  }
};

struct Method {
  ed::Finder finder = ed::Finder::certified;
  ed::Neighbours neighbours = ed::Neighbours::dilated;
  ed::DistanceMethod distance = ed::DistanceMethod::dual;
  std::optional<geom::InstructionSet> batches = geom::InstructionSet::best;

  std::string name() const {
    const char* const lists[] = {"dilated", "obp", "cells"};
    const char* const distances[] = {"dual", "newton8", "newton5"};
    return std::string(finder == ed::Finder::certified ? "certified" : "bracketing") + "/" +
           lists[static_cast<int>(neighbours)] + "/" + distances[static_cast<int>(distance)];
  }
  /// Returns the number of collisions of an iteration: some tenths of a second.
  std::uint64_t collisions() const {
    if (finder == ed::Finder::certified) return 50000;
    return distance == ed::DistanceMethod::dual ? 3000 : 500;
  }
};

/// The paper's own: bracketing, 5 equations, oriented boxes.
constexpr Method kPaper{ed::Finder::bracketing, ed::Neighbours::obp, ed::DistanceMethod::newton5};

const ed::System& start(const StatePoint& state) {
  static std::map<std::pair<std::string, int>, ed::System> starts;
  ed::System& system = starts[{state.name(), state.number}];
  if (system.bodies.empty()) {
    const geom::Ellipsoid shape(
        {std::pow(state.X0, -1.0 / 3), std::pow(state.X0, -1.0 / 3), std::pow(state.X0, 2.0 / 3)});
    ed::StartOptions options;
    options.number = state.number;
    options.packing_fraction = state.packing_fraction;
    system = ed::random_start(state.uniform ? ed::uniform_species(shape) : ed::paper_species(shape), options);
    ed::Simulation simulation(system);
    // Large starts are boxes repeated: some collisions a body make them differ.
    const std::uint64_t each = state.number <= 2000 ? 100 : 3;
    simulation.run_collisions(each * static_cast<std::uint64_t>(state.number));
    system = simulation.system();
  }
  return system;
}

/// Tuned as the program does it: on a copy.
ed::Simulation prepare(const StatePoint& state, const Method& method) {
  ed::SimulationOptions options;
  options.neighbours = method.neighbours;
  options.contact.finder = method.finder;
  options.contact.distance = method.distance;
  options.batches = method.batches;
  ed::Simulation trial(start(state), options);
  trial.tune_envelopes();
  options.envelope = trial.envelope();
  return ed::Simulation(start(state), options);
}

void engine(benchmark::State& timing, const StatePoint& state, const Method& method) {
  ed::Simulation simulation = prepare(state, method);
  const ed::Counters before = simulation.counters();
  for (auto _ : timing) simulation.run_collisions(method.collisions());
  hardbody_bench::report_rates(timing, before, simulation.counters());
}

/// Returns the resident memory of the process, in bytes.
double memory() {
  std::ifstream statm("/proc/self/statm");
  double total = 0;
  double resident = 0;
  statm >> total >> resident;
  return resident * static_cast<double>(sysconf(_SC_PAGESIZE));
}

constexpr int kScaleNumbers[] = {1000, 10000, 100000, 1000000};

StatePoint scale_state(int number) {
  return {2, 0.40, false, number};
}

std::string scale_name(int number) {
  return "scale/" + std::to_string(number);
}

void scale(benchmark::State& timing, int number) {
  const auto begin = std::chrono::steady_clock::now();
  const ed::System& system = start(scale_state(number));
  const std::chrono::duration<double> seconds = std::chrono::steady_clock::now() - begin;
  malloc_trim(0);
  const double before = memory();
  // The one that has been tuned: tens of collisions a body make its lists as old as they are in a long run.
  ed::Simulation simulation(system);
  simulation.tune_envelopes();
  const ed::Counters counters = simulation.counters();
  const auto stretch = static_cast<std::uint64_t>(std::max(100000, number / 2));
  for (auto _ : timing) simulation.run_collisions(stretch);
  hardbody_bench::report_rates(timing, counters, simulation.counters());
  malloc_trim(0);
  timing.counters["start s"] = seconds.count();
  timing.counters["kB a body"] = (memory() - before) / 1000 / system.size();
}

std::string method_name(const StatePoint& state, const Method& method) {
  return "methods/" + state.name() + "/" + method.name();
}

std::string dilute_name(const StatePoint& state, const Method& method) {
  return "dilute/" + state.name() + "/" + method.name();
}

void add(const std::string& name, const StatePoint& state, const Method& method, int stretches = kStretches) {
  benchmark::RegisterBenchmark(name.c_str(), [=](benchmark::State& timing) { engine(timing, state, method); })
      ->Unit(benchmark::kMillisecond)
      ->Iterations(stretches);  // fixed: a start takes longer than the stretches that are timed
}

/// Rods, discs, spheres; spin; the dense states of other codes.
const std::vector<StatePoint>& vector_states() {
  static const std::vector<StatePoint> states{{3, 0.40}, {1.0 / 3, 0.40}, {1, 0.40},
                                              {5, 0.40}, {1.25, 0.50},    {1.1, 0.40},
                                              {3, 0.10}, {3, 0.40, true}, {0.5, 0.40, true}};
  return states;
}

/// First: one by one.
const std::vector<Method>& vector_methods() {
  static const std::vector<Method> methods = [] {
    std::vector<Method> all(1);
    all[0].batches.reset();
    for (const auto set : {geom::InstructionSet::portable, geom::InstructionSet::avx2, geom::InstructionSet::avx512}) {
      if (!geom::is_available(set)) continue;
      all.emplace_back();
      all.back().batches = set;
    }
    return all;
  }();
  return methods;
}

std::string vector_name(const StatePoint& state, const Method& method) {
  return "vectors/" + state.name() + "/" + (method.batches ? geom::to_string(*method.batches) : "one by one");
}

const std::vector<StatePoint>& method_states() {
  static const std::vector<StatePoint> states{{3, 0.40}, {2, 0.40}, {1.0 / 3, 0.40}, {1, 0.40},
                                              {3, 0.05}, {1, 0.05}, {3, 0.01},       {1, 0.01}};
  return states;
}

/// Returns the states in which cells may be the fastest, at least three of them along an edge.
const std::vector<StatePoint>& dilute_states() {
  static const std::vector<StatePoint> states = [] {
    std::vector<StatePoint> all;
    for (const double X0 : {1.0 / 3, 2.0, 3.0, 5.0, 10.0}) {
      for (const double packing_fraction : {0.02, 0.04, 0.06, 0.08, 0.10, 0.15}) {
        const double R = std::max(std::pow(X0, 2.0 / 3), std::pow(X0, -1.0 / 3));
        const double box = std::cbrt(4.0 / 3 * M_PI * kNumber / packing_fraction);
        if (box > 3.001 * 2 * R) all.push_back({X0, packing_fraction});
      }
    }
    return all;
  }();
  return states;
}

/// State in which Newton's method for the distance fares worst, or the paper's state.
struct HardState {
  StatePoint state;
  ed::Neighbours neighbours;
};
constexpr HardState kHardStates[] = {
    {{10, 0.10, false, 600}, ed::Neighbours::cells},
    {{10, 0.40, false, 1024}, ed::Neighbours::obp},
    {{0.12, 0.25}, ed::Neighbours::obp},
    {{3, 0.40}, ed::Neighbours::obp},
};

constexpr Method kDilute[] = {
    {ed::Finder::certified, ed::Neighbours::dilated, ed::DistanceMethod::dual},
    {ed::Finder::certified, ed::Neighbours::cells, ed::DistanceMethod::dual},
    {ed::Finder::bracketing, ed::Neighbours::dilated, ed::DistanceMethod::dual},
    {ed::Finder::bracketing, ed::Neighbours::cells, ed::DistanceMethod::dual},
};

std::vector<Method> methods() {
  std::vector<Method> all;
  for (const auto neighbours : {ed::Neighbours::dilated, ed::Neighbours::obp, ed::Neighbours::cells}) {
    all.push_back({ed::Finder::certified, neighbours, ed::DistanceMethod::dual});
    for (const auto distance : {ed::DistanceMethod::dual, ed::DistanceMethod::newton8, ed::DistanceMethod::newton5}) {
      all.push_back({ed::Finder::bracketing, neighbours, distance});
    }
  }
  return all;
}

void print_methods(const KeepRates& rates) {
  std::printf("\n%-18s %-22s %10s %10s %10s | %13s %11s\n", "collisions/s", "finder, distance", "dilated", "obp",
              "cells", "dilated / obp", "obp / cells");
  for (const StatePoint& state : method_states()) {
    for (const Method& method : methods()) {
      if (method.neighbours != ed::Neighbours::dilated) continue;
      const auto rate = [&](ed::Neighbours neighbours) {
        return rates.rate(method_name(state, {method.finder, neighbours, method.distance}));
      };
      const double dilated = rate(ed::Neighbours::dilated);
      const double obp = rate(ed::Neighbours::obp);
      const double cells = rate(ed::Neighbours::cells);
      if (std::isnan(dilated + obp + cells)) continue;
      std::string name = method.name();
      name.erase(name.find("/dilated"), 8);
      std::printf("%-18s %-22s %10.0f %10.0f %10.0f | %13.2f %11.2f\n", state.name().c_str(), name.c_str(), dilated,
                  obp, cells, dilated / obp, obp / cells);
    }
    const double paper = rates.rate(method_name(state, kPaper));
    const double ours = rates.rate(method_name(state, Method{}));
    if (!std::isnan(paper + ours)) {
      std::printf("%-18s default path %.0f, the paper's %.0f: %.1f times\n", state.name().c_str(), ours, paper,
                  ours / paper);
    }
  }
}

void print_scale(const KeepRates& rates) {
  const double smallest = rates.rate(scale_name(kScaleNumbers[0]));
  if (std::isnan(smallest)) return;
  std::printf("\n%10s %14s %10s\n", "bodies", "collisions/s", "ratio");
  for (const int number : kScaleNumbers) {
    const double rate = rates.rate(scale_name(number));
    if (!std::isnan(rate)) std::printf("%10d %14.0f %10.2f\n", number, rate, rate / smallest);
  }
}

void print_vectors(const KeepRates& rates) {
  std::printf("\ncollisions/s, pairs looked at one by one and in vectors; ratio to one by one\n%-18s", "");
  for (const Method& method : vector_methods()) {
    std::printf("%18s", method.batches ? geom::to_string(*method.batches) : "one by one");
  }
  std::printf("\n");
  for (const StatePoint& state : vector_states()) {
    const double one_by_one = rates.rate(vector_name(state, vector_methods()[0]));
    if (std::isnan(one_by_one)) continue;
    std::printf("%-18s", state.name().c_str());
    for (const Method& method : vector_methods()) {
      const double rate = rates.rate(vector_name(state, method));
      std::printf("%12.0f %5.2f", rate, rate / one_by_one);
    }
    std::printf("\n");
  }
}

void print_dilute(const KeepRates& rates) {
  std::printf("\ncells / dilated\n%-18s %12s %12s | %12s\n", "", "certified", "bracketing", "in 27 cells");
  for (const StatePoint& state : dilute_states()) {
    const auto rate = [&](std::size_t k) { return rates.rate(dilute_name(state, kDilute[k])); };
    const double certified = rate(1) / rate(0);
    const double bracketing = rate(3) / rate(2);
    if (std::isnan(certified) && std::isnan(bracketing)) continue;
    const ed::System& system = start(state);
    const double cells = std::floor(system.box / (2 * ed::bounding_radius(system.species[0].shape)));
    std::printf("%-18s %12.2f %12.2f | %12.1f\n", state.name().c_str(), certified, bracketing,
                27 * kNumber / (cells * cells * cells));
  }
}

}  // namespace

int main(int argc, char** argv) {
  benchmark::AddCustomContext("march", HARDBODY_ARCH_NAME);
  benchmark::AddCustomContext("number", std::to_string(kNumber));
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  const auto add_engine = [](const StatePoint& state) { add("engine/" + state.name(), state, Method{}); };
  add_engine({3, 0.40});
  for (const double X0 : {1.0 / 3, 0.5, 1.0, 2.0, 3.0, 5.0}) {
    for (const double packing_fraction : {0.30, 0.40}) {
      if (X0 != 3 || packing_fraction != 0.40) add_engine({X0, packing_fraction});
    }
  }
  // Long rods and flat discs.
  add_engine({10, 0.25});
  add_engine({0.1, 0.25});
  // State points that other codes were measured at, and what spin costs.
  add_engine({2, 0.45});
  add_engine({1.25, 0.50});
  add_engine({3, 0.40, true});
  add_engine({0.5, 0.40, true});
  for (const StatePoint& state : method_states()) {
    for (const Method& method : methods()) add(method_name(state, method), state, method);
  }
  for (const StatePoint& state : dilute_states()) {
    for (const Method& method : kDilute) add(dilute_name(state, method), state, method, 2);
  }
  for (const auto& [state, neighbours] : kHardStates) {
    for (const auto distance : {ed::DistanceMethod::newton8, ed::DistanceMethod::newton5}) {
      const Method method{ed::Finder::bracketing, neighbours, distance};
      add("rescues/" + state.name() + "/" + method.name(), state, method, 1);
    }
  }
  for (const int number : kScaleNumbers) {
    benchmark::RegisterBenchmark(scale_name(number).c_str(), [=](benchmark::State& timing) { scale(timing, number); })
        ->Unit(benchmark::kMillisecond)
        ->Iterations(kStretches);
  }
  for (const StatePoint& state : vector_states()) {
    for (const Method& method : vector_methods()) add(vector_name(state, method), state, method);
  }
  KeepRates rates;
  benchmark::RunSpecifiedBenchmarks(&rates);
  benchmark::Shutdown();
  print_methods(rates);
  print_dilute(rates);
  print_vectors(rates);
  print_scale(rates);
}
