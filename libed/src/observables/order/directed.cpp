#include "observables/order/directed.h"

namespace ed::internal {

using Eigen::Vector3d;

void DirectedSums::add(const DirectedSums& other, double weight) {
  along2 += weight * other.along2;
  along4 += weight * other.along4;
  across4 += weight * other.across4;
  edge2 += weight * other.edge2;
  edge4 += weight * other.edge4;
}

DirectedSums directed_sums(const Snapshot& a, const Snapshot& b, std::size_t begin, std::size_t end,
                           const Vector3d& director) {
  double along2_sum = 0, along4_sum = 0, across4_sum = 0;  // else every sum goes through memory
  Vector3d edge2 = Vector3d::Zero(), edge4 = Vector3d::Zero();
  for (std::size_t i = begin; i < end; ++i) {
    const Vector3d moved = b.position[i] - a.position[i];
    const Vector3d squares = moved.cwiseAbs2();
    const double along = moved.dot(director);
    const double along2 = along * along;
    const double across2 = squares.sum() - along2;
    along2_sum += along2;
    along4_sum += along2 * along2;
    across4_sum += across2 * across2;
    edge2 += squares;
    edge4 += squares.cwiseAbs2();
  }
  return {along2_sum, along4_sum, across4_sum, edge2, edge4};
}

}  // namespace ed::internal
