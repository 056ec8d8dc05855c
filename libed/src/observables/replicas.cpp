#include <ed/replicas.h>

#include <algorithm>
#include <cmath>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

namespace ed {
namespace {

/// Probability that a normal variable is within one standard deviation.
constexpr double kOneSigma = 0.6826894921370859;

/// Finaliser of SplitMix64 (Steele, Lea and Flood 2014).
std::uint64_t mix(std::uint64_t z) {
  z = (z ^ (z >> 30)) * 0xbf58476d1ce4e5b9u;
  z = (z ^ (z >> 27)) * 0x94d049bb133111ebu;
  return z ^ (z >> 31);
}

/// Continued fraction of the incomplete beta function, by Lentz's method. Converges fast for x < (a + 1) / (a + b + 2).
double beta_fraction(double a, double b, double x) {
  constexpr int kMostTerms = 10'000;
  constexpr double kTiny = 1e-300;  // in place of zero denominators
  const auto away = [](double y) { return std::abs(y) < kTiny ? kTiny : y; };
  double c = 1;
  double d = 1 / away(1 - (a + b) * x / (a + 1));
  double value = d;
  for (int k = 1; k <= kMostTerms; ++k) {
    const double m = k;
    const double even = m * (b - m) * x / ((a + 2 * m - 1) * (a + 2 * m));
    d = 1 / away(1 + even * d);
    c = away(1 + even / c);
    value *= c * d;
    const double odd = -(a + m) * (a + b + m) * x / ((a + 2 * m) * (a + 2 * m + 1));
    d = 1 / away(1 + odd * d);
    c = away(1 + odd / c);
    value *= c * d;
    if (std::abs(c * d - 1) < 1e-15) break;
  }
  return value;
}

/// Regularised incomplete beta function I_x(a, b); y is 1 - x, which keeps its digits where x is nearly 1.
double incomplete_beta(double a, double b, double x, double y) {
  if (!(x > 0)) return 0;
  if (!(y > 0)) return 1;
  if (x > (a + 1) / (a + b + 2)) return 1 - incomplete_beta(b, a, y, x);
  const double log_front = std::lgamma(a + b) - std::lgamma(a) - std::lgamma(b) + a * std::log(x) + b * std::log(y);
  return std::exp(log_front) * beta_fraction(a, b, x) / a;
}

std::vector<double> normalised(std::span<const double> weights, std::size_t number) {
  std::vector<double> list(weights.begin(), weights.end());
  if (list.empty()) list.assign(number, 1.0);
  if (list.size() != number) {
    throw std::invalid_argument("weights: there are " + std::to_string(list.size()) + " for " + std::to_string(number) +
                                " replicas; accepted: one for each, or none");
  }
  double sum = 0;
  for (const double w : list) {
    if (!(w > 0 && std::isfinite(w))) {
      throw std::invalid_argument("weights: one is " + std::to_string(w) + "; accepted: positive finite numbers");
    }
    sum += w;
  }
  for (double& w : list) w /= sum;
  return list;
}

void check_values(std::span<const Estimate> replicas) {
  for (const Estimate& e : replicas) {
    if (!std::isfinite(e.value)) {
      throw std::invalid_argument("replicas: a value is " + std::to_string(e.value) + "; accepted: finite numbers");
    }
  }
}

/// Pools without looking for an outlier; at least one replica.
Pooled pooled(std::span<const Estimate> replicas, std::span<const double> weights) {
  Pooled result;
  result.number = replicas.size();
  const std::vector<double> w = normalised(weights, replicas.size());
  double mean = 0;
  for (std::size_t k = 0; k < w.size(); ++k) mean += w[k] * replicas[k].value;
  double scatter = 0;
  double squares = 0;
  for (std::size_t k = 0; k < w.size(); ++k) {
    const double away = replicas[k].value - mean;
    scatter += w[k] * away * away;
    squares += w[k] * w[k] * replicas[k].error * replicas[k].error;
  }
  result.mean.value = mean;
  result.within = std::sqrt(squares);
  result.mean.error = result.within;
  if (w.size() < 2) return result;
  result.degrees_of_freedom = static_cast<int>(w.size()) - 1;
  result.between = std::sqrt(scatter / result.degrees_of_freedom);
  result.mean.error = std::fmax(result.within, student_factor(w.size()) * result.between);
  // Errors within rounding of the value, of quantities that no run changes, are no errors.
  if (!(result.within > 1e-14 * std::abs(mean))) return result;
  const double ratio = result.between / result.within;
  result.chi_square = result.degrees_of_freedom * ratio * ratio;
  result.probability =
      fisher_tail(ratio * ratio, result.degrees_of_freedom, static_cast<double>(w.size()) * (kBlocksOfRun - 1));
  return result;
}

template <class T>
std::vector<T> without(std::span<const T> list, std::size_t k) {
  std::vector<T> others(list.begin(), list.end());
  if (!others.empty()) others.erase(others.begin() + static_cast<std::ptrdiff_t>(k));
  return others;
}

/// Returns the replica without which the others agree best, if they agree then.
std::optional<Outlier> find_outlier(std::span<const Estimate> replicas, std::span<const double> weights) {
  std::optional<Outlier> found;
  double best = kAgreement;
  for (std::size_t k = 0; k < replicas.size(); ++k) {
    const Pooled rest = pooled(without(replicas, k), without(weights, k));
    if (!(rest.probability >= best)) continue;
    best = rest.probability;
    const double error = std::hypot(replicas[k].error, rest.within);
    found = Outlier{k, std::abs(replicas[k].value - rest.mean.value) / error};
  }
  return found;
}

}  // namespace

std::int64_t replica_seed(std::int64_t seed, int replica) {
  if (replica == 0) return seed;
  const std::uint64_t step = static_cast<std::uint64_t>(replica) * 0x9e3779b97f4a7c15u;
  return static_cast<std::int64_t>(mix(mix(static_cast<std::uint64_t>(seed)) + step) >> 11);
}

double fisher_tail(double x, double degrees_of_numerator, double degrees_of_denominator) {
  const double numerator = degrees_of_numerator * x;
  const double sum = numerator + degrees_of_denominator;
  return incomplete_beta(degrees_of_denominator / 2, degrees_of_numerator / 2, degrees_of_denominator / sum,
                         numerator / sum);
}

double student_factor(std::size_t number) {
  if (number < 2) {
    throw std::invalid_argument("number is " + std::to_string(number) + "; accepted: at least 2 replicas");
  }
  const auto degrees = static_cast<double>(number) - 1;
  const double front =
      2 * std::exp(std::lgamma((degrees + 1) / 2) - std::lgamma(degrees / 2)) / std::sqrt(degrees * std::numbers::pi);
  // t^2 is distributed as F with 1 and number - 1 degrees of freedom. The tail is convex and above 1 - kOneSigma at 1:
  // Newton's method rises to the root.
  double t = 1;
  constexpr int kMostSteps = 50;
  for (int k = 0; k < kMostSteps; ++k) {
    const double density = front * std::pow(1 + t * t / degrees, -(degrees + 1) / 2);
    const double step = (fisher_tail(t * t, 1, degrees) - (1 - kOneSigma)) / density;
    t += step;
    if (!(step > 1e-14 * t)) break;
  }
  return t;
}

Pooled pool(std::span<const Estimate> replicas, std::span<const double> weights) {
  check_values(replicas);
  if (replicas.empty()) return {};
  Pooled result = pooled(replicas, weights);
  constexpr std::size_t kLeastForOutliers = 3;  // of two that differ neither is the right one
  if (replicas.size() >= kLeastForOutliers && result.probability < kDisagreement) {
    result.outlier = find_outlier(replicas, weights);
  }
  return result;
}

}  // namespace ed
