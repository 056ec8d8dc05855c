/// Time of one contact prediction: certified (the search of the event loop, and the public function around it) against
/// conservative advancement of first order, t += d / (largest possible |dd/dt|) until d is below a floor, with the same
/// distance.
///
/// Pairs are near neighbours of an equilibrated dense fluid with fresh thermal velocities, searched over one time unit
/// (that in which a body moves about its own size) from a cold start; a third to two thirds of them meet. Times of two
/// machines differ more than those of two methods: the table at the end gives ratios within this run. They flatter the
/// advancement, which ends a floor away from the contact and cannot tell one from a near miss.

#include <common/finder/ensemble.h>
#include <common/finder/gap.h>
#include <common/finder/reference.h>

#include <ed/time_of_contact.h>

#include <benchmark/benchmark.h>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <string>
#include <vector>

namespace {

using finder_test::Fluid;
using finder_test::MovingPair;

constexpr int kPairs = 1000;
constexpr std::uint64_t kSeed = 20240602;
constexpr double kHorizon = 1;
constexpr double kFloor = 1e-6;  // of the pair's size

struct Case {
  double aspect_ratio;
  double packing_fraction;
  bool spins;
};

// The spin of a sphere makes no difference.
constexpr std::array<Case, 7> kCases{{{1.0 / 3, 0.40, false},
                                      {1.0 / 3, 0.40, true},
                                      {1, 0.45, false},
                                      {3, 0.40, false},
                                      {3, 0.40, true},
                                      {5, 0.35, false},
                                      {5, 0.35, true}}};

enum class Method { certified, public_function, advancement };

struct Work {
  Fluid fluid;
  std::vector<MovingPair> pairs;
};

Work make_work(const Case& c) {
  Work work{Fluid(c.aspect_ratio, c.spins, finder_test::near_neighbours(c.aspect_ratio, c.packing_fraction, 200, kSeed),
                  kSeed),
            {}};
  for (int k = 0; k < kPairs; ++k) work.pairs.push_back(work.fluid.thermal_pair());
  return work;
}

/// Results and cost of a batch of predictions.
struct Totals {
  long contacts = 0;
  long evaluations = 0;  ///< points in time that were looked at
};

Totals run_certified(const Work& work) {
  Totals totals;
  ed::internal::FinderCounters count;
  for (const MovingPair& pair : work.pairs) {
    const ed::internal::Finding f = finder_test::find_contact(work.fluid, pair, kHorizon, count);
    totals.contacts += f.outcome == ed::internal::Outcome::contact ? 1 : 0;
  }
  totals.evaluations = static_cast<long>(count.evaluations);
  return totals;
}

ed::Motion motion_of(const finder_test::BodyState& state, const finder_test::Moments& moments) {
  ed::Motion m;
  m.pose = geom::Pose(state.rotation, state.position);
  m.velocity = state.velocity;
  m.angular_velocity = state.omega();
  m.inertia = {moments.perpendicular, moments.perpendicular, moments.axial};
  return m;
}

Totals run_public(const Work& work) {
  Totals totals;
  const geom::Ellipsoid& shape = work.fluid.shape();
  for (const MovingPair& pair : work.pairs) {
    const ed::ContactResult r = ed::time_of_contact(shape, motion_of(pair.a, work.fluid.moments()), shape,
                                                    motion_of(pair.b, work.fluid.moments()), kHorizon);
    totals.contacts += r.status == ed::ContactStatus::hit ? 1 : 0;
    totals.evaluations += r.evaluations;
  }
  return totals;
}

Totals run_advancement(const Work& work) {
  Totals totals;
  const geom::Ellipsoid& shape = work.fluid.shape();
  for (const MovingPair& pair : work.pairs) {
    const finder_test::FreeMotion a(pair.a, work.fluid.moments());
    const finder_test::FreeMotion b(pair.b, work.fluid.moments());
    finder_test::BruteForce brute(shape, a, shape, b, kFloor);
    totals.contacts += brute.advance(kHorizon) < kHorizon ? 1 : 0;
    totals.evaluations += brute.evaluations();
  }
  return totals;
}

Totals run(Method method, const Work& work) {
  switch (method) {
    case Method::certified:
      return run_certified(work);
    case Method::public_function:
      return run_public(work);
    case Method::advancement:
      break;
  }
  return run_advancement(work);
}

void time_of_contact_benchmark(benchmark::State& state, Method method, const Case& c) {
  const Work work = make_work(c);
  Totals totals;
  for (auto _ : state) {
    totals = run(method, work);
    benchmark::DoNotOptimize(totals);
  }
  state.SetItemsProcessed(state.iterations() * kPairs);
  state.counters["prediction"] =
      benchmark::Counter(kPairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["evaluations"] = static_cast<double>(totals.evaluations) / kPairs;
  state.counters["contacts"] = static_cast<double>(totals.contacts) / kPairs;
}

std::string benchmark_name(Method method, const Case& c) {
  const std::array<const char*, 3> names{"certified", "public", "advancement"};
  char name[80];
  std::snprintf(name, sizeof name, "time_of_contact/%s/X0:%.3g/%s", names[static_cast<std::size_t>(method)],
                c.aspect_ratio, c.spins ? "spin" : "no-spin");
  return name;
}

constexpr std::array kMethods{Method::certified, Method::public_function, Method::advancement};

void register_benchmarks() {
  for (const Case& c : kCases) {
    for (const Method method : kMethods) {
      benchmark::RegisterBenchmark(benchmark_name(method, c).c_str(), time_of_contact_benchmark, method, c)
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

/// Prints as usual and keeps the time (ns) and the evaluations of each prediction.
class KeepResults : public benchmark::ConsoleReporter {
 public:
  struct Result {
    double ns = std::nan("");
    double evaluations = std::nan("");
  };

  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      // Of repetitions the median is kept, else the only run.
      const bool wanted = run.repetitions == 1 || run.aggregate_name == "median";
      if (!wanted || run.error_occurred) continue;
      results_[run.run_name.function_name] = {1e3 * run.GetAdjustedCPUTime() / kPairs,
                                              run.counters.at("evaluations").value};
    }
    benchmark::ConsoleReporter::ReportRuns(runs);
  }

  /// NaN if the filter left that benchmark out.
  Result result(Method method, const Case& c) const {
    const auto found = results_.find(benchmark_name(method, c));
    return found == results_.end() ? Result() : found->second;
  }

 private:
  std::map<std::string, Result> results_;
};

void print_ratios(const KeepResults& results) {
  std::printf("\n%6s %8s | %10s %6s | %10s %6s | %11s %6s | %19s %12s\n", "X0", "", "certified", "eval.", "public",
              "eval.", "advancement", "eval.", "advancement/certified", "evaluations");
  for (const Case& c : kCases) {
    const auto certified = results.result(Method::certified, c);
    const auto open = results.result(Method::public_function, c);
    const auto advancement = results.result(Method::advancement, c);
    std::printf("%6.3g %8s | %10.0f %6.2f | %10.0f %6.2f | %11.0f %6.1f | %21.1f %12.1f\n", c.aspect_ratio,
                c.spins ? "spin" : "no spin", certified.ns, certified.evaluations, open.ns, open.evaluations,
                advancement.ns, advancement.evaluations, advancement.ns / certified.ns,
                advancement.evaluations / certified.evaluations);
  }
  std::printf("ns per prediction; floor of the advancement %g of the pair's size\n", kFloor);
}

}  // namespace

int main(int argc, char** argv) {
  register_benchmarks();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  KeepResults results;
  benchmark::RunSpecifiedBenchmarks(&results);
  benchmark::Shutdown();
  print_ratios(results);
}
