#include "start/parts.h"

#include "neighbours/limits.h"

#include <geom/kernel/any_body.h>
#include <geom/queries.h>
#include <geom/tolerances.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <iomanip>
#include <sstream>
#include <stdexcept>
#include <string>
#include <utility>

namespace ed {
namespace {

using Eigen::Vector3d;

/// Number of bodies from which on their order in memory matters, because the nearest caches do not hold them.
constexpr int kOrderedFrom = 4000;

/// Returns the position of a point of the box on a Z-order curve (Morton): the bits of its coordinates interleaved.
std::uint64_t place_on_curve(const Vector3d& position, double box) {
  constexpr int kBits = 21;
  std::uint64_t place = 0;
  for (int axis = 0; axis < 3; ++axis) {
    const double share = position[axis] / box - std::floor(position[axis] / box);
    const auto coordinate = static_cast<std::uint64_t>(share * ((1 << kBits) - 1));
    for (int bit = 0; bit < kBits; ++bit) place |= ((coordinate >> bit) & 1) << (3 * bit + axis);
  }
  return place;
}

}  // namespace

namespace internal {

bool overlaps(const BodyShape& a, const geom::Pose& X_a, const BodyShape& b, const geom::Pose& X_b) {
  return geom::kernel::with_bodies(
      a, b, [&](const auto& A, const auto& B) { return geom::overlap(A, X_a, B, X_b) != geom::Answer::no; });
}

double largest_radius(const std::vector<Component>& components) {
  double largest = 0;
  for (const Component& component : components) largest = std::max(largest, bounding_radius(component.species.shape));
  return largest;
}

void check_components(const std::vector<Component>& components) {
  if (components.empty()) throw std::invalid_argument("species: none; accepted: one or more");
  for (std::size_t k = 0; k < components.size(); ++k) {
    check_species(components[k].species);
    if (components[k].number >= 1) continue;
    throw std::invalid_argument("number of bodies of species " + std::to_string(k + 1) + " is " +
                                std::to_string(components[k].number) + "; accepted: at least 1");
  }
}

void check_target(const std::vector<Component>& components, double box) {
  const double radius = largest_radius(components);
  if (!(box <= geom::kMaxCoordinate)) {
    std::ostringstream message;
    message << "packing_fraction: a box of edge " << box << " has no coordinates; accepted: one of at most "
            << geom::kMaxCoordinate;
    throw std::invalid_argument(message.str());
  }
  if (box >= smallest_image_box(radius) * (1 - 1e-12)) return;
  const double share = box / smallest_image_box(radius);
  double number = 0;
  for (const Component& component : components) number += component.number;
  std::ostringstream message;
  message << "number: a box of edge " << box << " at this packing fraction is too small for bodies of bounding radius "
          << radius << " (a body could meet two images of another); accepted: at least " << std::fixed
          << std::setprecision(0) << std::ceil(number / (share * share * share) * (1 - 1e-12)) << " bodies";
  throw std::invalid_argument(message.str());
}

System bodies_of(const std::vector<Component>& components) {
  System system;
  for (std::size_t k = 0; k < components.size(); ++k) {
    system.species.push_back(components[k].species);
    Body body;
    body.species = static_cast<int>(k);
    system.bodies.insert(system.bodies.end(), static_cast<std::size_t>(components[k].number), body);
  }
  return system;
}

void number_along_curve(System& system) {
  if (system.size() < kOrderedFrom) return;
  std::vector<std::pair<std::uint64_t, Body>> placed;
  placed.reserve(system.bodies.size());
  for (const Body& body : system.bodies) placed.emplace_back(place_on_curve(body.position, system.box), body);
  std::stable_sort(placed.begin(), placed.end(), [](const auto& a, const auto& b) {
    return std::pair(a.second.species, a.first) < std::pair(b.second.species, b.first);
  });
  for (std::size_t i = 0; i < placed.size(); ++i) system.bodies[i] = placed[i].second;
}

}  // namespace internal
}  // namespace ed
