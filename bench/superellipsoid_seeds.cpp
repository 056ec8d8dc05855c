#include "superellipsoid_seeds.h"

#include "seeds_of.h"

#include "common/geom/manufactured.h"
#include "common/geom/random.h"
#include "common/geom/superellipsoid_sets.h"

#include <geom/geom.h>

#include <benchmark/benchmark.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <functional>
#include <limits>
#include <memory>
#include <string>
#include <vector>

namespace bench {
namespace {

using geom::NewtonSystem;
using geom::SeedStatus;
using geom::Superellipsoid;
using geom::WitnessPair;

constexpr int kPairs = 200;
constexpr double kGap = 0.1;  // semi-axes are from 0.4 to 2.4

struct Query {
  Superellipsoid a, b;
  geom_test::ManufacturedPair pair;
};

/// A distance; NaN: declined.
using Ask = std::function<double(const Query&, std::size_t index)>;

const std::vector<Query>& queries() {
  static const std::vector<Query> all = [] {
    std::vector<Query> made;
    geom_test::Random random(1);
    const auto shape = [&] {
      const Eigen::Vector3d axes(1, random.uniform(0.6, 1.6), random.uniform(0.4, 2.4));
      const double e1 = geom_test::any_exponent(random);
      return Superellipsoid(axes, e1, geom_test::any_exponent(random));
    };
    while (made.size() < kPairs) {
      const Superellipsoid a = shape();
      const Superellipsoid b = shape();
      made.push_back({a, b, geom_test::manufacture(a, b, kGap, random)});
    }
    return made;
  }();
  return all;
}

void run(benchmark::State& state, const Ask& ask) {
  const std::vector<Query>& all = queries();
  int declined = 0;
  double worst = 0;
  for (std::size_t k = 0; k < all.size(); ++k) {
    const double d = ask(all[k], k);
    declined += std::isnan(d);
    if (!std::isnan(d)) worst = std::max(worst, std::abs(d - kGap) / all[k].pair.size);
  }
  for (auto _ : state) {
    for (std::size_t k = 0; k < all.size(); ++k) benchmark::DoNotOptimize(ask(all[k], k));
  }
  state.counters["a_pair"] =
      benchmark::Counter(kPairs, benchmark::Counter::kIsIterationInvariantRate | benchmark::Counter::kInvert);
  state.counters["declined"] = declined;
  state.counters["largest_error"] = worst;
}

double length_of(const WitnessPair& seed) {
  return seed.status == SeedStatus::usable ? (seed.point_b - seed.point_a).norm()
                                           : std::numeric_limits<double>::quiet_NaN();
}

void add(const std::string& name, const Ask& ask) {
  benchmark::RegisterBenchmark(name.c_str(), [ask](benchmark::State& state) {
    run(state, ask);
  })->Unit(benchmark::kMicrosecond);
}

}  // namespace

void register_seed_benchmarks() {
  for (const auto& [name, seed_of] : seeds_of<Superellipsoid>()) {
    const auto seed = [seed_of = seed_of](const Query& q) { return seed_of(q.a, q.pair.X_WA, q.b, q.pair.X_WB); };
    add("seed/" + name, [seed](const Query& q, std::size_t) { return length_of(seed(q)); });
    // Newton's method alone: the seeds are made once, before the time is taken.
    const auto made = std::make_shared<std::vector<WitnessPair>>();
    for (const NewtonSystem system : {NewtonSystem::eight, NewtonSystem::five}) {
      add((system == NewtonSystem::eight ? "newton8/" : "newton5/") + name,
          [system, made, seed](const Query& q, std::size_t k) {
            if (made->size() == k) made->push_back(seed(q));
            return geom::newton_distance(q.a, q.pair.X_WA, q.b, q.pair.X_WB, system, (*made)[k]).distance;
          });
    }
  }
}

}  // namespace bench
