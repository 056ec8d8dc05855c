/// Time of one distance query of two ellipsoids: kernel (uniaxial, general) x start (cold, warm) x X0 x gap.
///
/// Every benchmark walks through kPairs pairs of equal bodies whose distance is known, in random relative orientation;
/// they fit in the second-level cache, so that the kernel is timed and not the memory. A failure is an answer that is
/// declined or wrong by more than 1e-13 of the pair's size; it is counted, not hidden. Times of two machines differ
/// more than those of two kernels: the table at the end gives ratios within this run.
///
/// Behind it, distance_methods.h: the paper's method from each seed and other libraries, in a table of their own.

#include "distance_methods.h"

#include <geom/geom.h>

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>

#include <array>
#include <cmath>
#include <cstdint>
#include <cstdio>
#include <map>
#include <numbers>
#include <random>
#include <string>
#include <vector>

namespace {

constexpr int kPairs = bench::kMethodPairs;
constexpr std::uint64_t kSeed = 20240601;
constexpr double kWarmAngle = 0.01;  // radian; how far a normal turns between two queries of a pair in motion

constexpr std::array kAspectRatios{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};
// In units of the two equal semi-axes. The overlap is certified for every X0: the sum of both smallest radii of
// curvature is at least 0.02.
constexpr std::array kGaps{1.0, 1e-1, 1e-6, -1e-3};

enum class Kernel { uniaxial, general };
enum class Start { cold, warm };

geom::Ellipsoid make_shape(Kernel kernel, double aspect_ratio) {
  if (kernel == Kernel::uniaxial) return geom::Ellipsoid({1, 1, aspect_ratio});
  return geom::Ellipsoid({0.8, 1.25, aspect_ratio});  // the same volume, no two axes equal
}

struct Query {
  geom::Pose X_WA;
  geom::Pose X_WB;
  Eigen::Vector3d start;  // the normal, turned by kWarmAngle
};

Eigen::Vector3d random_direction(std::mt19937_64& engine) {
  std::normal_distribution<double> normal;
  return Eigen::Vector3d(normal(engine), normal(engine), normal(engine)).normalized();
}

geom::Pose random_rotation(std::mt19937_64& engine, const Eigen::Vector3d& position) {
  std::normal_distribution<double> normal;
  const Eigen::Quaterniond q(normal(engine), normal(engine), normal(engine), normal(engine));
  return {q.normalized().toRotationMatrix(), position};
}

/// B placed so that the support points in a random direction are `gap` apart along it: the distance is exactly that.
std::vector<Query> make_queries(const geom::Ellipsoid& shape, double gap) {
  std::mt19937_64 engine(kSeed);
  std::vector<Query> queries;
  queries.reserve(kPairs);
  for (int i = 0; i < kPairs; ++i) {
    const Eigen::Vector3d n = random_direction(engine);
    const geom::Pose X_WA = random_rotation(engine, Eigen::Vector3d::Zero());
    const geom::Pose X_turned = random_rotation(engine, Eigen::Vector3d::Zero());
    const Eigen::Vector3d s_a = X_WA.rotation() * shape.support(X_WA.rotation().transpose() * n).point;
    const Eigen::Vector3d s_b = X_turned.rotation() * shape.support(X_turned.rotation().transpose() * -n).point;
    const Eigen::Vector3d axis = n.cross(random_direction(engine)).normalized();
    const Eigen::Vector3d start = Eigen::AngleAxisd(kWarmAngle, axis) * n;
    queries.push_back({X_WA, geom::Pose(X_turned.rotation(), s_a - s_b + gap * n), start});
  }
  return queries;
}

void distance_benchmark(benchmark::State& state, Kernel kernel, Start start, double aspect_ratio, double gap) {
  const geom::Ellipsoid shape = make_shape(kernel, aspect_ratio);
  const std::vector<Query> queries = make_queries(shape, gap);
  const auto ask = [&](const Query& q) {
    return start == Start::cold ? geom::distance(shape, q.X_WA, shape, q.X_WB)
                                : geom::distance(shape, q.X_WA, shape, q.X_WB, {.start = q.start});
  };
  for (auto _ : state) {
    for (const Query& q : queries) benchmark::DoNotOptimize(ask(q).distance);
  }
  int iterations = 0;
  int failures = 0;
  for (const Query& q : queries) {
    const geom::DistanceResult r = ask(q);
    const double size = q.X_WB.position().norm() + 2 * shape.bounding_radius();
    iterations += r.iterations;
    failures += !(std::abs(r.distance - gap) <= 1e-13 * size);  // NaN, a declined answer, is a failure too
  }
  state.SetItemsProcessed(state.iterations() * kPairs);
  state.counters["query"] =
      benchmark::Counter(kPairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["iterations"] = static_cast<double>(iterations) / kPairs;
  state.counters["failures"] = failures;
}

std::string benchmark_name(Kernel kernel, Start start, double aspect_ratio, double gap) {
  char name[80];
  std::snprintf(name, sizeof name, "distance/%s/%s/X0:%g/gap:%g", kernel == Kernel::uniaxial ? "uniaxial" : "general",
                start == Start::cold ? "cold" : "warm", aspect_ratio, gap);
  return name;
}

void register_benchmarks() {
  for (const Kernel kernel : {Kernel::uniaxial, Kernel::general}) {
    for (const Start start : {Start::cold, Start::warm}) {
      for (const double aspect_ratio : kAspectRatios) {
        for (const double gap : kGaps) {
          benchmark::RegisterBenchmark(benchmark_name(kernel, start, aspect_ratio, gap).c_str(), distance_benchmark,
                                       kernel, start, aspect_ratio, gap)
              ->Unit(benchmark::kMicrosecond);
        }
      }
    }
  }
}

/// Prints as usual and keeps the time of each query, in ns.
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

  /// Returns nanoseconds by the benchmark's name.
  const std::map<std::string, double>& ns() const { return ns_; }

  /// NaN if the filter left that benchmark out.
  double ns(Kernel kernel, Start start, double aspect_ratio, double gap) const {
    const auto found = ns_.find(benchmark_name(kernel, start, aspect_ratio, gap));
    return found == ns_.end() ? std::nan("") : found->second;
  }

 private:
  std::map<std::string, double> ns_;
};

/// ns per query of the four benchmarks of one X0 and gap, or their sums.
struct Times {
  double uniaxial_cold = 0;
  double uniaxial_warm = 0;
  double general_cold = 0;
  double general_warm = 0;

  Times& operator+=(const Times& t) {
    uniaxial_cold += t.uniaxial_cold;
    uniaxial_warm += t.uniaxial_warm;
    general_cold += t.general_cold;
    general_warm += t.general_warm;
    return *this;
  }
  Times operator/(double n) const { return {uniaxial_cold / n, uniaxial_warm / n, general_cold / n, general_warm / n}; }
};

void print_row(const std::string& name, const Times& t) {
  const double any = std::fmax(std::fmax(t.uniaxial_cold, t.uniaxial_warm), std::fmax(t.general_cold, t.general_warm));
  if (std::isnan(any)) return;  // the filter has left all of it out
  std::printf("%-20s | %7.1f %7.1f %7.2f | %7.1f %7.1f %7.2f | %7.2f %7.2f\n", name.c_str(), t.uniaxial_cold,
              t.uniaxial_warm, t.uniaxial_cold / t.uniaxial_warm, t.general_cold, t.general_warm,
              t.general_cold / t.general_warm, t.general_cold / t.uniaxial_cold, t.general_warm / t.uniaxial_warm);
}

void print_ratios(const KeepTimes& times) {
  std::printf("\n%-20s | %-23s | %-23s | %-15s\n", "ns per query", "uniaxial", "general", "general/uniaxial");
  std::printf("%-20s | %7s %7s %7s | %7s %7s %7s | %7s %7s\n", "", "cold", "warm", "ratio", "cold", "warm", "ratio",
              "cold", "warm");
  Times sum;
  for (const double aspect_ratio : kAspectRatios) {
    for (const double gap : kGaps) {
      const auto ns = [&](Kernel kernel, Start start) { return times.ns(kernel, start, aspect_ratio, gap); };
      const Times t{ns(Kernel::uniaxial, Start::cold), ns(Kernel::uniaxial, Start::warm),
                    ns(Kernel::general, Start::cold), ns(Kernel::general, Start::warm)};
      sum += t;
      char name[40];
      std::snprintf(name, sizeof name, "X0 %g gap %g", aspect_ratio, gap);
      print_row(name, t);
    }
  }
  print_row("mean", sum / static_cast<double>(kAspectRatios.size() * kGaps.size()));
}

}  // namespace

int main(int argc, char** argv) {
  register_benchmarks();
  bench::register_method_benchmarks();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  KeepTimes times;
  benchmark::RunSpecifiedBenchmarks(&times);
  benchmark::Shutdown();
  print_ratios(times);
  bench::print_method_table(times.ns());
}
