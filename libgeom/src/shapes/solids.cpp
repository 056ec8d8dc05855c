#include <geom/kernel/refuse.h>
#include <geom/polyhedron.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <numbers>
#include <string>

namespace geom {
namespace {

using Eigen::Vector3d;

constexpr double kRoot2 = std::numbers::sqrt2;
constexpr double kGolden = std::numbers::phi;

/// Points that follow from one by permutations of its coordinates and changes of their signs.
enum class Orbit {
  all,                ///< all permutations, all signs
  even,               ///< even permutations, all signs
  positive,           ///< all permutations, even numbers of minus signs
  snub_cube,          ///< even permutations with even numbers of plus signs, odd ones with odd numbers
  snub_dodecahedron,  ///< even permutations, even numbers of plus signs
};

/// Returns whether an orbit has the point whose coordinates are permuted and changed in sign like this.
bool has(Orbit orbit, bool is_odd, int minus_signs) {
  switch (orbit) {
    case Orbit::all:
      return true;
    case Orbit::even:
      return !is_odd;
    case Orbit::positive:
      return minus_signs % 2 == 0;
    case Orbit::snub_cube:
      return (minus_signs % 2 == 1) == !is_odd;
    case Orbit::snub_dodecahedron:
      return !is_odd && minus_signs % 2 == 1;
  }
  return false;
}

/// Adds the points of an orbit, each once.
void add(Orbit orbit, const Vector3d& x, std::vector<Vector3d>& points) {
  for (int permutation = 0; permutation < 6; ++permutation) {
    const bool is_odd = permutation >= 3;
    const int first = permutation % 3;
    const Vector3d p(x[first], x[(first + (is_odd ? 2 : 1)) % 3], x[(first + (is_odd ? 1 : 2)) % 3]);
    for (unsigned signs = 0; signs < 8; ++signs) {
      Vector3d q = p;
      int minus_signs = 0;
      for (int k = 0; k < 3; ++k) {
        if ((signs >> k & 1U) == 0) continue;
        q[k] = -q[k];
        ++minus_signs;
      }
      if (!has(orbit, is_odd, minus_signs)) continue;
      // A coordinate may be zero, and two of them may be equal.
      if (std::find(points.begin(), points.end(), q) == points.end()) points.push_back(q);
    }
  }
}

/// One orbit of a solid's vertices.
struct Vertices {
  Orbit orbit;
  Vector3d point;
};

using Orbits = std::vector<Vertices>;

Orbits snub_cube() {
  constexpr double t = 1.8392867552141612;  // t^3 = t^2 + t + 1
  return {{Orbit::snub_cube, {1, 1 / t, t}}};
}

Orbits snub_dodecahedron() {
  constexpr double xi = 1.7155614996973678;  // xi^3 - 2 xi = golden ratio
  const double g = kGolden;
  const double a = xi - 1 / xi;
  const double b = xi * g + g * g + g / xi;
  const auto orbit = [](double x, double y, double z) { return Vertices{Orbit::snub_dodecahedron, {x, y, z}}; };
  return {orbit(2 * a, 2, 2 * b), orbit(a + b / g + g, -a * g + b + 1 / g, a / g + b * g - 1),
          orbit(a + b / g - g, a * g - b + 1 / g, a / g + b * g + 1),
          orbit(-a / g + b * g + 1, -a + b / g - g, a * g + b - 1 / g),
          orbit(-a / g + b * g - 1, a - b / g - g, a * g + b + 1 / g)};
}

/// Name of a solid and its vertices, of any size.
struct Solid {
  std::string_view name;
  Orbits (*vertices)();
};

constexpr std::array kSolids = {
    Solid{"tetrahedron",
          [] {
            return Orbits{{Orbit::positive, {1, 1, 1}}};
          }},
    Solid{"cube",
          [] {
            return Orbits{{Orbit::all, {1, 1, 1}}};
          }},
    Solid{"octahedron",
          [] {
            return Orbits{{Orbit::all, {1, 0, 0}}};
          }},
    Solid{"dodecahedron",
          [] {
            return Orbits{{Orbit::all, {1, 1, 1}}, {Orbit::even, {0, 1 / kGolden, kGolden}}};
          }},
    Solid{"icosahedron",
          [] {
            return Orbits{{Orbit::even, {0, 1, kGolden}}};
          }},
    Solid{"truncated tetrahedron",
          [] {
            return Orbits{{Orbit::positive, {1, 1, 3}}};
          }},
    Solid{"cuboctahedron",
          [] {
            return Orbits{{Orbit::all, {1, 1, 0}}};
          }},
    Solid{"truncated cube",
          [] {
            return Orbits{{Orbit::all, {kRoot2 - 1, 1, 1}}};
          }},
    Solid{"truncated octahedron",
          [] {
            return Orbits{{Orbit::all, {0, 1, 2}}};
          }},
    Solid{"rhombicuboctahedron",
          [] {
            return Orbits{{Orbit::all, {1, 1, 1 + kRoot2}}};
          }},
    Solid{"truncated cuboctahedron",
          [] {
            return Orbits{{Orbit::all, {1, 1 + kRoot2, 1 + 2 * kRoot2}}};
          }},
    Solid{"snub cube", snub_cube},
    Solid{"icosidodecahedron",
          [] {
            const double g = kGolden;
            return Orbits{{Orbit::even, {0, 0, 2 * g}}, {Orbit::even, {1, g, g * g}}};
          }},
    Solid{"truncated dodecahedron",
          [] {
            const double g = kGolden;
            return Orbits{
                {Orbit::even, {0, 1 / g, 2 + g}}, {Orbit::even, {1 / g, g, 2 * g}}, {Orbit::even, {g, 2, g + 1}}};
          }},
    Solid{"truncated icosahedron",
          [] {
            const double g = kGolden;
            return Orbits{
                {Orbit::even, {0, 1, 3 * g}}, {Orbit::even, {1, 2 + g, 2 * g}}, {Orbit::even, {g, 2, 2 * g + 1}}};
          }},
    Solid{"rhombicosidodecahedron",
          [] {
            const double g = kGolden;
            return Orbits{
                {Orbit::even, {1, 1, g * g * g}}, {Orbit::even, {g * g, g, 2 * g}}, {Orbit::even, {2 + g, 0, g * g}}};
          }},
    Solid{"truncated icosidodecahedron",
          [] {
            const double g = kGolden;
            return Orbits{{Orbit::even, {1 / g, 1 / g, 3 + g}},
                          {Orbit::even, {2 / g, g, 1 + 2 * g}},
                          {Orbit::even, {1 / g, g * g, 3 * g - 1}},
                          {Orbit::even, {2 * g - 1, 2, 2 + g}},
                          {Orbit::even, {g, 3, 2 * g}}};
          }},
    Solid{"snub dodecahedron", snub_dodecahedron},
};

constexpr auto kSolidNames = [] {
  std::array<std::string_view, kSolids.size()> names;
  for (std::size_t k = 0; k < names.size(); ++k) names[k] = kSolids[k].name;
  return names;
}();

}  // namespace

std::span<const std::string_view> solid_names() {
  return kSolidNames;
}

std::vector<Vector3d> solid_vertices(std::string_view name) {
  std::string spaced(name);
  std::replace_if(
      spaced.begin(), spaced.end(), [](char c) { return c == '_' || c == '-'; }, ' ');
  const auto* solid = std::find_if(kSolids.begin(), kSolids.end(), [&](const Solid& s) { return s.name == spaced; });
  if (solid == kSolids.end()) {
    std::string accepted;
    for (const std::string_view known : kSolidNames) accepted += (accepted.empty() ? "" : ", ") + std::string(known);
    kernel::refuse("the name of a solid is \"" + std::string(name) + "\"; accepted: " + accepted);
  }
  std::vector<Vector3d> points;
  for (const Vertices& vertices : solid->vertices()) add(vertices.orbit, vertices.point, points);
  const double circumradius = points.front().norm();
  for (Vector3d& x : points) x /= circumradius;
  return points;
}

}  // namespace geom
