#include "sweep/tasks/bundles.h"

#include <algorithm>
#include <iterator>
#include <map>
#include <queue>
#include <utility>

namespace hardbody {
namespace {

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

/// Returns the runs that are to do, the longest first.
std::vector<std::size_t> longest_first(const std::vector<std::size_t>& runs, const std::vector<PointRecord>& records,
                                       const std::vector<std::optional<Cost>>& costs) {
  std::vector<std::size_t> left;
  std::copy_if(runs.begin(), runs.end(), std::back_inserter(left), [&](std::size_t k) { return !is_over(records[k]); });
  const auto seconds = [&](std::size_t k) { return costs[k] ? costs[k]->seconds : 0; };
  std::stable_sort(left.begin(), left.end(), [&](std::size_t a, std::size_t b) { return seconds(a) > seconds(b); });
  return left;
}

/// Bundles single runs for a number of jobs: each goes to the shortest bundle, the longest run first, so that the
/// bundles take about the same time; there are more of them where they would be longer than wished.
std::vector<Bundle> even_bundles(const std::vector<std::size_t>& runs, const std::vector<std::optional<Cost>>& costs,
                                 double task_seconds, std::size_t jobs) {
  std::vector<Bundle> bundles;
  const auto longer = [&](std::size_t a, std::size_t b) {
    return std::pair(bundles[a].seconds, a) > std::pair(bundles[b].seconds, b);
  };
  std::priority_queue<std::size_t, std::vector<std::size_t>, decltype(longer)> shortest(longer);
  for (const std::size_t k : runs) {
    const bool fits =
        !shortest.empty() && bundles.size() >= jobs && has_room(bundles[shortest.top()], costs[k], task_seconds);
    const std::size_t at = fits ? shortest.top() : bundles.size();
    if (fits) {
      shortest.pop();
    } else {
      bundles.emplace_back();
    }
    add(bundles[at], k, costs[k]);
    if (bundles[at].seconds) shortest.push(at);
  }
  for (Bundle& bundle : bundles) std::sort(bundle.runs.begin(), bundle.runs.end());
  return bundles;
}

/// Cuts a chain, or single runs in their order, into bundles as long as wished.
std::vector<Bundle> bundles_in_order(const std::vector<std::size_t>& runs, const std::vector<PointRecord>& records,
                                     const std::vector<std::optional<Cost>>& costs, double task_seconds) {
  std::vector<Bundle> bundles;
  for (const std::size_t k : runs) {
    if (is_over(records[k])) continue;
    if (bundles.empty() || !has_room(bundles.back(), costs[k], task_seconds)) bundles.emplace_back();
    add(bundles.back(), k, costs[k]);
  }
  return bundles;
}

}  // namespace

std::vector<Bundle> bundles_of(const std::vector<PointRecord>& records, const std::vector<std::optional<Cost>>& costs,
                               double task_seconds, const std::optional<int>& jobs) {
  const std::vector<std::vector<std::size_t>> chains = chains_of(records);
  std::vector<Bundle> all;
  for (std::size_t c = 0; c < chains.size(); ++c) {
    const bool single = c == 0;  // runs that wait for no other
    std::vector<Bundle> bundles = single && jobs ? even_bundles(longest_first(chains[c], records, costs), costs,
                                                                task_seconds, static_cast<std::size_t>(*jobs))
                                                 : bundles_in_order(chains[c], records, costs, task_seconds);
    std::optional<int> before;  // last bundle of the chain
    for (Bundle& bundle : bundles) {
      bundle.id = static_cast<int>(all.size()) + 1;
      if (records[bundle.runs.front()].starts_from) bundle.after = before;
      before = bundle.id;
      all.push_back(std::move(bundle));
    }
  }
  return all;
}

}  // namespace hardbody
