#include "start_tiles.h"

#include "envelope_limits.h"
#include "start_parts.h"

#include <ed/shape.h>

#include <cmath>
#include <cstddef>
#include <utility>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

/// The most that may have to be taken out again, as a share of the bodies.
constexpr double kMostExcess = 0.02;

double number_of(const std::vector<Component>& components) {
  double number = 0;
  for (const Component& component : components) number += component.number;
  return number;
}

double volume_of(const std::vector<Component>& components) {
  double volume = 0;
  for (const Component& component : components) volume += component.number * ed::volume(component.species.shape);
  return volume;
}

Tiling tiling_along(const std::vector<Component>& components, double packing_fraction, int along) {
  const int tiles = along * along * along;
  Tiling tiling{along, components, packing_fraction};
  for (Component& component : tiling.tile) component.number = (component.number + tiles - 1) / tiles;
  tiling.packing_fraction *= tiles * volume_of(tiling.tile) / volume_of(components);
  return tiling;
}

bool sound(const Tiling& tiling, double number) {
  const int tiles = tiling.along * tiling.along * tiling.along;
  const double least_box = smallest_image_box(largest_radius(tiling.tile));
  return tiles * number_of(tiling.tile) <= (1 + kMostExcess) * number &&
         box_for(tiling.tile, tiling.packing_fraction) >= 1.05 * least_box;
}

/// `wanted` of them, each as likely as any other, in their order.
std::vector<Body> draw(const std::vector<Body>& bodies, int wanted, Random& random) {
  std::vector<Body> drawn;
  drawn.reserve(static_cast<std::size_t>(wanted));
  auto left = static_cast<double>(bodies.size());
  for (const Body& body : bodies) {
    const auto missing = static_cast<double>(wanted) - static_cast<double>(drawn.size());
    if (random.uniform() * left < missing) drawn.push_back(body);
    left -= 1;
  }
  return drawn;
}

}  // namespace

Tiling tiling_of(const std::vector<Component>& components, double packing_fraction, int most) {
  const double number = number_of(components);
  for (int along = static_cast<int>(std::ceil(std::cbrt(number / most))); along > 1; --along) {
    Tiling tiling = tiling_along(components, packing_fraction, along);
    if (sound(tiling, number)) return tiling;
  }
  return {1, components, packing_fraction};
}

System repeat(const System& tile, const Tiling& tiling, const std::vector<Component>& components, Random& random) {
  System system;
  system.species = tile.species;
  system.box = tiling.along * tile.box;
  system.bodies.reserve(static_cast<std::size_t>(number_of(components)));
  const Vector3d middle = Vector3d::Constant(0.5 * (tiling.along - 1));
  auto next = tile.bodies.begin();
  for (std::size_t k = 0; k < components.size(); ++k) {
    std::vector<Body> copies;
    const auto end = next + tiling.tile[k].number;
    for (int x = 0; x < tiling.along; ++x) {
      for (int y = 0; y < tiling.along; ++y) {
        for (int z = 0; z < tiling.along; ++z) {
          for (auto body = next; body != end; ++body) {
            copies.push_back(*body);
            copies.back().position += tile.box * (Vector3d(x, y, z) - middle);
          }
        }
      }
    }
    next = end;
    const std::vector<Body> drawn = draw(copies, components[k].number, random);
    system.bodies.insert(system.bodies.end(), drawn.begin(), drawn.end());
  }
  return system;
}

}  // namespace ed::internal
