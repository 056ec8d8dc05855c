#include "observables/structure.h"

#include "base/sincos.h"
#include "vectors/products.h"

#include <ed/random.h>
#include <ed/system.h>

#include <algorithm>
#include <cmath>
#include <limits>
#include <memory>
#include <numbers>

namespace ed::internal {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double kReach = 6;        ///< largest distance of pairs, in lengths
constexpr double kBin = 0.05;       ///< width of a bin of distances, in lengths
constexpr double kLargestQ = 12;    ///< largest wave number, in inverse lengths
constexpr double kMostShells = 64;  ///< largest number of shells
constexpr double kPeakFrom = 1.5;   ///< least wave number of a first peak, in inverse lengths
constexpr double kPeakTo = 7;
// Parameters of the fit to Percus and Yevick's S(q).
constexpr double kFittedFrom = 1;          ///< least wave number, in inverse lengths
constexpr double kScaleStep = 1.01;        ///< ratio of two successive scales that are tried
constexpr int kScaleSteps = 40;            ///< steps on either side of 1
constexpr double kLogScaleStep = 0.00995;  ///< ln kScaleStep
constexpr double kScaleSpread = 0.08;      ///< spread of ln s from one shape of bodies to the next
constexpr double kClearPeak = 5;           ///< standard errors by which that has to stand out
constexpr int kTries = 12;                 ///< draws for each wave vector that is to be new

constexpr std::size_t kAtATime = 512;  ///< bodies whose phases are tabulated at once
constexpr int kLargestPower = 500;     ///< largest power of a phase that is tabulated

/// Vectors in a shell, in units of 2 pi / box.
std::vector<Vector3i> draw_vectors(double from, double to, int most, Random& random) {
  std::vector<Vector3i> found;
  for (int k = 0; k < kTries * most && found.size() < static_cast<std::size_t>(most); ++k) {
    const Vector3d direction = random.direction();
    const Vector3d aim = (from + (to - from) * random.uniform()) * direction;
    const Vector3i n = one_of_two(aim.array().round().cast<int>());
    const double size = n.cast<double>().norm();
    if (size < from || size >= to || std::find(found.begin(), found.end(), n) != found.end()) continue;
    found.push_back(n);
  }
  return found;
}

/// Largest length, in 2 pi / box, up to which the vectors of a shell are listed and not drawn.
constexpr double kListedTo = 40;

/// Returns all vectors of a shell, in units of 2 pi / box; `most` of them, evenly taken from the list, if there are
/// more.
std::vector<Vector3i> list_vectors(double from, double to, int most) {
  std::vector<Vector3i> all;
  const int end = static_cast<int>(std::ceil(to));
  for (int x = 0; x <= end; ++x) {
    for (int y = -end; y <= end; ++y) {
      for (int z = -end; z <= end; ++z) {
        const Vector3i n(x, y, z);
        const double size = n.cast<double>().norm();
        if (size > 0 && size >= from && size < to && n == one_of_two(n)) all.push_back(n);
      }
    }
  }
  const auto wanted = static_cast<std::size_t>(most);
  if (all.size() <= wanted) return all;
  std::vector<Vector3i> some;
  for (std::size_t k = 0; k < wanted; ++k) some.push_back(all[k * all.size() / wanted]);
  return some;
}

/// Multiplies complex numbers.
void multiply(const double* a_re, const double* a_im, const double* b_re, const double* b_im, std::size_t number,
              double* __restrict re, double* __restrict im) {
  for (std::size_t i = 0; i < number; ++i) {
    re[i] = a_re[i] * b_re[i] - a_im[i] * b_im[i];
    im[i] = a_re[i] * b_im[i] + a_im[i] * b_re[i];
  }
}

/// exp(i k x) of all bodies for k = 0, 1, .. along one axis: real and imaginary parts, those of one k together.
struct Phases {
  std::unique_ptr<double[]> re, im;

  Phases(const std::vector<Vector3d>& positions, BodyRange range, int axis, double unit, int largest) {
    const std::size_t n = range.end - range.begin;
    const std::size_t size = n * (static_cast<std::size_t>(largest) + 1);
    re = std::make_unique_for_overwrite<double[]>(size);
    im = std::make_unique_for_overwrite<double[]>(size);
    std::fill_n(re.get(), n, 1.0);
    std::fill_n(im.get(), n, 0.0);
    if (largest < 1) return;
    for (std::size_t i = 0; i < n; ++i) {
      const SinCos one = sincos(unit * positions[range.begin + i][axis]);
      re[n + i] = one.cos;
      im[n + i] = one.sin;
    }
    // All bodies of one power: a body's powers are far apart in memory.
    for (std::size_t k = 2 * n; k < size; k += n) multiply(&re[k - n], &im[k - n], &re[n], &im[n], n, &re[k], &im[k]);
  }
};

/// Adds the sum of exp(i q.r) over the bodies: those of even and of odd number apart.
void add_amplitude(const Phases (&phases)[3], const Vector3i& n, std::size_t bodies, ProductKernel& products,
                   Amplitude& sum) {
  PhaseRows rows;
  for (int axis = 0; axis < 3; ++axis) {
    const auto at = static_cast<std::size_t>(std::abs(n[axis])) * bodies;
    rows.re[axis] = &phases[axis].re[at];
    rows.im[axis] = &phases[axis].im[at];
    rows.sign[axis] = n[axis] < 0 ? -1 : 1;
  }
  ProductSums sums{};
  const std::size_t fours = bodies / 4 * 4;
  products(rows, static_cast<int>(fours), sums);
  for (std::size_t i = fours; i < bodies; ++i) {
    const std::size_t parity = i % 2;
    const double xr = rows.re[0][i], xi = rows.sign[0] * rows.im[0][i];
    const double yr = rows.re[1][i], yi = rows.sign[1] * rows.im[1][i];
    const double zr = rows.re[2][i], zi = rows.sign[2] * rows.im[2][i];
    const double pr = xr * yr - xi * yi;
    const double pi = xr * yi + xi * yr;
    sums.re[parity] += pr * zr - pi * zi;
    sums.im[parity] += pr * zi + pi * zr;
  }
  sum.re += sums.re[0] + sums.re[1];
  sum.im += sums.im[0] + sums.im[1];
}

/// Adds that sum body by body, without tabulated phases.
void add_amplitude(const std::vector<Vector3d>& positions, BodyRange range, const Vector3d& q, Amplitude& sum) {
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const SinCos one = sincos(q.dot(positions[i]));
    sum.re += one.cos;
    sum.im += one.sin;
  }
}

}  // namespace

Vector3i one_of_two(const Vector3i& n) {
  for (int k = 0; k < 3; ++k) {
    if (n[k] != 0) return n[k] < 0 ? Vector3i(-n) : n;
  }
  return n;
}

// ---- Grid

double StructureGrid::reach() const {
  return std::min(0.5 * box, kReach * length);
}
std::size_t StructureGrid::bins() const {
  return static_cast<std::size_t>(std::max(1.0, std::round(reach() / (kBin * length))));
}
double StructureGrid::shell_width() const {
  return std::max(2 * std::numbers::pi / box, kLargestQ / (length * kMostShells));
}
std::size_t StructureGrid::shells() const {
  return static_cast<std::size_t>(std::max(1.0, kLargestQ / (length * shell_width())));
}

StructureGrid structure_grid(const System& system) {
  const double volume = packing_fraction(system) * system.box * system.box * system.box / system.size();
  return {system.box, std::cbrt(volume / (4 * std::numbers::pi / 3))};
}

void StructureSums::add(const StructureSums& other) {
  for (std::size_t k = 0; k < pairs.size(); ++k) pairs[k] += other.pairs[k];
  for (std::size_t k = 0; k < p2.size(); ++k) p2[k] += other.p2[k];
  for (std::size_t k = 0; k < S.size(); ++k) S[k] += other.S[k];
}

// ---- S(q)

WaveVectors::WaveVectors(const StructureGrid& grid, double from, double to, int most)
    : box_(grid.box), vectors_(grid.shells()), wave_numbers_(grid.shells(), 0) {
  Random random(1);
  const double unit = 2 * std::numbers::pi / box_;
  const double width = grid.shell_width() / unit;
  for (std::size_t shell = 0; shell < vectors_.size(); ++shell) {
    const double centre = (static_cast<double>(shell) + 1) * width;
    if (centre * unit < from || centre * unit > to) continue;
    vectors_[shell] = draw_vectors(centre - 0.5 * width, centre + 0.5 * width, most, random);
    for (const Vector3i& n : vectors_[shell]) {
      largest_ = std::max(largest_, n.cwiseAbs().maxCoeff());
      wave_numbers_[shell] += unit * n.cast<double>().norm() / static_cast<double>(vectors_[shell].size());
    }
  }
}

WaveVectors::WaveVectors(double box, const std::vector<Vector3i>& each) : box_(box) {
  for (const Vector3i& n : each) {
    vectors_.push_back({one_of_two(n)});
    wave_numbers_.push_back(2 * std::numbers::pi / box * n.cast<double>().norm());
    largest_ = std::max(largest_, n.cwiseAbs().maxCoeff());
  }
}

WaveVectors::WaveVectors(double box, const std::vector<double>& about, int most)
    : box_(box), vectors_(about.size()), wave_numbers_(about.size(), 0) {
  Random random(1);
  const double unit = 2 * std::numbers::pi / box_;
  for (std::size_t shell = 0; shell < about.size(); ++shell) {
    const double centre = about[shell] / unit;
    if (centre < 0.5) continue;
    const double from = centre - 0.5;
    const double to = centre + 0.5;
    vectors_[shell] = to > kListedTo ? draw_vectors(from, to, most, random) : list_vectors(from, to, most);
    for (const Vector3i& n : vectors_[shell]) {
      largest_ = std::max(largest_, n.cwiseAbs().maxCoeff());
      wave_numbers_[shell] += unit * n.cast<double>().norm() / static_cast<double>(vectors_[shell].size());
    }
  }
}

Amplitudes WaveVectors::amplitudes(const std::vector<Vector3d>& positions, BodyRange range) const {
  const double unit = 2 * std::numbers::pi / box_;
  ProductKernel& products = *find_product_kernel();
  Amplitudes sums;
  for (const std::vector<Vector3i>& shell : vectors_) sums.emplace_back(shell.size());
  for (std::size_t begin = range.begin; begin < range.end; begin += kAtATime) {
    const BodyRange some{begin, std::min(range.end, begin + kAtATime), false};
    // In large boxes the powers of one phase would outnumber the wave vectors.
    const int largest = largest_ > kLargestPower ? 0 : largest_;
    const Phases phases[3] = {
        {positions, some, 0, unit, largest}, {positions, some, 1, unit, largest}, {positions, some, 2, unit, largest}};
    for (std::size_t s = 0; s < vectors_.size(); ++s) {
      for (std::size_t v = 0; v < vectors_[s].size(); ++v) {
        const Vector3i& n = vectors_[s][v];
        if (largest == largest_) {
          add_amplitude(phases, n, some.end - some.begin, products, sums[s][v]);
        } else {
          add_amplitude(positions, some, unit * n.cast<double>(), sums[s][v]);
        }
      }
    }
  }
  return sums;
}

std::vector<double> WaveVectors::structure_factor(const std::vector<Vector3d>& positions, BodyRange range) const {
  const Amplitudes sums = amplitudes(positions, range);
  return internal::structure_factor(sums, sums, range.size(), range.size());
}

std::vector<double> structure_factor(const Amplitudes& a, const Amplitudes& b, double n_a, double n_b) {
  std::vector<double> S;
  const double bodies = n_a == n_b ? n_a : std::sqrt(n_a * n_b);
  for (std::size_t shell = 0; shell < a.size(); ++shell) {
    const std::size_t vectors = a[shell].size();
    double sum = 0;
    for (std::size_t v = 0; v < vectors; ++v) {
      sum += a[shell][v].re * b[shell][v].re + a[shell][v].im * b[shell][v].im;
    }
    S.push_back(vectors == 0 ? 0 : sum / (static_cast<double>(vectors) * bodies));
  }
  return S;
}

std::size_t highest(const std::vector<double>& q, const std::vector<double>& S, double length) {
  std::size_t top = S.size();
  for (std::size_t k = 0; k < q.size(); ++k) {
    if (q[k] * length < kPeakFrom || q[k] * length > kPeakTo || !(S[k] > 0)) continue;
    if (top == S.size() || S[k] > S[top]) top = k;
  }
  return top;
}

bool stands_out(double height, double error) {
  return height - 1 > kClearPeak * error;
}

Peak first_peak(const std::vector<double>& q, const std::vector<double>& S, double length) {
  constexpr double kNoPeak = std::numeric_limits<double>::quiet_NaN();
  const std::size_t top = highest(q, S, length);
  if (top == S.size()) return {kNoPeak, kNoPeak};
  const Peak peak{q[top], S[top]};
  if (top < 1 || top + 1 >= q.size() || !(q[top - 1] > 0 && q[top + 1] > 0)) return peak;
  // Newton's divided differences about the top.
  const double left = q[top - 1] - q[top];
  const double right = q[top + 1] - q[top];
  const double d_left = (S[top - 1] - S[top]) / left;
  const double d_right = (S[top + 1] - S[top]) / right;
  const double curvature = (d_right - d_left) / (right - left);
  const double slope = d_left - curvature * left;
  const double x = -slope / (2 * curvature);
  if (!(curvature < 0) || x < left || x > right) return peak;
  return {q[top] + x, S[top] + 0.5 * slope * x};
}

// ---- The first peak of noisy data

double percus_yevick(double q, double packing_fraction) {
  const double eta = packing_fraction;
  const double x = 2 * q;
  const auto [sin, cos] = sincos(x);
  const double x2 = x * x;
  const double close = (1 - eta) * (1 - eta);
  const double a = (1 + 2 * eta) * (1 + 2 * eta) / (close * close);
  const double b = -(1 + eta / 2) * (1 + eta / 2) / (close * close);
  const double first = a * (sin - x * cos) / (x2 * x);
  const double second = -6 * eta * b * (x2 * cos - 2 * x * sin - 2 * cos + 2) / (x2 * x2);
  const double third =
      -0.5 * eta * a * ((x2 * x2 - 12 * x2 + 24) * cos + (24 * x - 4 * x2 * x) * sin - 24) / (x2 * x2 * x2);
  return 1 / (1 + 24 * eta * (first + second + third));
}

namespace {

/// The top of Percus and Yevick's first peak.
double percus_yevick_peak(double packing_fraction) {
  // The peak moves from 2.88 in a gas to 4 beyond all fluids.
  constexpr int kNumber = 40;
  std::vector<double> q, S;
  q.reserve(kNumber);
  S.reserve(kNumber);
  for (int k = 0; k < kNumber; ++k) {
    q.push_back(2.5 + 0.05 * k);
    S.push_back(percus_yevick(q.back(), packing_fraction));
  }
  return first_peak(q, S, 1).q;
}

/// The sum of squares that the best height leaves, in units of the scatter, and what is expected of the scale.
double misfit(const WaveVectors& vectors, const std::vector<double>& S, double frames, double length,
              double packing_fraction, double scale, int step) {
  double tt = 0, ty = 0, yy = 0;
  for (std::size_t k = 0; k < S.size(); ++k) {
    const double q = vectors.wave_numbers()[k] * length;
    if (q < kFittedFrom || q > kPeakTo) continue;
    const double weight = frames * static_cast<double>(vectors.number(k));
    const double t = percus_yevick(q / scale, packing_fraction) - 1;
    tt += weight * t * t;
    ty += weight * t * (S[k] - 1);
    yy += weight * (S[k] - 1) * (S[k] - 1);
  }
  const double off = step * kLogScaleStep / kScaleSpread;
  return yy - (ty > 0 ? ty * ty / tt : 0) + off * off;
}

/// Returns by how much the peak is stretched: the scale of least misfit, by a parabola through it and its neighbours.
double best_scale(const WaveVectors& vectors, const std::vector<double>& S, double frames, double length,
                  double packing_fraction) {
  std::vector<double> scales = {1};
  for (int k = 0; k < kScaleSteps; ++k) {
    scales.insert(scales.begin(), scales.front() / kScaleStep);
    scales.push_back(scales.back() * kScaleStep);
  }
  std::vector<double> misfits;
  misfits.reserve(scales.size());
  for (int k = 0; k < static_cast<int>(scales.size()); ++k) {
    misfits.push_back(
        misfit(vectors, S, frames, length, packing_fraction, scales[static_cast<std::size_t>(k)], k - kScaleSteps));
  }
  const auto best = static_cast<std::size_t>(std::min_element(misfits.begin(), misfits.end()) - misfits.begin());
  if (best == 0 || best + 1 == misfits.size()) return scales[best];
  const double bend = misfits[best - 1] - 2 * misfits[best] + misfits[best + 1];
  const double shift = bend > 0 ? 0.5 * (misfits[best - 1] - misfits[best + 1]) / bend : 0;
  return scales[best] * (1 + shift * (kScaleStep - 1));
}

/// Whether a peak of S(q) stands out of its scatter.
bool is_clear(const WaveVectors& vectors, double frames, const Peak& peak) {
  const std::vector<double>& q = vectors.wave_numbers();
  std::size_t nearest = 0;
  for (std::size_t k = 0; k < q.size(); ++k) {
    if (std::abs(q[k] - peak.q) < std::abs(q[nearest] - peak.q)) nearest = k;
  }
  return stands_out(peak.S, peak.S / std::sqrt(frames * static_cast<double>(vectors.number(nearest))));
}

}  // namespace

std::optional<double> clear_peak(const WaveVectors& vectors, const std::vector<double>& S, double frames,
                                 double length) {
  const Peak peak = first_peak(vectors.wave_numbers(), S, length);
  return is_clear(vectors, frames, peak) ? std::optional(peak.q) : std::nullopt;
}

double likely_peak(const WaveVectors& vectors, const std::vector<double>& S, double frames, const StructureGrid& grid,
                   double packing_fraction) {
  if (const auto clear = clear_peak(vectors, S, frames, grid.length)) return *clear;
  return best_scale(vectors, S, frames, grid.length, packing_fraction) * percus_yevick_peak(packing_fraction) /
         grid.length;
}

}  // namespace ed::internal
