#include "observables/order/stationarity.h"

#include "base/periodic.h"
#include "observables/frame_sums.h"
#include "observables/order/bragg.h"
#include "observables/order/directed_results.h"

#include <ed/analysis.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <span>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

constexpr std::size_t kMostMeans = 512;
constexpr int kLeastJudged = 48;  ///< least number of samples that are judged
constexpr int kJudgedEvery = 8;
/// The strongest wave vectors are looked for at this sample, and each time that the number of samples has doubled. All
/// crystals have one up to kLargestOrderQ: of bodies of volume 4 pi / 3, in inverse lengths, at packing fractions up to
/// 0.74.
constexpr int kFirstSearch = 16;
constexpr double kLargestOrderQ = 4.5;
constexpr std::size_t kFollowed = 12;
/// Positions are ordered if S(q) / N is at least this: of two grains of half the box each it is a quarter of that of
/// one crystal, 0.7 where it melts.
constexpr double kOrdered = 0.2;
/// Largest change of means from one half to the other, and largest error of that change.
constexpr double kZChange = 0.01;  ///< relative
constexpr double kOrderChange = 0.05;
constexpr double kErrorsOfChanges = 2;  ///< standard errors that are no change
/// Excess of the octants' order over S that is no domains; some of it is chance in few bodies.
constexpr double kUniform = 0.1;
constexpr double kChanceInOctants = 8;  ///< times 1 / N

int octant_of(const Vector3d& position, double box) {
  const Vector3d r = nearest_image(position, box);
  return (r.x() < 0 ? 0 : 1) + (r.y() < 0 ? 0 : 2) + (r.z() < 0 ? 0 : 4);
}

/// Mean of values and its standard error, from four or eight stretches of them, whichever is larger: values follow each
/// other closely.
Estimate mean_of_series(std::span<const double> values) {
  Estimate result;
  for (const std::size_t blocks : {std::size_t{4}, std::size_t{8}}) {
    std::vector<double> means;
    for (std::size_t b = 0; b < blocks; ++b) {
      const std::size_t from = b * values.size() / blocks;
      const std::size_t to = (b + 1) * values.size() / blocks;
      means.push_back(mean_of_blocks(values.subspan(from, to - from)).value);
    }
    const Estimate found = mean_of_blocks(means);
    result.error = std::isnan(result.error) ? found.error : std::max(result.error, found.error);
  }
  result.value = mean_of_blocks(values).value;
  return result;
}

/// Change from the first half of a series to the second one.
struct Change {
  double value;
  double error;

  explicit Change(std::span<const double> series) {
    const Estimate first = mean_of_series(series.first(series.size() / 2));
    const Estimate second = mean_of_series(series.last(series.size() / 2));
    value = second.value - first.value;
    error = std::hypot(first.error, second.error);
  }

  /// Whether there is no change of `allowed`, and one would be seen.
  bool none(double allowed) const {
    return error <= allowed && std::abs(value) <= std::max(allowed, kErrorsOfChanges * error);
  }
};

double mean_of(std::span<const double> values) {
  return mean_of_blocks(values).value;
}

}  // namespace

double octant_order(const Snapshot& snapshot, double box, const std::vector<BodyRange>& ranges) {
  std::array<Matrix3d, 8> sums;
  sums.fill(Matrix3d::Zero());
  std::array<double, 8> numbers{};
  double all = 0;
  for (const BodyRange& range : ranges) {
    for (std::size_t i = range.begin; i < range.end; ++i) {
      const auto at = static_cast<std::size_t>(octant_of(snapshot.position[i], box));
      sums[at] += 1.5 * snapshot.axis[i] * snapshot.axis[i].transpose();
      numbers[at] += 1;
      all += 1;
    }
  }
  double order = 0;
  for (std::size_t k = 0; k < sums.size(); ++k) {
    if (numbers[k] > 0) order += largest_eigenvalue(sums[k] - 0.5 * numbers[k] * Matrix3d::Identity()) / all;
  }
  return order;
}

double Stationarity::order_of(const Snapshot& now) const {
  return ranges_.empty() ? 0 : largest_eigenvalue(order_tensor(now.axis, ranges_));
}

/// Returns the largest S(q) / N of the wave vectors that are followed; 0 before the first search.
double Stationarity::strongest_intensity(const Snapshot& now) {
  const BodyRange all{0, now.position.size(), false};
  const bool search = samples_ >= kFirstSearch && (samples_ & (samples_ - 1)) == 0;
  if (search) {
    const std::vector<Eigen::Vector3i> vectors = allowed_vectors(box_, kLargestOrderQ / length_, all.size());
    vectors_ = strongest(vectors, intensities(vectors, box_, now.position, all), kFollowed);
  }
  if (vectors_.empty()) return 0;
  const std::vector<double> found = intensities(vectors_, box_, now.position, all);
  return *std::max_element(found.begin(), found.end());
}

void Stationarity::add(const Snapshot& now, double Z) {
  samples_ += 1;
  const double octants = ranges_.empty() ? 0 : octant_order(now, box_, ranges_);
  sum_ += Sample(Z, order_of(now), octants, strongest_intensity(now));
  in_sum_ += 1;
  if (in_sum_ < per_mean_) return;
  means_.push_back(sum_ / in_sum_);
  sum_.setZero();
  in_sum_ = 0;
  if (means_.size() < kMostMeans) return;
  for (std::size_t k = 0; k < kMostMeans / 2; ++k) means_[k] = (means_[2 * k] + means_[2 * k + 1]) / 2;
  means_.resize(kMostMeans / 2);
  per_mean_ *= 2;
}

bool Stationarity::due() const {
  return samples_ >= kLeastJudged && samples_ % kJudgedEvery == 0;
}

Order Stationarity::judge(bool forgotten) const {
  std::array<std::vector<double>, 4> series;
  for (std::size_t k = means_.size() / 3; k < means_.size(); ++k) {
    for (std::size_t n = 0; n < series.size(); ++n) series[n].push_back(means_[k][static_cast<int>(n)]);
  }
  const auto& [Z, S, octants, intensity] = series;
  double number = 0;
  for (const BodyRange& range : ranges_) number += range.size();
  Order order;
  order.S = mean_of(S);
  order.S_octants = mean_of(octants);
  order.bragg = mean_of(intensity);
  const Change Z_change(Z), S_change(S), bragg_change(intensity);
  order.Z_change = Z_change.value / mean_of(Z);
  order.S_change = S_change.value;
  order.bragg_change = bragg_change.value;
  order.nematic = number > 0 && order.S >= least_nematic_order(number);
  order.crystal = order.bragg >= kOrdered;
  order.uniform = !order.nematic || order.S_octants - order.S <= kUniform + kChanceInOctants / number;
  const bool steady = Z_change.none(kZChange * mean_of(Z)) && (number == 0 || S_change.none(kOrderChange)) &&
                      (!order.crystal || bragg_change.none(kOrderChange));
  order.stationary = (order.crystal || (order.nematic && forgotten)) && order.uniform && steady;
  return order;
}

bool Stationarity::fits() const {
  return box_ > 0 && length_ > 0 && samples_ >= 0 && per_mean_ > 0 && in_sum_ >= 0 && in_sum_ < per_mean_ &&
         means_.size() < kMostMeans && vectors_.size() <= kFollowed;
}

}  // namespace ed::internal
