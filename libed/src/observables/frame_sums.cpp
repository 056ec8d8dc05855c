#include "observables/frame_sums.h"

#include <Eigen/Eigenvalues>

#include <limits>
#include <optional>

namespace ed::internal {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;

double mean_square(const std::vector<Vector3d>& vectors, BodyRange range) {
  double sum = 0;
  for (std::size_t i = range.begin; i < range.end; ++i) sum += vectors[i].squaredNorm();
  return sum / range.size();
}

}  // namespace

/// <m v^2> of a body is 3 kT (1 - m / M): the rest is in the motion of all, which momentum zero forbids.
Freedoms freedoms_of(const System& system, BodyRange range) {
  double mass = 0;
  for (int i = 0; i < system.size(); ++i) mass += system.species_of(i).mass;
  Freedoms result;
  for (std::size_t i = range.begin; i < range.end; ++i) {
    const Species& species = system.species_of(static_cast<int>(i));
    const std::optional<int> axis = symmetry_axis(species);
    result.translational += 3 * (1 - species.mass / mass);
    result.rotational += axis ? 2 : 3;
    result.axis += Vector3d::Ones();
    if (axis && !species.spins) result.axis[*axis] -= 1;
  }
  return result;
}

FrameSums& FrameSums::operator+=(const FrameSums& other) {
  S += other.S;
  order += other.order;
  translational_kT += other.translational_kT;
  rotational_kT += other.rotational_kT;
  axis_kT += other.axis_kT;
  v2 += other.v2;
  w2 += other.w2;
  return *this;
}

FrameSums order_and_speeds(const Snapshot& snapshot, BodyRange range) {
  FrameSums result;
  result.order = order_tensor(snapshot.axis, range.begin, range.end);
  result.S = largest_eigenvalue(result.order);
  result.v2 = mean_square(snapshot.velocity, range);
  result.w2 = mean_square(snapshot.angular_velocity, range);
  return result;
}

System part_of(const System& system, BodyRange range) {
  System part;
  part.species = system.species;
  part.bodies.assign(system.bodies.begin() + static_cast<std::ptrdiff_t>(range.begin),
                     system.bodies.begin() + static_cast<std::ptrdiff_t>(range.end));
  return part;
}

FrameSums temperatures(const KineticState& kinetic, const Freedoms& freedoms) {
  FrameSums result;
  result.translational_kT = 2 * kinetic.translational_energy / freedoms.translational;
  result.rotational_kT = 2 * kinetic.rotational_energy / freedoms.rotational;
  for (int k = 0; k < 3; ++k) {
    const bool free = freedoms.axis[k] > 0;
    result.axis_kT[k] = free ? 2 * kinetic.axis_energy[k] / freedoms.axis[k] : std::numeric_limits<double>::quiet_NaN();
  }
  return result;
}

Matrix3d kinetic_tensor(const System& system) {
  Matrix3d sum = Matrix3d::Zero();
  for (int i = 0; i < system.size(); ++i) {
    const Vector3d& v = system.bodies[static_cast<std::size_t>(i)].velocity;
    sum += system.species_of(i).mass * v * v.transpose();
  }
  // Bodies at rest have no directions to prefer.
  return sum.trace() > 0 ? Matrix3d(3 / sum.trace() * sum) : Matrix3d::Identity();
}

Matrix3d order_tensor(const std::vector<Vector3d>& axes, std::size_t begin, std::size_t end) {
  Matrix3d Q = Matrix3d::Zero();
  for (std::size_t i = begin; i < end; ++i) Q += 1.5 * axes[i] * axes[i].transpose();
  return Q / static_cast<double>(end - begin) - 0.5 * Matrix3d::Identity();
}

Matrix3d order_tensor(const std::vector<Vector3d>& axes, const std::vector<BodyRange>& ranges) {
  Matrix3d Q = Matrix3d::Zero();
  double number = 0;
  for (const BodyRange& range : ranges) {
    Q += range.size() * order_tensor(axes, range.begin, range.end);
    number += range.size();
  }
  return Q / number;
}

double largest_eigenvalue(const Matrix3d& Q) {
  return Eigen::SelfAdjointEigenSolver<Matrix3d>(Q, Eigen::EigenvaluesOnly).eigenvalues()[2];
}

Vector3d director_of(const Matrix3d& Q) {
  Vector3d n = Eigen::SelfAdjointEigenSolver<Matrix3d>(Q).eigenvectors().col(2);
  int largest = 0;
  n.cwiseAbs().maxCoeff(&largest);
  return n[largest] < 0 ? Vector3d(-n) : n;
}

Vector3d director_of(const Snapshot& snapshot) {
  return director_of(order_tensor(snapshot.axis, 0, snapshot.axis.size()));
}

}  // namespace ed::internal
