/// Time of one distance query of two superellipsoids: set of orientations x exponent x start (cold, warm), and FCL's
/// own GJK fed with the same support function. Overlaps: set x depth x what is asked (Penetration).
///
/// Every benchmark walks through kPairs pairs of known distance, log-uniform between 1e-6 and 1 in units of a
/// semi-axis, or of a known way out, its length in units of the pair's size. A failure is an answer that is declined or
/// wrong by more than the contract of geom/distance.h allows (1e-12 of the size), of overlaps one that is longer than
/// the known way; it is counted, not hidden. The tables at the end give ratios within this run.
///
/// seed/..., newton8/..., newton5/...: superellipsoid_seeds.h.

#include "superellipsoid_seeds.h"

#include "common/geom/manufactured.h"
#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <geom/geom.h>
#ifdef HARDBODY_WITH_SEEDS
#include "common/forked.h"
#include "oracle/fcl_raw.h"
#endif

#include <benchmark/benchmark.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdio>
#include <limits>
#include <map>
#include <string>
#include <tuple>
#include <utility>
#include <vector>

namespace {

using Eigen::Vector3d;
using geom::DistanceResult;
using geom::Pose;
using geom::Superellipsoid;
using geom_test::PairSet;
using geom_test::Random;

constexpr int kPairs = 1000;
constexpr double kWarmAngle = 0.01;  // radian; how far a normal turns between two queries of a pair in motion
constexpr double kTolerance = 1e-12;

struct NamedSet {
  PairSet set;
  const char* name;
};

constexpr std::array<NamedSet, 5> kSets{{{PairSet::random_normal, "random_normal"},
                                         {PairSet::random_point, "random_point"},
                                         {PairSet::aligned, "aligned"},
                                         {PairSet::edges, "edges"},
                                         {PairSet::faces, "faces"}}};

/// Both exponents; kMixed: one of each kind, drawn from kExponents for each pair.
constexpr double kMixed = 0;
constexpr std::array kRows{0.2, 0.3, 0.5, 0.7, 1.3, 1.6, kMixed};
/// Depths of overlaps, whose exponents are mixed.
constexpr std::array kDepths{1e-6, 1e-3, 0.1};

struct Query {
  Superellipsoid shape;  ///< shape of both bodies
  Pose X_WA;
  Pose X_WB;
  double distance;  ///< gap as rounding has left it
  double size;
  Vector3d start;  ///< the normal, turned by kWarmAngle
};

double pick_exponent(double row, Random& random) {
  if (row != kMixed) return row;
  return geom_test::kExponents[static_cast<std::size_t>(random.uniform() * geom_test::kExponents.size())];
}

/// `depth`, in units of the size that the pair has where it touches; 0: apart.
const std::vector<Query>& queries(PairSet set, double row, double depth = 0) {
  static std::map<std::tuple<PairSet, double, double>, std::vector<Query>> cache;
  std::vector<Query>& out = cache[{set, row, depth}];
  Random random(1);
  while (out.size() < kPairs) {
    const double e1 = pick_exponent(row, random);
    const double e2 = pick_exponent(row, random);
    const Vector3d axes(1, random.uniform(0.6, 1.6), random.uniform(0.4, 2.4));
    Query q{Superellipsoid(axes, e1, e2), {}, {}, 0, 0, {}};
    const geom_test::Orientation o = geom_test::choose(set, q.shape, random);
    const double gap = random.log_uniform(1e-6, 1);
    geom_test::place(o, q.shape, 0, q.X_WA, q.X_WB);
    const double touching_size = q.X_WB.position().norm() + 2 * q.shape.bounding_radius();
    geom_test::place(o, q.shape, depth > 0 ? -depth * touching_size : gap, q.X_WA, q.X_WB);
    q.distance = geom_test::lower_bound(q.shape, q.X_WA, q.shape, q.X_WB, o.n);
    q.size = q.X_WB.position().norm() + 2 * q.shape.bounding_radius();
    q.start = Eigen::AngleAxisd(kWarmAngle, o.n.cross(random.direction()).normalized()) * o.n;
    out.push_back(q);
  }
  return out;
}

std::string benchmark_name(const char* method, const char* set, double row) {
  char name[80];
  if (row == kMixed) {
    std::snprintf(name, sizeof name, "superellipsoid/%s/%s/e:mixed", method, set);
  } else {
    std::snprintf(name, sizeof name, "superellipsoid/%s/%s/e:%g", method, set, row);
  }
  return name;
}

DistanceResult ask(const Query& q, bool warm) {
  return warm ? geom::distance(q.shape, q.X_WA, q.shape, q.X_WB, {.start = q.start})
              : geom::distance(q.shape, q.X_WA, q.shape, q.X_WB);
}

void ours(benchmark::State& state, PairSet set, double row, bool warm) {
  const std::vector<Query>& all = queries(set, row);
  for (auto _ : state) {
    for (const Query& q : all) benchmark::DoNotOptimize(ask(q, warm).distance);
  }
  int iterations = 0;
  int failures = 0;
  for (const Query& q : all) {
    const DistanceResult r = ask(q, warm);
    iterations += r.iterations;
    failures += !(std::abs(r.distance - q.distance) <= kTolerance * q.size);
  }
  state.counters["iterations"] = static_cast<double>(iterations) / kPairs;
  state.counters["failures"] = failures;
}

DistanceResult ask_depth(const Query& q, geom::Penetration penetration) {
  return geom::distance(q.shape, q.X_WA, q.shape, q.X_WB, {.penetration = penetration});
}

/// `longer`: answers that are longer than the known way out, of local ones no failure. Pushed past an edge, a few
/// bodies are apart: that is an answer too.
void overlaps(benchmark::State& state, PairSet set, double depth, geom::Penetration penetration) {
  const std::vector<Query>& all = queries(set, kMixed, depth);
  for (auto _ : state) {
    for (const Query& q : all) benchmark::DoNotOptimize(ask_depth(q, penetration).distance);
  }
  int iterations = 0;
  int declined = 0;
  int longer = 0;
  for (const Query& q : all) {
    const DistanceResult r = ask_depth(q, penetration);
    iterations += r.iterations;
    declined += std::isnan(r.distance);
    longer += r.distance < q.distance - kTolerance * q.size;
  }
  state.counters["iterations"] = static_cast<double>(iterations) / kPairs;
  state.counters["failures"] = declined + (penetration == geom::Penetration::global ? longer : 0);
  state.counters["longer"] = longer;
}

std::string overlap_name(const char* what, const char* set, double depth) {
  char name[80];
  std::snprintf(name, sizeof name, "superellipsoid/overlap_%s/%s/depth:%g", what, set, depth);
  return name;
}

#ifdef HARDBODY_WITH_SEEDS
/// A body as FCL's GJK sees it.
struct Fed {
  const Superellipsoid* shape;
  const Pose* X_W;
};

Vector3d fed_support(const void* body, const Vector3d& direction) {
  const auto& fed = *static_cast<const Fed*>(body);
  const Eigen::Matrix3d& R = fed.X_W->rotation();
  return fed.X_W->position() + R * geom::Support(fed.shape->support(R.transpose() * direction)).point;
}

double ask_fcl(const Query& q) {
  const Fed a{&q.shape, &q.X_WA};
  const Fed b{&q.shape, &q.X_WB};
  return geom_test::fcl_gjk_distance(&a, &b, fed_support);
}

/// Returns the answers of FCL's GJK, which runs in a process of its own: NaN where it ends that.
std::array<double, kPairs> fcl_answers(const std::vector<Query>& all) {
  std::array<double, kPairs> answers;
  answers.fill(std::numeric_limits<double>::quiet_NaN());
  geom_test::run_forked(kPairs, answers, [&](int i, std::array<double, kPairs>& out) {
    const auto k = static_cast<std::size_t>(i);
    out[k] = ask_fcl(all[k]);
  });
  return answers;
}

void fcl(benchmark::State& state, PairSet set, double row) {
  const std::vector<Query>& all = queries(set, row);
  const std::array<double, kPairs> known = fcl_answers(all);
  for (auto _ : state) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (!std::isnan(known[k])) benchmark::DoNotOptimize(ask_fcl(all[k]));
    }
  }
  int failures = 0;
  int asked = 0;
  double worst = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    asked += !std::isnan(known[k]);
    if (std::isnan(known[k]) || known[k] < 0) {
      ++failures;  // aborted, or takes the bodies for overlapping
    } else {
      worst = std::max(worst, std::abs(known[k] - all[k].distance) / all[k].size);
    }
  }
  state.counters["failures"] = failures;
  state.counters["asked"] = asked;
  state.counters["largest_error"] = worst;
}
#endif

void register_benchmarks() {
  for (const NamedSet& set : kSets) {
    for (const double row : kRows) {
      const auto add = [&](const char* method, auto run) {
        benchmark::RegisterBenchmark(benchmark_name(method, set.name, row).c_str(), run)->Unit(benchmark::kMicrosecond);
      };
      add("cold", [=](benchmark::State& s) { ours(s, set.set, row, /*warm=*/false); });
      add("warm", [=](benchmark::State& s) { ours(s, set.set, row, /*warm=*/true); });
#ifdef HARDBODY_WITH_SEEDS
      add("fcl_gjk", [=](benchmark::State& s) { fcl(s, set.set, row); });
#endif
    }
    for (const double depth : kDepths) {
      const auto add = [&](const char* what, geom::Penetration penetration) {
        benchmark::RegisterBenchmark(overlap_name(what, set.name, depth).c_str(), [=](benchmark::State& s) {
          overlaps(s, set.set, depth, penetration);
        })->Unit(benchmark::kMicrosecond);
      };
      add("global", geom::Penetration::global);
      add("local", geom::Penetration::local);
    }
  }
}

/// Prints as usual and keeps the microseconds of each query and the counters.
class KeepRuns : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      // Of repetitions the median is kept, else the only run.
      const bool wanted = run.repetitions == 1 || run.aggregate_name == "median";
      if (wanted && !run.error_occurred) runs_.insert_or_assign(run.run_name.function_name, run);
    }
    benchmark::ConsoleReporter::ReportRuns(runs);
  }

  /// NaN if the filter left that benchmark out.
  double microseconds(const std::string& name) const {
    const auto found = runs_.find(name);
    return found == runs_.end() ? std::nan("") : found->second.GetAdjustedCPUTime() / kPairs;
  }
  double counter(const std::string& name, const char* counter) const {
    const auto found = runs_.find(name);
    return found == runs_.end() ? std::nan("") : found->second.counters.at(counter).value;
  }

 private:
  std::map<std::string, Run> runs_;
};

void print_ratios(const KeepRuns& runs) {
  bool headed = false;
  for (const NamedSet& set : kSets) {
    for (const double row : kRows) {
      const std::string cold = benchmark_name("cold", set.name, row);
      const std::string warm = benchmark_name("warm", set.name, row);
      const std::string fcl = benchmark_name("fcl_gjk", set.name, row);
      const double us = runs.microseconds(cold);
      if (std::isnan(us)) continue;
      if (!std::exchange(headed, true)) {
        std::printf("\n%-14s %-6s | %26s %9s | %26s | %s\n", "us per query", "", "cold: us, evaluations,", "warm: us",
                    "FCL's GJK: us, worst, none", "FCL/cold");
      }
      std::printf("%-14s %-6s | %9.2f %6.1f %4g failed %9.2f", set.name, cold.substr(cold.find("e:", 20) + 2).c_str(),
                  us, runs.counter(cold, "iterations"), runs.counter(cold, "failures"), runs.microseconds(warm));
      if (std::isnan(runs.microseconds(fcl))) {
        std::printf("\n");
        continue;
      }
      // Pairs that end the process are not timed.
      const double fcl_us = runs.microseconds(fcl) * kPairs / runs.counter(fcl, "asked");
      std::printf(" | %9.2f %9.1e %6g | %8.1f\n", fcl_us, runs.counter(fcl, "largest_error"),
                  runs.counter(fcl, "failures"), fcl_us / us);
    }
  }
}

void print_overlaps(const KeepRuns& runs) {
  bool headed = false;
  for (const NamedSet& set : kSets) {
    for (const double depth : kDepths) {
      const std::string global = overlap_name("global", set.name, depth);
      const std::string local = overlap_name("local", set.name, depth);
      if (std::isnan(runs.microseconds(global)) || std::isnan(runs.microseconds(local))) continue;
      if (!std::exchange(headed, true)) {
        std::printf("\n%-14s %-6s | %33s | %s\n", "us per overlap", "depth", "global: us, evaluations, failed",
                    "local: us, evaluations, failed, longer than known");
      }
      std::printf("%-14s %-6g | %13.1f %13.1f %5g | %9.2f %7.1f %5g %5g\n", set.name, depth, runs.microseconds(global),
                  runs.counter(global, "iterations"), runs.counter(global, "failures"), runs.microseconds(local),
                  runs.counter(local, "iterations"), runs.counter(local, "failures"), runs.counter(local, "longer"));
    }
  }
}

}  // namespace

int main(int argc, char** argv) {
  register_benchmarks();
  bench::register_seed_benchmarks();
  benchmark::Initialize(&argc, argv);
  if (benchmark::ReportUnrecognizedArguments(argc, argv)) return 1;
  KeepRuns runs;
  benchmark::RunSpecifiedBenchmarks(&runs);
  benchmark::Shutdown();
  print_ratios(runs);
  print_overlaps(runs);
}
