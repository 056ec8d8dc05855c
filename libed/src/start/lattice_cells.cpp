#include "start/lattice_cells.h"

#include "start/parts.h"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace ed::internal {

using Eigen::Vector3d;
using Eigen::Vector3i;

namespace {

bool overlap(const Turned& a, const Turned& b, const Vector3d& apart) {
  return overlaps(*a.shape, geom::Pose(a.rotation, Vector3d::Zero()), *b.shape, geom::Pose(b.rotation, apart));
}

std::vector<int> divisors(int number) {
  std::vector<int> result;
  for (int d = 1; d <= number / d; ++d) {
    if (number % d != 0) continue;
    result.push_back(d);
    if (d != number / d) result.push_back(number / d);
  }
  return result;
}

}  // namespace

int sites_in_cell(Lattice lattice) {
  return lattice == Lattice::fcc ? 4 : 1;
}

bool is_site(Lattice lattice, const Vector3i& p) {
  if (lattice == Lattice::fcc) return p.sum() % 2 == 0;
  return p.x() % 2 == 0 && p.y() % 2 == 0 && p.z() % 2 == 0;
}

Vector3d in_box(const Vector3i& p, const Vector3i& cells) {
  return 0.5 * p.cast<double>().cwiseQuotient(cells.cast<double>());
}

std::vector<Vector3i> near_vectors(Lattice lattice, const Vector3i& cells, const Vector3d& reach) {
  const Vector3i most = (2 * reach.cwiseProduct(cells.cast<double>())).array().ceil().cast<int>();
  std::vector<Vector3i> result;
  for (int z = 0; z <= most.z(); ++z) {
    for (int y = -most.y(); y <= most.y(); ++y) {
      for (int x = -most.x(); x <= most.x(); ++x) {
        const Vector3i p(x, y, z);
        const bool upper = z > 0 || (z == 0 && (y > 0 || (y == 0 && x > 0)));
        if (upper && is_site(lattice, p)) result.push_back(p);
      }
    }
  }
  std::stable_sort(result.begin(), result.end(), [&](const Vector3i& a, const Vector3i& b) {
    return in_box(a, cells).squaredNorm() < in_box(b, cells).squaredNorm();
  });
  return result;
}

Vector3d reach_of(const std::vector<Turned>& bodies) {
  Vector3d up = Vector3d::Zero();
  Vector3d down = Vector3d::Zero();
  for (const Turned& body : bodies) {
    for (int k = 0; k < 3; ++k) {
      up[k] = std::max(up[k], body.height(Vector3d::Unit(k)));
      down[k] = std::max(down[k], body.height(-Vector3d::Unit(k)));
    }
  }
  return up + down;
}

double free_box(double box, const Turned& a, const Turned& b, const Vector3d& v) {
  const auto blocked = [&](double edge) { return overlap(a, b, edge * v); };
  if (!blocked(box)) return box;
  double large = (bounding_radius(*a.shape) + bounding_radius(*b.shape)) / v.norm() * (1 + 1e-9);
  double small = box;
  while (large - small > 1e-13 * large) {
    const double middle = 0.5 * (small + large);
    (blocked(middle) ? small : large) = middle;
  }
  return large;
}

double free_box(double box, Lattice lattice, const Vector3i& cells, const Turned& body) {
  for (const Vector3i& p : near_vectors(lattice, cells, reach_of({body}) / box)) {
    box = free_box(box, body, body, in_box(p, cells));
  }
  return box;
}

double shortest_vector(Lattice lattice, const Vector3i& cells, const Vector3d& extents) {
  const Vector3d edge = cells.cast<double>().cwiseProduct(extents).cwiseInverse();
  if (lattice == Lattice::simple_cubic) return edge.minCoeff();
  const double diagonal = std::sqrt(edge.squaredNorm() - edge.maxCoeff() * edge.maxCoeff());
  return std::min(edge.minCoeff(), 0.5 * diagonal);
}

double least_box(Lattice lattice, const Vector3i& cells, const Turned& body) {
  constexpr double kRounding = 1e-9;
  return (1 - kRounding) * 2 * inscribed_radius(*body.shape) / shortest_vector(lattice, cells, Vector3d::Ones());
}

bool fits(double box, Lattice lattice, const Vector3i& cells, const Turned& body) {
  if (box < least_box(lattice, cells, body)) return false;
  const std::vector<Vector3i> vectors = near_vectors(lattice, cells, reach_of({body}) / box);
  return std::none_of(vectors.begin(), vectors.end(),
                      [&](const Vector3i& p) { return overlap(body, body, box * in_box(p, cells)); });
}

std::vector<Vector3i> ways_to_fill(Lattice lattice, int cells, const Vector3d& extents, std::size_t most) {
  std::vector<std::pair<double, Vector3i>> ways;
  for (const int x : divisors(cells)) {
    for (const int y : divisors(cells / x)) {
      const Vector3i way(x, y, cells / x / y);
      ways.emplace_back(shortest_vector(lattice, way, extents), way);
    }
  }
  const auto last = ways.begin() + static_cast<std::ptrdiff_t>(std::min(most, ways.size()));
  std::partial_sort(ways.begin(), last, ways.end(), [](const auto& a, const auto& b) {
    if (a.first != b.first) return a.first > b.first;
    return std::lexicographical_compare(a.second.begin(), a.second.end(), b.second.begin(), b.second.end());
  });
  std::vector<Vector3i> result;
  for (auto way = ways.begin(); way != last; ++way) result.push_back(way->second);
  return result;
}

}  // namespace ed::internal
