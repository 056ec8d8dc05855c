#include "start/tiles.h"

#include "neighbours/limits.h"
#include "start/parts.h"

#include <ed/shape.h>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>
#include <variant>

namespace ed::internal {
namespace {

using Eigen::Vector3d;

/// Largest excess that may have to be removed, relative to the number of bodies and to their volume.
constexpr double kMostExcess = 0.02;

/// Maximum number of shapes of which bodies have individual sizes.
constexpr std::size_t kMostShapes = 64;

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

/// Relative difference of lengths that are equal except for rounding.
constexpr double kRounding = 1e-14;

/// Returns whether the second shape is the first, or the first shrunk about its centre.
bool is_smaller_copy(const BodyShape& large, const BodyShape& small) {
  const auto of_one_form = [&](const auto& a) {
    const auto* b = std::get_if<std::decay_t<decltype(a)>>(&small);
    if (b == nullptr) return false;
    if constexpr (requires { a.e1(); }) return a.e1() == b->e1() && a.e2() == b->e2();
    return requires {
      a.scaled(1.0);
    };
  };
  if (!std::visit(of_one_form, large)) return false;
  const Vector3d ratio = half_extents(small).cwiseQuotient(half_extents(large));
  return ratio.maxCoeff() <= 1 + kRounding && ratio.minCoeff() >= ratio.maxCoeff() * (1 - kRounding);
}

/// Returns the components that have fewer bodies than there are tiles, in groups of one shape, the largest body first.
std::vector<std::vector<int>> groups_by_size(const std::vector<Component>& components, int tiles) {
  std::vector<std::pair<double, int>> few;
  for (std::size_t k = 0; k < components.size(); ++k) {
    if (components[k].number < tiles) few.emplace_back(-volume(components[k].species.shape), static_cast<int>(k));
  }
  std::sort(few.begin(), few.end());
  const auto shape = [&](int k) -> const BodyShape& { return components[static_cast<std::size_t>(k)].species.shape; };
  std::vector<std::vector<int>> groups;
  for (const auto& [size, of_size] : few) {
    const int k = of_size;
    const auto of_its_shape = [&](const auto& group) { return is_smaller_copy(shape(group.front()), shape(k)); };
    auto group = std::find_if(groups.begin(), groups.end(), of_its_shape);
    if (group == groups.end()) {
      if (groups.size() == kMostShapes) return {};
      group = groups.emplace(groups.end());
    }
    group->insert(group->end(), static_cast<std::size_t>(components[static_cast<std::size_t>(k)].number), k);
  }
  return groups;
}

void add(Tiling& tiling, const Species& species, int number, Copies copies) {
  tiling.tile.push_back({species, number});
  tiling.copies.push_back(std::move(copies));
}

Tiling tiling_along(const std::vector<Component>& components, double packing_fraction, int along) {
  const int tiles = along * along * along;
  Tiling tiling{along, {}, {}, packing_fraction};
  for (std::size_t k = 0; k < components.size(); ++k) {
    const auto& [species, number] = components[k];
    if (number >= tiles) add(tiling, species, (number + tiles - 1) / tiles, {number, {static_cast<int>(k)}});
  }
  for (const std::vector<int>& group : groups_by_size(components, tiles)) {
    for (std::size_t i = 0; i < group.size(); i += static_cast<std::size_t>(tiles)) {
      const std::size_t end = std::min(group.size(), i + static_cast<std::size_t>(tiles));
      const auto at = [&](std::size_t k) { return group.begin() + static_cast<std::ptrdiff_t>(k); };
      add(tiling, components[static_cast<std::size_t>(group[i])].species, 1,
          {static_cast<int>(end - i), std::vector<int>(at(i), at(end))});
    }
  }
  tiling.packing_fraction *= tiles * volume_of(tiling.tile) / volume_of(components);
  return tiling;
}

bool sound(const Tiling& tiling, const std::vector<Component>& components) {
  const int tiles = tiling.along * tiling.along * tiling.along;
  int wanted = 0;
  for (const Copies& copies : tiling.copies) wanted += copies.wanted;
  const double number = number_of(components);
  const double least_box = smallest_image_box(largest_radius(tiling.tile));
  return wanted == number && tiles * number_of(tiling.tile) <= (1 + kMostExcess) * number &&
         tiles * volume_of(tiling.tile) <= (1 + kMostExcess) * volume_of(components) &&
         box_for(tiling.tile, tiling.packing_fraction) >= 1.05 * least_box;
}

/// Returns `wanted` of the bodies, each equally likely, in their order.
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

/// Makes each body one of the component, or of one of the components, in random order.
void assign(std::vector<Body>& bodies, std::vector<int> components, Random& random) {
  if (components.size() == 1) {
    components.resize(bodies.size(), components.front());
  } else {
    for (std::size_t i = components.size(); i > 1; --i) std::swap(components[i - 1], components[random.bits() % i]);
  }
  for (std::size_t i = 0; i < bodies.size(); ++i) bodies[i].species = components[i];
}

}  // namespace

Tiling tiling_of(const std::vector<Component>& components, double packing_fraction, int most) {
  const double number = number_of(components);
  for (int along = static_cast<int>(std::ceil(std::cbrt(number / most))); along > 1; --along) {
    Tiling tiling = tiling_along(components, packing_fraction, along);
    if (sound(tiling, components)) return tiling;
  }
  return {1, components, {}, packing_fraction};
}

System repeat(const System& tile, const Tiling& tiling, const std::vector<Component>& components, Random& random) {
  System system;
  for (const Component& component : components) system.species.push_back(component.species);
  system.box = tiling.along * tile.box;
  system.bodies.reserve(static_cast<std::size_t>(number_of(components)));
  const Vector3d middle = Vector3d::Constant(0.5 * (tiling.along - 1));
  auto next = tile.bodies.begin();
  for (std::size_t k = 0; k < tiling.tile.size(); ++k) {
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
    std::vector<Body> drawn = draw(copies, tiling.copies[k].wanted, random);
    assign(drawn, tiling.copies[k].components, random);
    system.bodies.insert(system.bodies.end(), drawn.begin(), drawn.end());
  }
  std::stable_sort(system.bodies.begin(), system.bodies.end(),
                   [](const Body& a, const Body& b) { return a.species < b.species; });
  return system;
}

}  // namespace ed::internal
