#include <ed/polydispersity.h>
#include <ed/random.h>

#include <algorithm>
#include <cmath>
#include <sstream>
#include <stdexcept>
#include <variant>

namespace ed {
namespace {

/// Returns the probability that a normal deviate is below x.
double below(double x) {
  return 0.5 * std::erfc(-x / std::sqrt(2.0));
}

/// Returns <exp(s z)> of a normal deviate z that is cut off at +-kSizeCutoff.
double mean_exponential(double s) {
  const double kept = below(kSizeCutoff) - below(-kSizeCutoff);
  return std::exp(0.5 * s * s) * (below(kSizeCutoff - s) - below(-kSizeCutoff - s)) / kept;
}

/// Returns the standard deviation of exp(s z) relative to its mean.
double spread(double s) {
  const double mean = mean_exponential(s);
  return std::sqrt(std::max(0.0, mean_exponential(2 * s) / (mean * mean) - 1));
}

/// Returns s with spread(s) = width, by bisection: spread grows with s, and is 0.82 at 0.75.
double exponent_of(double width) {
  double low = 0;
  double high = 0.75;
  for (int step = 0; step < 60; ++step) {
    const double middle = 0.5 * (low + high);
    (spread(middle) < width ? low : high) = middle;
  }
  return 0.5 * (low + high);
}

/// Returns the standard deviation of a normal deviate that is cut off at +-kSizeCutoff.
double cut_deviation() {
  constexpr double kInverseSqrt2Pi = 0.39894228040143268;
  const double density = kInverseSqrt2Pi * std::exp(-0.5 * kSizeCutoff * kSizeCutoff);
  return std::sqrt(1 - 2 * kSizeCutoff * density / (below(kSizeCutoff) - below(-kSizeCutoff)));
}

double cut_normal(Random& random) {
  while (true) {
    const double z = random.normal();
    if (std::abs(z) <= kSizeCutoff) return z;
  }
}

BodyShape scaled_shape(const BodyShape& shape, double factor) {
  const auto scaled = [&](const auto& s) -> BodyShape {
    if constexpr (requires { s.scaled(factor); }) return s.scaled(factor);
    throw std::invalid_argument("scaled: shape " + describe(shape) + " cannot be scaled; accepted: built-in shapes");
  };
  return std::visit(scaled, shape);
}

}  // namespace

const char* to_string(SizeDistribution distribution) {
  switch (distribution) {
    case SizeDistribution::uniform:
      return "uniform";
    case SizeDistribution::gaussian:
      return "gaussian";
    case SizeDistribution::lognormal:
      return "lognormal";
  }
  return "unknown";
}

double widest(SizeDistribution distribution) {
  return distribution == SizeDistribution::gaussian ? 0.3 : 0.5;
}

std::vector<double> draw_sizes(SizeDistribution distribution, double width, int number, std::uint64_t seed) {
  if (!(width > 0 && width <= widest(distribution))) {
    std::ostringstream message;
    message << "width of the " << to_string(distribution) << " sizes is " << width << "; accepted: above 0, at most "
            << widest(distribution);
    throw std::invalid_argument(message.str());
  }
  if (number < 0) throw std::invalid_argument("number of sizes is negative; accepted: at least 0");
  Random random(seed);
  std::vector<double> sizes(static_cast<std::size_t>(number));
  if (distribution == SizeDistribution::uniform) {
    for (double& size : sizes) size = 1 + std::sqrt(3.0) * width * (2 * random.uniform() - 1);
    return sizes;
  }
  if (distribution == SizeDistribution::gaussian) {
    const double unit = width / cut_deviation();
    for (double& size : sizes) size = 1 + unit * cut_normal(random);
    return sizes;
  }
  const double s = exponent_of(width);
  const double mean = mean_exponential(s);
  for (double& size : sizes) size = std::exp(s * cut_normal(random)) / mean;
  return sizes;
}

Species scaled(const Species& species, double factor) {
  if (!(factor > 0) || !std::isfinite(factor)) {
    std::ostringstream message;
    message << "scaled: factor is " << factor << "; accepted: a positive finite number";
    throw std::invalid_argument(message.str());
  }
  const double cube = factor * factor * factor;
  return {scaled_shape(species.shape, factor), cube * species.mass, cube * factor * factor * species.inertia,
          species.spins};
}

}  // namespace ed
