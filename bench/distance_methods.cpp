#include "distance_methods.h"

#include "seeds_of.h"

#include "common/forked.h"
#include "common/geom/manufactured.h"

#include <geom/geom.h>
#ifdef HARDBODY_WITH_SEEDS
#include "oracle/fcl_raw.h"
#endif

#include <benchmark/benchmark.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <cmath>
#include <cstdio>
#include <functional>
#include <limits>
#include <map>
#include <memory>
#include <string>
#include <unordered_map>
#include <vector>

namespace bench {
namespace {

using geom::DistanceResult;
using geom::DistanceStatus;
using geom::Ellipsoid;
using geom::NewtonSystem;
using geom::Pose;
using geom::SeedStatus;
using geom::WitnessPair;

constexpr std::array kAspectRatios{0.1, 0.2, 0.5, 1.0, 2.0, 5.0, 10.0};
// In units of the two equal semi-axes; the overlap is certified for every X0.
constexpr std::array kGaps{1.0, 1e-1, 1e-6, -1e-3};

constexpr double kDeclined = std::numeric_limits<double>::quiet_NaN();

struct Query {
  Ellipsoid shape;  ///< shape of both bodies
  geom_test::ManufacturedPair pair;
};

/// A distance, or kDeclined. May end the process if the method says so.
using Ask = std::function<double(const Query&)>;
using Seed = std::function<WitnessPair(const Query&)>;

struct Method {
  std::string name;
  Ask ask;
  bool may_abort = false;
};

/// Spheroids of every X0, and as many ellipsoids with three different axes.
const std::vector<Query>& queries(double gap) {
  static std::map<double, std::vector<Query>> cache;
  std::vector<Query>& out = cache[gap];
  geom_test::Random random(20240601);
  for (std::size_t i = out.size(); i < kMethodPairs; ++i) {
    const double x0 = kAspectRatios[i % kAspectRatios.size()];
    const Ellipsoid shape = i % 2 == 0 ? Ellipsoid({1, 1, x0}) : Ellipsoid({0.8, 1.25, x0});
    out.push_back({shape, geom_test::manufacture(shape, shape, gap, random)});
  }
  return out;
}

/// The distance of a seed's points: what the library that made them would answer.
double claim(const WitnessPair& seed, const Query& q) {
  const double d = (seed.point_b - seed.point_a).norm();
  return seed.status == SeedStatus::usable ? std::copysign(d, q.pair.distance) : kDeclined;
}

/// Newton's method alone: the seeds are made once, before the time is taken.
Ask newton_from(NewtonSystem system, const Seed& seed_of) {
  const auto seeds = std::make_shared<std::unordered_map<const Query*, WitnessPair>>();
  return [=](const Query& q) {
    auto found = seeds->find(&q);
    if (found == seeds->end()) found = seeds->emplace(&q, seed_of(q)).first;
    return geom::newton_distance(q.shape, q.pair.X_WA, q.shape, q.pair.X_WB, system, found->second).distance;
  };
}

#ifdef HARDBODY_WITH_SEEDS
/// Unsigned where the bodies are apart, which is what FCL is fastest at.
double ask_fcl(const Query& q) {
  const bool signed_distance = q.pair.distance < 0;
  const geom_test::FclDistance r = geom_test::fcl_distance(q.shape, q.pair.X_WA, q.shape, q.pair.X_WB, signed_distance);
  const bool answered = r.outcome == geom_test::FclDistance::Outcome::answered;
  return answered && (signed_distance || r.distance >= 0) ? r.distance : kDeclined;
}
#endif

std::vector<Method> make_methods() {
  std::vector<Method> methods;
  methods.push_back(
      {"dual", [](const Query& q) { return geom::distance(q.shape, q.pair.X_WA, q.shape, q.pair.X_WB).distance; }});
#ifdef HARDBODY_WITH_SEEDS
  methods.push_back({"FCL alone", ask_fcl, /*may_abort=*/true});
#endif
  std::map<std::string, Seed> seeds;
  for (const auto& [name, seed] : seeds_of<Ellipsoid>()) {
    seeds[name] = [seed = seed](const Query& q) { return seed(q.shape, q.pair.X_WA, q.shape, q.pair.X_WB); };
  }
  for (const auto& [name, seed] : seeds) {
    if (name != "dual")
      methods.push_back({name + " seed", [seed = seed](const Query& q) { return claim(seed(q), q); }});
  }
  for (const auto& [name, seed] : seeds) {
    methods.push_back({"newton8 from " + name, newton_from(NewtonSystem::eight, seed)});
    methods.push_back({"newton5 from " + name, newton_from(NewtonSystem::five, seed)});
  }
  return methods;
}

const std::vector<Method>& methods() {
  static const std::vector<Method> all = make_methods();
  return all;
}

std::string benchmark_name(const Method& method, double gap) {
  char name[80];
  std::snprintf(name, sizeof name, "method/%s/gap:%g", method.name.c_str(), gap);
  return name;
}

/// Each pair's answer by one method, and whether it lived to give it.
struct Answers {
  std::array<double, kMethodPairs> distance;
  std::array<bool, kMethodPairs> alive;
  int aborts;
};

const Answers& answers(const Method& method, double gap) {
  static std::map<std::string, std::unique_ptr<Answers>> cache;
  std::unique_ptr<Answers>& out = cache[benchmark_name(method, gap)];
  if (out) return *out;
  out = std::make_unique<Answers>();
  const std::vector<Query>& all = queries(gap);
  const auto ask = [&](int i, Answers& to) {
    const auto k = static_cast<std::size_t>(i);
    to.distance[k] = method.ask(all[k]);
    to.alive[k] = true;
  };
  if (method.may_abort) {
    out->aborts = geom_test::run_forked(kMethodPairs, *out, ask);
  } else {
    for (int i = 0; i < kMethodPairs; ++i) ask(i, *out);
  }
  return *out;
}

void method_benchmark(benchmark::State& state, const Method& method, double gap) {
  const std::vector<Query>& all = queries(gap);
  const Answers& known = answers(method, gap);  // first, for it makes the seeds and finds the pairs that abort
  for (auto _ : state) {
    for (std::size_t k = 0; k < all.size(); ++k) {
      if (known.alive[k]) benchmark::DoNotOptimize(method.ask(all[k]));
    }
  }
}

void print_row(const Method& method, double gap, double ns) {
  const std::vector<Query>& all = queries(gap);
  const Answers& a = answers(method, gap);
  std::vector<double> errors;
  for (std::size_t k = 0; k < all.size(); ++k) {
    if (a.alive[k] && !std::isnan(a.distance[k])) {
      errors.push_back(std::abs(a.distance[k] - gap) / all[k].pair.size);
    }
  }
  std::sort(errors.begin(), errors.end());
  const int declined = kMethodPairs - a.aborts - static_cast<int>(errors.size());
  // Pairs that end the process are not timed.
  const double ns_alive = ns * kMethodPairs / std::max(1, kMethodPairs - a.aborts);
  std::printf("%-8g %-20s %11.1f  ", gap, method.name.c_str(), ns_alive);
  if (errors.empty()) {
    std::printf("%9s %9s", "-", "-");
  } else {
    std::printf("%9.1e %9.1e", errors[errors.size() / 2], errors.back());
  }
  std::printf(" %9d %7d\n", declined, a.aborts);
}

#ifdef HARDBODY_WITH_SEEDS
/// The pairs of one gap that FCL lives to answer, as each of three takes them: everything is made before the time is
/// taken.
struct SamePairs {
  std::vector<Ellipsoid> shapes;
  std::vector<Pose> X_WA, X_WB;
  std::vector<geom_test::FclPair> of_fcl;
  std::vector<DistanceResult> results;
};

SamePairs same_pairs(double gap) {
  const Method fcl{"FCL alone", ask_fcl, /*may_abort=*/true};
  const Answers& known = answers(fcl, gap);
  SamePairs same;
  for (std::size_t k = 0; k < kMethodPairs; ++k) {
    if (!known.alive[k]) continue;
    const Query& q = queries(gap)[k];
    same.shapes.push_back(q.shape);
    same.X_WA.push_back(q.pair.X_WA);
    same.X_WB.push_back(q.pair.X_WB);
    same.of_fcl.emplace_back(q.shape, q.pair.X_WA, q.shape, q.pair.X_WB);
  }
  same.results.resize(same.shapes.size());
  return same;
}

/// Nanoseconds a pair of the shortest of several passes, which other work on the machine has disturbed least.
template <class Pass>
double shortest_pass(std::size_t pairs, const Pass& pass) {
  double least = std::numeric_limits<double>::infinity();
  for (int k = 0; k < 7; ++k) {
    const auto before = std::chrono::steady_clock::now();
    pass();
    const std::chrono::duration<double, std::nano> taken = std::chrono::steady_clock::now() - before;
    least = std::min(least, taken.count() / static_cast<double>(pairs));
  }
  return least;
}

/// One after the other on the same pairs: FCL, distance() and distance_batch(). Timed by itself is the batch.
void same_pairs_benchmark(benchmark::State& state, double gap) {
  SamePairs same = same_pairs(gap);
  const std::size_t pairs = same.shapes.size();
  const auto batch = [&] {
    geom::distance_batch(same.shapes, same.X_WA, same.shapes, same.X_WB, same.results);
    benchmark::DoNotOptimize(same.results.data());
  };
  const double fcl = shortest_pass(pairs, [&] {
    for (const geom_test::FclPair& pair : same.of_fcl) benchmark::DoNotOptimize(pair.distance(gap < 0).distance);
  });
  const double scalar = shortest_pass(pairs, [&] {
    for (std::size_t k = 0; k < pairs; ++k) {
      benchmark::DoNotOptimize(geom::distance(same.shapes[k], same.X_WA[k], same.shapes[k], same.X_WB[k]).distance);
    }
  });
  const double batched = shortest_pass(pairs, batch);
  for (auto _ : state) batch();
  state.counters["pairs"] = static_cast<double>(pairs);
  state.counters["fcl_ns"] = fcl;
  state.counters["scalar_ns"] = scalar;
  state.counters["batch_ns"] = batched;
  state.counters["fcl/scalar"] = fcl / scalar;
  state.counters["fcl/batch"] = fcl / batched;
}
#endif

}  // namespace

void register_method_benchmarks() {
#ifdef HARDBODY_WITH_SEEDS
  for (const double gap : kGaps) {
    char name[80];
    std::snprintf(name, sizeof name, "same_pairs/gap:%g", gap);
    benchmark::RegisterBenchmark(name, same_pairs_benchmark, gap)->Unit(benchmark::kMicrosecond);
  }
#endif
  for (const double gap : kGaps) {
    for (const Method& method : methods()) {
      benchmark::RegisterBenchmark(benchmark_name(method, gap).c_str(), method_benchmark, method, gap)
          ->Unit(benchmark::kMicrosecond);
    }
  }
}

void print_method_table(const std::map<std::string, double>& ns) {
  std::printf(
      "\n%d pairs a row. Error: of the distance (a seed's: between its points) over the size of the pair.\n"
      "Newton's time is without its seed's. FCL alone: unsigned where the bodies are apart.\n",
      kMethodPairs);
  std::printf("%-8s %-20s %11s  %9s %9s %9s %7s\n", "gap", "method", "ns", "median", "largest", "declined", "aborts");
  for (const double gap : kGaps) {
    for (const Method& method : methods()) {
      const auto found = ns.find(benchmark_name(method, gap));
      if (found != ns.end()) print_row(method, gap, found->second);
    }
  }
}

}  // namespace bench
