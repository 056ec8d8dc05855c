#include "observables/order/hexatic.h"

#include "observables/order/bonds.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <numbers>

namespace ed::internal {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

/// Part of the vectors to neighbours that is across the director.
using FlatBonds = std::vector<Vector2d>;

/// Bodies near a body along an axis: a layer across it.
class Layer {
 public:
  Layer(const Vector3d& director, double reach) : n_(director), reach_(reach) {
    int least = 0;
    director.cwiseAbs().minCoeff(&least);
    e1_ = director.cross(Vector3d::Unit(least)).normalized();
    e2_ = director.cross(e1_);
  }

  /// Returns the parts across the axis of the shortest bonds in the layer, the shortest first.
  FlatBonds flat(const Bonds& bonds) const {
    FlatBonds flat;
    for (const Vector3d& r : bonds) {
      if (std::abs(r.dot(n_)) <= reach_) flat.emplace_back(r.dot(e1_), r.dot(e2_));
    }
    keep_shortest(flat, kLayerNeighbours);
    return flat;
  }

 private:
  Vector3d n_, e1_, e2_;
  double reach_;
};

/// Bonds by linked cells. Those of bodies are empty that have fewer than all within the distance `disc` across the
/// axis.
std::vector<FlatBonds> bonds_in_discs(const std::vector<Vector3d>& positions, double box, const Layer& layer,
                                      double reach, double disc) {
  std::vector<FlatBonds> all;
  all.reserve(positions.size());
  for (const Bonds& near : bonds_within(positions, box, std::hypot(reach, disc))) {
    FlatBonds& own = all.emplace_back(layer.flat(near));
    if (own.size() < kLayerNeighbours || own.back().squaredNorm() > disc * disc) own.clear();
  }
  return all;
}

/// Bonds of each body to its neighbours in a layer.
std::vector<FlatBonds> bonds_in_layers(const std::vector<Vector3d>& positions, double box, const Layer& layer,
                                       double reach) {
  std::vector<FlatBonds> all(positions.size());
  const double per_area = static_cast<double>(positions.size()) * 2 * reach / (box * box * box);
  double disc = kFirstReach * std::sqrt((kLayerNeighbours + 1) / (std::numbers::pi * per_area));
  while (positions.size() > kFewForCells && std::hypot(reach, disc) < box / 4) {
    all = bonds_in_discs(positions, box, layer, reach, disc);
    if (std::none_of(all.begin(), all.end(), [](const FlatBonds& b) { return b.empty(); })) return all;
    disc *= kLargerReach;
  }
  for (std::size_t i = 0; i < all.size(); ++i) {
    if (all[i].empty()) all[i] = layer.flat(all_bonds(positions, box, i));
  }
  return all;
}

/// Mean of exp(6 i theta) over bonds, as a vector (real, imaginary); 0 without bonds. A bond of no length adds nothing.
Vector2d psi6(const FlatBonds& bonds) {
  Vector2d sum = Vector2d::Zero();
  for (const Vector2d& b : bonds) {
    const double square = b.squaredNorm();
    if (!(square > 0)) continue;
    const double c = (b.x() * b.x() - b.y() * b.y()) / square;  // of twice the angle
    const double s = 2 * b.x() * b.y() / square;
    sum += Vector2d(c * (4 * c * c - 3), s * (3 - 4 * s * s));
  }
  return bonds.empty() ? sum : Vector2d(sum / static_cast<double>(bonds.size()));
}

}  // namespace

HexaticOrder& HexaticOrder::operator+=(const HexaticOrder& other) {
  coherent += other.coherent;
  local += other.local;
  return *this;
}

HexaticOrder hexatic_order(const std::vector<Vector3d>& positions, double box, const Vector3d& director, double reach) {
  HexaticOrder order;
  if (positions.empty()) return order;
  const auto number = static_cast<double>(positions.size());
  Vector2d mean = Vector2d::Zero();
  for (const FlatBonds& bonds : bonds_in_layers(positions, box, Layer(director, reach), reach)) {
    const Vector2d own = psi6(bonds);
    mean += own / number;
    order.local += own.norm() / number;
  }
  order.coherent = mean.norm();
  return order;
}

std::vector<Vector3d> oriented_positions(const std::vector<Vector3d>& positions, const std::vector<BodyRange>& ranges) {
  std::vector<Vector3d> oriented;
  for (const BodyRange& range : ranges) {
    for (std::size_t i = range.begin; range.oriented && i < range.end; ++i) oriented.push_back(positions[i]);
  }
  return oriented;
}

double axial_length(const System& system, const std::vector<BodyRange>& ranges) {
  double sum = 0;
  double number = 0;
  for (const BodyRange& range : ranges) {
    for (std::size_t i = range.begin; range.oriented && i < range.end; ++i) {
      const Species& species = system.species_of(static_cast<int>(i));
      sum += 2 * half_extents(species.shape)[symmetry_axis(species).value_or(2)];
      number += 1;
    }
  }
  return number > 0 ? sum / number : 0;
}

}  // namespace ed::internal
