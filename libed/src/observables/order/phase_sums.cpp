#include "observables/order/phase_sums.h"

#include "observables/order/bonds.h"
#include "observables/order/bragg.h"
#include "observables/order/cubatic.h"

#include <algorithm>
#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kLargestSearchedQ = 8;  ///< largest wave number that is searched, in inverse lengths
constexpr std::size_t kOfAll = 32;
constexpr std::size_t kOfDirector = 8;

/// Adds to `found` the strongest of the vectors that `takes` takes and that are not in it.
template <class Takes>
void add_strongest(const std::vector<Vector3i>& vectors, const std::vector<double>& values, std::size_t most,
                   const Takes& takes, std::vector<Vector3i>& found) {
  std::vector<Vector3i> some;
  std::vector<double> theirs;
  for (std::size_t k = 0; k < vectors.size(); ++k) {
    if (!takes(vectors[k].cast<double>().normalized())) continue;
    some.push_back(vectors[k]);
    theirs.push_back(values[k]);
  }
  for (const Vector3i& n : strongest(some, theirs, most)) {
    if (std::find(found.begin(), found.end(), n) == found.end()) found.push_back(n);
  }
}

void add_to_each(std::vector<double>& sums, const std::vector<double>& values) {
  if (sums.empty()) sums.assign(values.size(), 0);
  for (std::size_t k = 0; k < sums.size(); ++k) sums[k] += values[k];
}

}  // namespace

void PhaseSums::add(const PhaseSums& other) {
  add_to_each(intensities, other.intensities);
  add_to_each(cubatic, other.cubatic);
  q4 += other.q4;
  q6 += other.q6;
  hexatic += other.hexatic;
}

std::vector<Vector3i> followed_vectors(const StructureGrid& grid, const Snapshot& first, const Vector3d& n) {
  const BodyRange all{0, first.position.size(), false};
  const std::vector<Vector3i> vectors = allowed_vectors(grid.box, kLargestSearchedQ / grid.length, all.size());
  const std::vector<double> values = intensities(vectors, grid.box, first.position, all);
  std::vector<Vector3i> found;
  const auto add = [&](std::size_t most, const auto& takes) { add_strongest(vectors, values, most, takes, found); };
  add(kOfAll, [](const Vector3d&) { return true; });
  add(kOfDirector, [&](const Vector3d& q) { return std::abs(q.dot(n)) >= kCosineAlong; });
  add(kOfDirector, [&](const Vector3d& q) { return std::abs(q.dot(n)) <= kCosineAcross; });
  return found;
}

PhaseSums phase_of(const StructureGrid& grid, const Snapshot& now, const std::vector<BodyRange>& parts,
                   const std::vector<Vector3i>& vectors, const BondOptions& bonds) {
  PhaseSums sums;
  sums.intensities = intensities(vectors, grid.box, now.position, {0, now.position.size(), false});
  for (const BodyRange& part : parts) {
    sums.cubatic.push_back(part.three_axes ? cubatic_order(now.rotation, part.begin, part.end) : 0);
  }
  if (!bonds.steinhardt) return sums;
  const auto number = static_cast<double>(now.position.size());
  const auto neighbours = static_cast<std::size_t>(bonds.neighbours);
  for (const Bonds& of_body : nearest_bonds(now.position, grid.box, neighbours)) {
    sums.q4 += steinhardt(of_body, 4) / number;
    sums.q6 += steinhardt(of_body, 6) / number;
  }
  return sums;
}

}  // namespace ed::internal
