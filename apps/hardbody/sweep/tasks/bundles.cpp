#include "sweep/tasks/bundles.h"

#include <algorithm>
#include <map>

namespace hardbody {
namespace {

bool is_over(const PointRecord& record) {
  return record.status == PointStatus::done || record.status == PointStatus::failed;
}

/// Returns the runs in an order in which each stands behind the one that it starts from, chain after chain. Single
/// runs are a chain together: there, nothing depends on another.
std::vector<std::vector<std::size_t>> chains_of(const std::vector<PointRecord>& records) {
  std::map<std::size_t, std::size_t> next;
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (records[k].starts_from) next[*records[k].starts_from] = k;
  }
  std::vector<std::vector<std::size_t>> chains(1);
  for (std::size_t k = 0; k < records.size(); ++k) {
    if (records[k].starts_from) continue;
    if (!next.contains(k)) {
      chains.front().push_back(k);
      continue;
    }
    std::vector<std::size_t>& chain = chains.emplace_back();
    chain.push_back(k);
    for (auto at = next.find(k); at != next.end(); at = next.find(at->second)) chain.push_back(at->second);
  }
  return chains;
}

/// Returns whether a bundle has room for one more run of this cost.
bool has_room(const Bundle& bundle, const std::optional<Cost>& cost, double task_seconds) {
  return bundle.runs.empty() || (bundle.seconds && cost && *bundle.seconds + cost->seconds <= task_seconds);
}

void add(Bundle& bundle, std::size_t k, const std::optional<Cost>& cost) {
  const bool first = bundle.runs.empty();
  bundle.runs.push_back(k);
  if (!cost) return;
  bundle.seconds = (first ? 0 : *bundle.seconds) + cost->seconds;
  bundle.memory = std::max(first ? 0 : *bundle.memory, cost->memory);
}

}  // namespace

std::vector<Bundle> bundles_of(const std::vector<PointRecord>& records, const std::vector<std::optional<Cost>>& costs,
                               double task_seconds) {
  std::vector<Bundle> bundles;
  for (const std::vector<std::size_t>& chain : chains_of(records)) {
    Bundle bundle;
    std::optional<int> before;  // last bundle of the chain
    const auto close = [&] {
      if (bundle.runs.empty()) return;
      bundle.id = static_cast<int>(bundles.size()) + 1;
      if (records[bundle.runs.front()].starts_from) bundle.after = before;
      before = bundle.id;
      bundles.push_back(bundle);
      bundle = {};
    };
    for (const std::size_t k : chain) {
      if (is_over(records[k])) continue;
      if (!has_room(bundle, costs[k], task_seconds)) close();
      add(bundle, k, costs[k]);
    }
    close();
  }
  return bundles;
}

}  // namespace hardbody
