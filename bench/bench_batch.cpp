/// Time of a pair of ellipsoids in distance_batch, cold, for each instruction set of this processor, beside distance():
/// kind (uniaxial, general) x method x X0.
///
/// Every benchmark walks through kPairs pairs of equal bodies whose distance is known, in random relative orientation,
/// a quarter of them at each gap; they fit in the second-level cache. A failure is an answer that is declined or wrong
/// by more than 1e-13 of the pair's size; `redone` is the share of the pairs that the kernels left to distance(). Times
/// of two machines differ more than those of two kernels: the table at the end gives ratios within this run.

#include <geom/geom.h>

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <optional>
#include <random>
#include <string>
#include <vector>

namespace {

constexpr int kPairs = 1024;
constexpr std::uint64_t kSeed = 20240601;
constexpr std::array kAspectRatios{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};
// In units of the two equal semi-axes; the overlap is certified for every X0.
constexpr std::array kGaps{1.0, 1e-1, 1e-6, -1e-3};

enum class Kind { uniaxial, general };

/// An instruction set of distance_batch, or distance() itself.
using Method = std::optional<geom::InstructionSet>;

std::vector<Method> methods() {
  std::vector<Method> all{std::nullopt};
  for (const auto set : {geom::InstructionSet::portable, geom::InstructionSet::avx2, geom::InstructionSet::avx512}) {
    if (geom::is_available(set)) all.emplace_back(set);
  }
  return all;
}

const char* name_of(const Method& method) {
  return method ? to_string(*method) : "scalar";
}

geom::Ellipsoid make_shape(Kind kind, double aspect_ratio) {
  if (kind == Kind::uniaxial) return geom::Ellipsoid({1, 1, aspect_ratio});
  return geom::Ellipsoid({0.8, 1.25, aspect_ratio});  // the same volume, no two axes equal
}

struct Queries {
  std::vector<geom::Ellipsoid> shapes;  // one a pair: nothing is gained from their being equal
  std::vector<geom::Pose> X_WA;
  std::vector<geom::Pose> X_WB;
  std::vector<double> gaps;
};

Eigen::Vector3d random_direction(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
}

Eigen::Matrix3d random_rotation(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(engine), normal(engine), normal(engine), normal(engine));
  return q.normalized().toRotationMatrix();
}

/// B placed so that the support points in a random direction are `gap` apart along it: the distance is exactly that.
Queries make_queries(const geom::Ellipsoid& shape) {
  std::mt19937_64 engine(kSeed);
  Queries queries;
  for (int i = 0; i < kPairs; ++i) {
    const double gap = kGaps[static_cast<std::size_t>(i) % kGaps.size()];
    const Eigen::Vector3d n = random_direction(engine);
    const Eigen::Matrix3d R_a = random_rotation(engine);
    const Eigen::Matrix3d R_b = random_rotation(engine);
    const Eigen::Vector3d s_a = R_a * shape.support(R_a.transpose() * n).point;
    const Eigen::Vector3d s_b = R_b * shape.support(R_b.transpose() * -n).point;
    queries.shapes.push_back(shape);
    queries.X_WA.emplace_back(R_a, Eigen::Vector3d::Zero());
    queries.X_WB.emplace_back(R_b, s_a - s_b + gap * n);
    queries.gaps.push_back(gap);
  }
  return queries;
}

/// Answers all queries by the method; returns the number of pairs that a batch left to distance().
std::size_t answer(const Method& method, const Queries& q, std::vector<geom::DistanceResult>& results) {
  if (method) {
    return geom::distance_batch(q.shapes, q.X_WA, q.shapes, q.X_WB, results, {.instruction_set = *method}).redone;
  }
  for (std::size_t i = 0; i < results.size(); ++i) {
    results[i] = geom::distance(q.shapes[i], q.X_WA[i], q.shapes[i], q.X_WB[i]);
  }
  return 0;
}

void batch_benchmark(benchmark::State& state, Kind kind, const Method& method, double aspect_ratio) {
  const Queries queries = make_queries(make_shape(kind, aspect_ratio));
  std::vector<geom::DistanceResult> results(kPairs);
  std::size_t redone = 0;
  for (auto _ : state) {
    redone = answer(method, queries, results);
    benchmark::DoNotOptimize(results.data());
    benchmark::ClobberMemory();
  }
  int iterations = 0;
  int failures = 0;
  for (std::size_t i = 0; i < results.size(); ++i) {
    const double size = queries.X_WB[i].position().norm() + 2 * queries.shapes[i].bounding_radius();
    iterations += results[i].iterations;
    failures += !(std::abs(results[i].distance - queries.gaps[i]) <= 1e-13 * size);  // NaN is a failure too
  }
  state.SetItemsProcessed(state.iterations() * kPairs);
  state.counters["pair"] =
      benchmark::Counter(kPairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["iterations"] = static_cast<double>(iterations) / kPairs;
  state.counters["redone"] = static_cast<double>(redone) / kPairs;
  state.counters["failures"] = failures;
}

std::string benchmark_name(Kind kind, const Method& method, double aspect_ratio) {
  char name[80];
  std::snprintf(name, sizeof name, "batch/%s/%s/X0:%g", kind == Kind::uniaxial ? "uniaxial" : "general",
                name_of(method), aspect_ratio);
  return name;
}

void register_benchmarks() {
  for (const Kind kind : {Kind::uniaxial, Kind::general}) {
    for (const Method& method : methods()) {
      for (const double aspect_ratio : kAspectRatios) {
        benchmark::RegisterBenchmark(benchmark_name(kind, method, aspect_ratio).c_str(), batch_benchmark, kind, method,
                                     aspect_ratio)
            ->Unit(benchmark::kMicrosecond);
      }
    }
  }
}

/// Prints as usual and keeps the time of each pair, in ns.
class KeepTimes : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      // Of repetitions the median is kept, else the only run.
      const bool wanted = run.repetitions == 1 || run.aggregate_name == "median";
      if (wanted && !run.error_occurred) ns_[run.run_name.function_name] = 1e3 * run.GetAdjustedCPUTime() / kPairs;
    }
    benchmark::ConsoleReporter::ReportRuns(runs);
  }

  /// NaN if the filter left that benchmark out.
  double ns(Kind kind, const Method& method, double aspect_ratio) const {
    const auto found = ns_.find(benchmark_name(kind, method, aspect_ratio));
    return found == ns_.end() ? std::nan("") : found->second;
  }

 private:
  std::map<std::string, double> ns_;
};

/// ns per pair of one kind, and how many times faster than distance().
void print_table(const KeepTimes& times, Kind kind) {
  std::printf("\n%-24s", kind == Kind::uniaxial ? "ns per pair, uniaxial" : "ns per pair, general");
  for (const Method& method : methods()) std::printf(method ? " | %9s  ratio" : " | %7s", name_of(method));
  std::printf("\n");
  std::map<std::string, double> sums;
  const auto print_row = [&](const char* name, const auto& ns) {
    std::printf("%-24s", name);
    for (const Method& method : methods()) {
      if (method) {
        std::printf(" | %9.1f %6.2f", ns(method), ns(std::nullopt) / ns(method));
      } else {
        std::printf(" | %7.1f", ns(method));
      }
    }
    std::printf("\n");
  };
  for (const double aspect_ratio : kAspectRatios) {
    for (const Method& method : methods()) sums[name_of(method)] += times.ns(kind, method, aspect_ratio);
    char name[40];
    std::snprintf(name, sizeof name, "X0 %g", aspect_ratio);
    print_row(name, [&](const Method& method) { return times.ns(kind, method, aspect_ratio); });
  }
  print_row("mean", [&](const Method& method) { return sums[name_of(method)] / kAspectRatios.size(); });
}

}  // namespace

int main(int argc, char** argv) {
  register_benchmarks();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  KeepTimes times;
  benchmark::RunSpecifiedBenchmarks(&times);
  benchmark::Shutdown();
  print_table(times, Kind::uniaxial);
  print_table(times, Kind::general);
}
