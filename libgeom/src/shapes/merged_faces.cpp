#include <geom/kernel/core.h>
#include <geom/polyhedron.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cstddef>
#include <map>
#include <numeric>
#include <utility>
#include <vector>

namespace geom {
namespace {

using Eigen::Vector3d;
using Outline = std::vector<int>;

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

/// Returns the numbers of the faces, from the largest area to the smallest.
std::vector<int> by_area(const kernel::Hull& hull) {
  const auto vertex = [&](int k) { return Vector3d(hull.vertices.row(k).transpose()); };
  std::vector<double> area;
  for (const Outline& outline : hull.faces) {
    Vector3d sum = Vector3d::Zero();
    const Vector3d origin = vertex(outline[0]);
    for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
      sum += (vertex(outline[i]) - origin).cross(vertex(outline[i + 1]) - origin);
    }
    area.push_back(sum.stableNorm());
  }
  std::vector<int> order(hull.faces.size());
  std::iota(order.begin(), order.end(), 0);
  std::stable_sort(order.begin(), order.end(), [&](int f, int g) { return area[at(f)] > area[at(g)]; });
  return order;
}

/// Returns for each face the number of the group that it belongs to. A group grows from its largest face, whose plane
/// all vertices of the others are close to: planes of slivers mean nothing.
std::vector<int> groups_of(const kernel::Hull& hull, double tolerance) {
  std::vector<std::vector<int>> neighbours(hull.faces.size());
  for (const kernel::HullEdge& edge : hull.edges) {
    neighbours[at(edge.left)].push_back(edge.right);
    neighbours[at(edge.right)].push_back(edge.left);
  }
  std::vector<int> group(hull.faces.size(), -1);
  for (const int seed : by_area(hull)) {
    if (group[at(seed)] != -1) continue;
    const auto is_near = [&](int f) {
      return std::all_of(hull.faces[at(f)].begin(), hull.faces[at(f)].end(), [&](int k) {
        return hull.offsets[at(seed)] - hull.vertices.row(k).dot(hull.normals[at(seed)]) <= tolerance;
      });
    };
    std::vector<int> open = {seed};
    group[at(seed)] = seed;
    while (!open.empty()) {
      const int f = open.back();
      open.pop_back();
      for (const int next : neighbours[at(f)]) {
        if (group[at(next)] != -1 || !is_near(next)) continue;
        group[at(next)] = seed;
        open.push_back(next);
      }
    }
  }
  return group;
}

/// Returns the outline of each group, by the number of its first face; empty where the edges around it are not one
/// loop.
std::map<int, Outline> outlines(const kernel::Hull& hull, const std::vector<int>& group) {
  std::map<int, std::map<int, int>> next;  // of each group: the vertex that follows another one
  std::map<int, std::size_t> edges;
  const auto add = [&](int face, int from, int to) {
    next[group[at(face)]][from] = to;
    ++edges[group[at(face)]];
  };
  for (const kernel::HullEdge& edge : hull.edges) {
    if (group[at(edge.left)] == group[at(edge.right)]) continue;
    add(edge.left, edge.from, edge.to);
    add(edge.right, edge.to, edge.from);
  }
  std::map<int, Outline> result;
  for (const auto& [face, follows] : next) {
    Outline& outline = result[face];
    int k = follows.begin()->first;
    do {
      outline.push_back(k);
      k = follows.at(k);
    } while (k != outline.front() && outline.size() <= follows.size());
    if (outline.size() != edges[face]) outline.clear();
  }
  return result;
}

/// Removes vertices at which fewer than three faces meet: they are within an edge.
void leave_out_vertices_of_edges(std::vector<Outline>& faces) {
  std::map<int, int> count;
  for (const Outline& outline : faces) {
    for (const int k : outline) ++count[k];
  }
  for (Outline& outline : faces) std::erase_if(outline, [&](int k) { return count[k] < 3; });
}

}  // namespace

std::vector<std::vector<int>> merged_faces(const ConvexPolyhedron& polyhedron) {
  const kernel::Hull& hull = *polyhedron.core().hull;
  const std::vector<int> group = groups_of(hull, kMergedFaces * polyhedron.bounding_radius());
  std::vector<Outline> result;
  for (auto& [first, outline] : outlines(hull, group)) {
    if (!outline.empty()) {
      result.push_back(std::move(outline));
      continue;
    }
    for (std::size_t f = 0; f < group.size(); ++f) {
      if (group[f] == first) result.push_back(hull.faces[f]);
    }
  }
  leave_out_vertices_of_edges(result);
  for (Outline& outline : result) {
    std::rotate(outline.begin(), std::min_element(outline.begin(), outline.end()), outline.end());
  }
  std::sort(result.begin(), result.end());
  return result;
}

}  // namespace geom
