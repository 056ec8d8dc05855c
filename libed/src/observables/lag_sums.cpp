#include "observables/lag_sums.h"

#include "base/lanes.h"
#include "base/legendre.h"
#include "base/sincos.h"

#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

constexpr double kSmall = 1e-4;  ///< limit below which sin(x) / x is 1 - x^2 / 6 to rounding

/// sin(x) / x; the rounding of a small x is that of its square root.
double sinc(double x) {
  return x < kSmall ? 1 - x * x / 6 : sincos(x).sin / x;
}

/// Returns sinc() of both lanes with the same bits, for kSmall <= x <= kLargestAngle.
Lanes sinc_of_both(Lanes x) {
  return sincos(x).sin / x;
}

void add_scattering(double r, std::span<const double> wave_numbers, LagSums& sums) {
  std::size_t k = 0;
  for (; k + 2 <= wave_numbers.size(); k += 2) {
    const Lanes x = {wave_numbers[k] * r, wave_numbers[k + 1] * r};
    const bool usual = x[0] >= kSmall && x[0] <= kLargestAngle && x[1] >= kSmall && x[1] <= kLargestAngle;
    const Lanes both = usual ? sinc_of_both(x) : Lanes{sinc(x[0]), sinc(x[1])};
    sums.f_self[k] += both[0];
    sums.f_self[k + 1] += both[1];
  }
  for (; k < wave_numbers.size(); ++k) sums.f_self[k] += sinc(wave_numbers[k] * r);
}

void add_displacements(const Snapshot& a, const Snapshot& b, BodyRange range, std::span<const double> wave_numbers,
                       double overlap_length, LagSums& sums) {
  const double near = overlap_length * overlap_length;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const double r2 = (b.position[i] - a.position[i]).squaredNorm();
    sums.overlap += r2 < near ? 1 : 0;
    sums.msd += r2;
    sums.r4 += r2 * r2;
    add_scattering(std::sqrt(r2), wave_numbers, sums);
  }
}

void add_rotations(const Snapshot& a, const Snapshot& b, BodyRange range, LagSums& sums) {
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const Vector3d turned = b.phi_body[i] - a.phi_body[i];
    sums.rot_msd += (b.phi_lab[i] - a.phi_lab[i]).squaredNorm();
    sums.rot_msd_body += turned.squaredNorm();
    sums.rot_msd_axis += turned.cwiseAbs2();
    const double cosine = a.axis[i].dot(b.axis[i]);
    sums.c1 += cosine;
    sums.c2 += p2(cosine);
  }
}

void add_velocities(const Snapshot& a, const Snapshot& b, BodyRange range, LagSums& sums) {
  for (std::size_t i = range.begin; i < range.end; ++i) sums.vacf += a.velocity[i].dot(b.velocity[i]);
}

void add_angular_velocities(const Snapshot& a, const Snapshot& b, BodyRange range, LagSums& sums) {
  for (std::size_t i = range.begin; i < range.end; ++i) {
    sums.wacf += a.angular_velocity[i].dot(b.angular_velocity[i]);
  }
}

void add_axes(const Snapshot& a, const Snapshot& b, BodyRange range, LagSums& sums) {
  for (std::size_t i = range.begin; i < range.end; ++i) {
    for (int k = 0; k < 3; ++k) {
      const double cosine = a.rotation[i].col(k).dot(b.rotation[i].col(k));
      sums.c1_axis[k] += cosine;
      sums.c2_axis[k] += p2(cosine);
    }
  }
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
  add_velocities(a, b, range, sums);
  if (range.oriented) {
    add_rotations(a, b, range, sums);
    add_angular_velocities(a, b, range, sums);
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
