#include <ed/analysis.h>

#include <Eigen/Core>
#include <unsupported/Eigen/NonLinearOptimization>

#include <algorithm>
#include <cmath>

namespace ed {
namespace {

/// Residuals of A exp[-(t / tau)^beta]; the parameters are A, ln tau and beta, so that tau stays positive.
struct StretchedResiduals {
  std::span<const double> t;
  std::span<const double> y;

  int inputs() const { return 3; }
  int values() const { return static_cast<int>(t.size()); }

  int operator()(const Eigen::VectorXd& p, Eigen::VectorXd& out) const {
    for (std::size_t k = 0; k < t.size(); ++k) {
      out[static_cast<Eigen::Index>(k)] = p[0] * std::exp(-std::pow(t[k] * std::exp(-p[1]), p[2])) - y[k];
    }
    return 0;
  }

  int df(const Eigen::VectorXd& p, Eigen::MatrixXd& J) const {
    for (std::size_t k = 0; k < t.size(); ++k) {
      const auto row = static_cast<Eigen::Index>(k);
      const double log_x = std::log(t[k]) - p[1];
      const double power = std::exp(p[2] * log_x);
      const double decay = std::exp(-power);
      // At t = 0 and long after tau both derivatives vanish, but 0 x infinity would not.
      const double fall = power > 0 && decay > 0 ? p[0] * decay * power : 0;
      J(row, 0) = decay;
      J(row, 1) = fall * p[2];
      J(row, 2) = fall == 0 ? 0 : -fall * log_x;
    }
    return 0;
  }
};

/// Returns where the parabola through three points falls through `level`, between two of them or outside.
double parabola_crossing(std::span<const double> x, std::span<const double> y, double level) {
  // Newton's divided differences about x[1].
  const double d01 = (y[1] - y[0]) / (x[1] - x[0]);
  const double d12 = (y[2] - y[1]) / (x[2] - x[1]);
  const double curvature = (d12 - d01) / (x[2] - x[0]);
  const double slope1 = d01 + curvature * (x[1] - x[0]);
  const double gap = level - y[1];
  const double root = std::sqrt(std::max(0.0, slope1 * slope1 + 4 * curvature * gap));
  // The root on the branch with the slope's sign, in the form that does not cancel.
  return x[1] + 2 * gap / (slope1 - root);
}

}  // namespace

Estimate mean_of_blocks(std::span<const double> values) {
  Estimate result;
  if (values.empty()) return result;
  const auto n = static_cast<double>(values.size());
  double sum = 0;
  for (const double v : values) sum += v;
  result.value = sum / n;
  if (values.size() < 2) return result;
  double squares = 0;
  for (const double v : values) squares += (v - result.value) * (v - result.value);
  result.error = std::sqrt(squares / (n * (n - 1)));
  return result;
}

std::optional<double> slope(std::span<const double> x, std::span<const double> y) {
  const auto n = static_cast<double>(x.size());
  double mean_x = 0;
  double mean_y = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    mean_x += x[k] / n;
    mean_y += y[k] / n;
  }
  double xx = 0;
  double xy = 0;
  for (std::size_t k = 0; k < x.size(); ++k) {
    xx += (x[k] - mean_x) * (x[k] - mean_x);
    xy += (x[k] - mean_x) * (y[k] - mean_y);
  }
  if (!(xx > 0)) return std::nullopt;
  return xy / xx;
}

std::optional<double> first_crossing(std::span<const double> x, std::span<const double> y, double level) {
  if (x.size() < 3) return std::nullopt;
  for (std::size_t k = 1; k < x.size(); ++k) {
    if (!(y[k - 1] > level && y[k] <= level)) continue;
    const std::size_t first = std::min(k == 1 ? 0 : k - 2, x.size() - 3);
    const double t = parabola_crossing(x.subspan(first, 3), y.subspan(first, 3), level);
    // Noise can bend the parabola away; the straight line between the two points cannot leave them.
    if (t >= x[k - 1] && t <= x[k]) return t;
    return x[k - 1] + (x[k] - x[k - 1]) * (y[k - 1] - level) / (y[k - 1] - y[k]);
  }
  return std::nullopt;
}

std::optional<StretchedExponential> fit_stretched_exponential(std::span<const double> t, std::span<const double> y) {
  if (t.size() < 4) return std::nullopt;
  StretchedResiduals residuals{t, y};
  // Start: beta = 1 and the time at which y has fallen to 1/e of its first value.
  const auto fallen = std::find_if(y.begin(), y.end(), [&](double v) { return v < y[0] / std::exp(1.0); });
  const double tau = fallen == y.end() ? t.back() : t[static_cast<std::size_t>(fallen - y.begin())];
  Eigen::VectorXd p(3);
  p << y[0], std::log(tau), 1.0;
  Eigen::LevenbergMarquardt<StretchedResiduals> solver(residuals);
  solver.parameters.xtol = 1e-10;
  solver.parameters.ftol = 1e-12;
  const auto status = solver.minimize(p);
  // An amplitude of zero leaves tau and beta undetermined.
  if (status <= 0 || !p.allFinite() || p[0] == 0 || !(p[2] > 0.1 && p[2] < 3)) return std::nullopt;
  return StretchedExponential{p[0], std::exp(p[1]), p[2]};
}

}  // namespace ed
