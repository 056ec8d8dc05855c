#pragma once

/// Results reported by the benchmarks of the event loop.

#include <ed/simulation.h>

#include <benchmark/benchmark.h>

#include <cmath>
#include <cstdint>
#include <map>
#include <string>
#include <vector>

namespace hardbody_bench {

/// Reports collisions a second, and the counters that explain them, for the collisions between two states of the
/// counters.
inline void report_rates(benchmark::State& timing, const ed::Counters& before, const ed::Counters& after) {
  const auto collisions = static_cast<double>(after.collisions - before.collisions);
  const auto each = [&](std::uint64_t ed::Counters::*counter) {
    return static_cast<double>(after.*counter - before.*counter) / collisions;
  };
  timing.counters["collisions/s"] = benchmark::Counter(collisions, benchmark::Counter::kIsRate);
  timing.counters["evaluations"] = each(&ed::Counters::evaluations);
  timing.counters["refinements"] = each(&ed::Counters::refinements);
  timing.counters["kernel_calls"] = each(&ed::Counters::kernel_calls);
  timing.counters["rebuilds"] = each(&ed::Counters::neighbour_rebuilds);
  timing.counters["rescues"] = static_cast<double>(after.rescues);
  timing.counters["rescued %"] = 100 * static_cast<double>(after.rescues - before.rescues) /
                                 static_cast<double>(after.evaluations - before.evaluations);
  timing.counters["overlaps"] = static_cast<double>(after.overlaps);
}

/// Prints as usual and keeps the rates.
class KeepRates : public benchmark::ConsoleReporter {
 public:
  void ReportRuns(const std::vector<Run>& runs) override {
    for (const Run& run : runs) {
      const bool wanted = run.repetitions == 1 || run.aggregate_name == "median";
      const auto rate = run.counters.find("collisions/s");
      if (wanted && rate != run.counters.end()) rates_[run.run_name.function_name] = rate->second.value;
    }
    benchmark::ConsoleReporter::ReportRuns(runs);
  }

  /// Returns the rate of a benchmark, NaN if the filter left it out.
  double rate(const std::string& name) const {
    const auto found = rates_.find(name);
    return found == rates_.end() ? std::nan("") : found->second;
  }

 private:
  std::map<std::string, double> rates_;
};

}  // namespace hardbody_bench
