#include "observables/lag_sums.h"

#include "base/legendre.h"
#include "base/sincos.h"
#include "vectors/displacements.h"

#include <algorithm>
#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

constexpr double kSmall = 1e-4;  ///< limit below which sin(x) / x is 1 - x^2 / 6 to rounding

/// sin(x) / x; the rounding of a small x is that of its square root.
double sinc(double x) {
  return x < kSmall ? 1 - x * x / 6 : sincos(x).sin / x;
}

constexpr std::size_t kAtATime = kDisplacementsAtATime;

/// Displacements of kAtATime bodies at a time, with the bits of a body by itself.
class Displacements {
 public:
  Displacements(const Snapshot& a, const Snapshot& b, std::span<const double> wave_numbers)
      : a_(a), b_(b), wave_numbers_(wave_numbers), kernel_(*find_displacement_kernel()) {}

  const double* squares() const { return squares_; }
  const double* scattering(std::size_t k) const { return scattering_ + k * kAtATime; }

  /// Sets those of bodies begin, begin + 1, .., end - 1; at most kAtATime.
  void set(std::size_t begin, std::size_t end) {
    const double* from = a_.position[begin].data();
    const double* to = b_.position[begin].data();
    if (end - begin < kAtATime) {
      from = std::copy_n(from, 3 * (end - begin), from_) - 3 * (end - begin);
      to = std::copy_n(to, 3 * (end - begin), to_) - 3 * (end - begin);
    }
    kernel_(from, to, wave_numbers_.data(), static_cast<int>(wave_numbers_.size()), squares_, scattering_);
    const auto [least, largest] = std::minmax_element(squares_, squares_ + (end - begin));
    for (std::size_t k = 0; k < wave_numbers_.size(); ++k) {
      const double q = wave_numbers_[k];
      if (q * std::sqrt(*least) >= kSmall && q * std::sqrt(*largest) <= kLargestAngle) continue;
      for (std::size_t i = 0; i < end - begin; ++i) scattering_[k * kAtATime + i] = sinc(q * std::sqrt(squares_[i]));
    }
  }

 private:
  const Snapshot& a_;
  const Snapshot& b_;
  std::span<const double> wave_numbers_;
  DisplacementKernel& kernel_;
  double squares_[kAtATime];
  double scattering_[kMostWaveNumbers * kAtATime];
  double from_[3 * kAtATime] = {}, to_[3 * kAtATime] = {};
};

/// Adds scattering functions of `bodies` bodies at kNumber wave numbers, from k on: sums that do not wait for each
/// other.
template <std::size_t kNumber>
void add_scattering(const Displacements& moved, std::size_t bodies, std::size_t k, LagSums& sums) {
  double f[kNumber];
  for (std::size_t m = 0; m < kNumber; ++m) f[m] = sums.f_self[k + m];
  for (std::size_t i = 0; i < bodies; ++i) {
    for (std::size_t m = 0; m < kNumber; ++m) f[m] += moved.scattering(k + m)[i];
  }
  for (std::size_t m = 0; m < kNumber; ++m) sums.f_self[k + m] = f[m];
}

void add_displacements(const Snapshot& a, const Snapshot& b, BodyRange range, std::span<const double> wave_numbers,
                       double overlap_length, LagSums& sums) {
  const double near = overlap_length * overlap_length;
  Displacements moved(a, b, wave_numbers);
  for (std::size_t begin = range.begin; begin < range.end; begin += kAtATime) {
    const std::size_t bodies = std::min(kAtATime, range.end - begin);
    moved.set(begin, begin + bodies);
    double overlap = sums.overlap, msd = sums.msd, r4 = sums.r4;  // of their own, else every sum goes through memory
    for (std::size_t i = 0; i < bodies; ++i) {
      const double r2 = moved.squares()[i];
      overlap += r2 < near ? 1 : 0;
      msd += r2;
      r4 += r2 * r2;
    }
    sums.overlap = overlap;
    sums.msd = msd;
    sums.r4 = r4;
    std::size_t k = 0;
    for (; k + 4 <= wave_numbers.size(); k += 4) add_scattering<4>(moved, bodies, k, sums);
    const std::size_t left = wave_numbers.size() - k;
    if (left == 3) add_scattering<3>(moved, bodies, k, sums);
    if (left == 2) add_scattering<2>(moved, bodies, k, sums);
    if (left == 1) add_scattering<1>(moved, bodies, k, sums);
  }
}

void add_rotations(const Snapshot& a, const Snapshot& b, BodyRange range, LagSums& sums) {
  double rot_msd = 0, rot_msd_body = 0, c1 = 0, c2 = 0;
  Vector3d rot_msd_axis = Vector3d::Zero();
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const Vector3d turned = b.phi_body[i] - a.phi_body[i];
    rot_msd += (b.phi_lab[i] - a.phi_lab[i]).squaredNorm();
    rot_msd_body += turned.squaredNorm();
    rot_msd_axis += turned.cwiseAbs2();
    const double cosine = a.axis[i].dot(b.axis[i]);
    c1 += cosine;
    c2 += p2(cosine);
  }
  sums.rot_msd = rot_msd;
  sums.rot_msd_body = rot_msd_body;
  sums.rot_msd_axis = rot_msd_axis;
  sums.c1 = c1;
  sums.c2 = c2;
}

/// Returns the sum of products of two vectors of each body.
double sum_of_products(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b, BodyRange range) {
  double sum = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) sum += a[i].dot(b[i]);
  return sum;
}

void add_axes(const Snapshot& a, const Snapshot& b, BodyRange range, LagSums& sums) {
  Vector3d c1 = Vector3d::Zero(), c2 = Vector3d::Zero();
  for (std::size_t i = range.begin; i < range.end; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double cosine = a.rotation[i].col(k).dot(b.rotation[i].col(k));
      c1[k] += cosine;
      c2[k] += p2(cosine);
    }
  }
  sums.c1_axis = c1;
  sums.c2_axis = c2;
}

}  // namespace

void LagSums::add(const LagSums& other, double weight, double weight_of_rotations) {
  count += weight * other.count;
  overlap += weight * other.overlap;
  overlap2 += weight * other.overlap2;
  msd += weight * other.msd;
  r4 += weight * other.r4;
  rot_msd += weight_of_rotations * other.rot_msd;
  rot_msd_body += weight_of_rotations * other.rot_msd_body;
  c1 += weight_of_rotations * other.c1;
  c2 += weight_of_rotations * other.c2;
  vacf += weight * other.vacf;
  wacf += weight_of_rotations * other.wacf;
  rot_msd_axis += weight_of_rotations * other.rot_msd_axis;
  c1_axis += weight_of_rotations * other.c1_axis;
  c2_axis += weight_of_rotations * other.c2_axis;
  for (std::size_t k = 0; k < f_self.size(); ++k) f_self[k] += weight * other.f_self[k];
  directed.add(other.directed, weight);
}

LagSums correlate(const Snapshot& a, const Snapshot& b, BodyRange range, std::span<const double> wave_numbers,
                  double overlap_length, const Vector3d& director) {
  LagSums sums;
  sums.directed = directed_sums(a, b, range.begin, range.end, director);
  add_displacements(a, b, range, wave_numbers, overlap_length, sums);
  sums.vacf = sum_of_products(a.velocity, b.velocity, range);
  if (range.oriented) {
    add_rotations(a, b, range, sums);
    sums.wacf = sum_of_products(a.angular_velocity, b.angular_velocity, range);
    if (range.three_axes) add_axes(a, b, range, sums);
  }
  LagSums means;
  means.add(sums, 1 / range.size());
  means.count = 1;
  means.overlap2 = means.overlap * means.overlap;
  return means;
}

double mean_square_displacement(const Snapshot& a, const Snapshot& b, BodyRange range) {
  double sum = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) sum += (b.position[i] - a.position[i]).squaredNorm();
  return sum / range.size();
}

double mean_p2(const Snapshot& a, const Snapshot& b, BodyRange range) {
  double sum = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) sum += p2(a.axis[i].dot(b.axis[i]));
  return sum / range.size();
}

double self_scattering(const Snapshot& a, const Snapshot& b, BodyRange range, double wave_number) {
  double sum = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    sum += sinc(wave_number * (b.position[i] - a.position[i]).norm());
  }
  return sum / range.size();
}

}  // namespace ed::internal
