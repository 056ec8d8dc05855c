#include "observables/lag_sums.h"

#include "base/legendre.h"
#include "base/sincos.h"

#include <cmath>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

/// sin(x) / x; the rounding of a small x is that of its square root.
double sinc(double x) {
  return x < 1e-4 ? 1 - x * x / 6 : sincos(x).sin / x;
}

void add_displacements(const Snapshot& a, const Snapshot& b, BodyRange range, std::span<const double> wave_numbers,
                       LagSums& sums) {
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const double r2 = (b.position[i] - a.position[i]).squaredNorm();
    sums.msd += r2;
    sums.r4 += r2 * r2;
    const double r = std::sqrt(r2);
    for (std::size_t k = 0; k < wave_numbers.size(); ++k) sums.f_self[k] += sinc(wave_numbers[k] * r);
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
  for (std::size_t i = range.begin; i < range.end; ++i) {
    sums.vacf += a.velocity[i].dot(b.velocity[i]);
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

void LagSums::add(const LagSums& other, double weight) {
  count += weight * other.count;
  msd += weight * other.msd;
  r4 += weight * other.r4;
  rot_msd += weight * other.rot_msd;
  rot_msd_body += weight * other.rot_msd_body;
  c1 += weight * other.c1;
  c2 += weight * other.c2;
  vacf += weight * other.vacf;
  wacf += weight * other.wacf;
  rot_msd_axis += weight * other.rot_msd_axis;
  c1_axis += weight * other.c1_axis;
  c2_axis += weight * other.c2_axis;
  for (std::size_t k = 0; k < f_self.size(); ++k) f_self[k] += weight * other.f_self[k];
}

LagSums correlate(const Snapshot& a, const Snapshot& b, BodyRange range, std::span<const double> wave_numbers) {
  LagSums sums;
  add_displacements(a, b, range, wave_numbers, sums);
  add_rotations(a, b, range, sums);
  add_velocities(a, b, range, sums);
  if (range.three_axes) add_axes(a, b, range, sums);
  LagSums means;
  means.add(sums, 1 / range.size());
  means.count = 1;
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
