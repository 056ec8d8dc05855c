#include "shapes/hull.h"

#include "shapes/exact_side.h"
#include "shapes/format.h"

#include <geom/kernel/refuse.h>
#include <geom/tolerances.h>

#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <map>
#include <numeric>
#include <set>
#include <string>
#include <utility>
#include <vector>

namespace geom::kernel {
namespace {

using Eigen::Vector3d;
using DirectedEdge = std::pair<int, int>;
using Triangle = std::array<int, 3>;

std::size_t at(int k) {
  return static_cast<std::size_t>(k);
}

/// Multiplies a point by 2^-exponent, for exact_side.
void scale_down(Vector3d& p, int exponent) {
  for (double& x : p) {
    x = std::ldexp(x, -exponent);
    if (std::abs(x) < 0x1p-200) x = 0;
  }
}

/// Returns the points scaled by a power of two to coordinates of at most 1. Throws for bad ones.
std::vector<Vector3d> scaled_points(std::span<const Vector3d> points) {
  if (points.size() < 4) {
    refuse("ConvexPolyhedron: " + std::to_string(points.size()) + " points; accepted: at least 4");
  }
  double largest = 0;
  for (std::size_t k = 0; k < points.size(); ++k) {
    for (int i = 0; i < 3; ++i) {
      const double x = points[k][i];
      if (!(std::abs(x) <= kMaxSemiAxis)) {
        refuse("ConvexPolyhedron: coordinate " + std::string(1, "xyz"[i]) + " of point " + std::to_string(k) + " is " +
               shown(x) + "; accepted: magnitudes up to " + shown(kMaxSemiAxis));
      }
      largest = std::max(largest, std::abs(x));
    }
  }
  int exponent = 0;
  std::frexp(largest, &exponent);
  std::vector<Vector3d> scaled(points.begin(), points.end());
  for (Vector3d& p : scaled) scale_down(p, exponent);
  return scaled;
}

/// Convex hull of points that are added one by one, with triangles as faces, all decisions exact.
class Triangulation {
 public:
  explicit Triangulation(std::span<const Vector3d> points) : p_(points) {}

  void build() {
    const std::array<int, 4> first = simplex();
    const auto& [a, b, c, d] = first;
    add({a, b, c});
    add({a, c, d});
    add({a, d, b});
    add({b, d, c});
    for (int k = 0; k < static_cast<int>(p_.size()); ++k) {
      if (std::find(first.begin(), first.end(), k) == first.end()) insert(k);
    }
  }

  const std::vector<Triangle>& triangles() const { return triangles_; }
  int side(const Triangle& t, int k) const { return exact_side(p_[at(t[0])], p_[at(t[1])], p_[at(t[2])], p_[at(k)]); }

 private:
  /// Returns four points that span a volume, ordered so that the fourth is below the triangle of the first three.
  std::array<int, 4> simplex() const {
    const auto furthest = [this](const auto& measure) {
      int best = 0;
      for (int k = 1; k < static_cast<int>(p_.size()); ++k) {
        if (measure(p_[at(k)]) > measure(p_[at(best)])) best = k;
      }
      return best;
    };
    const int a = furthest([](const Vector3d& x) { return x.squaredNorm(); });
    const int b = furthest([&](const Vector3d& x) { return (x - p_[at(a)]).squaredNorm(); });
    const Vector3d ab = p_[at(b)] - p_[at(a)];
    const int c = furthest([&](const Vector3d& x) { return ab.cross(x - p_[at(a)]).squaredNorm(); });
    const Vector3d normal = ab.cross(p_[at(c)] - p_[at(a)]);
    const int d = furthest([&](const Vector3d& x) { return std::abs(normal.dot(x - p_[at(a)])); });
    const int where = side({a, b, c}, d);
    if (where == 0) {
      refuse("ConvexPolyhedron: the " + std::to_string(p_.size()) +
             " points lie in a plane; accepted: points that span a volume");
    }
    return where < 0 ? std::array<int, 4>{a, b, c, d} : std::array<int, 4>{a, c, b, d};
  }

  void add(const Triangle& t) { triangles_.push_back(t); }

  /// Replaces the triangles that point k sees from outside by those of k and their outline.
  ///
  /// Triangles whose plane contains the point are not seen: the faces that are seen, whole faces, make up a disc, whose
  /// outline no plane of an edge and the point is degenerate at.
  void insert(int k) {
    std::vector<Triangle> seen;
    std::vector<Triangle> kept;
    for (const Triangle& t : triangles_) (side(t, k) > 0 ? seen : kept).push_back(t);
    if (seen.empty()) return;
    std::set<DirectedEdge> edges;
    for (const Triangle& t : seen) {
      for (std::size_t i = 0; i < 3; ++i) edges.insert({t[i], t[(i + 1) % 3]});
    }
    triangles_ = std::move(kept);
    for (const auto& [from, to] : edges) {
      if (!edges.contains({to, from})) add({from, to, k});
    }
  }

  std::span<const Vector3d> p_;
  std::vector<Triangle> triangles_;
};

/// Triangles joined to faces where they are in one plane.
class Faces {
 public:
  explicit Faces(const Triangulation& hull) : triangles_(hull.triangles()), face_(triangles_.size()) {
    std::iota(face_.begin(), face_.end(), 0);
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      for (std::size_t i = 0; i < 3; ++i) owner_[{triangles_[at(t)][i], triangles_[at(t)][(i + 1) % 3]}] = t;
    }
    for (const auto& [edge, t] : owner_) {
      const int other = owner_.at({edge.second, edge.first});
      for (const int k : triangles_[at(other)]) {
        if (k != edge.first && k != edge.second && hull.side(triangles_[at(t)], k) == 0) join(t, other);
      }
    }
  }

  /// Returns the points at which at least three faces meet, in order.
  std::vector<int> vertices() const {
    std::map<int, std::set<int>> around;
    for (int t = 0; t < static_cast<int>(triangles_.size()); ++t) {
      for (const int k : triangles_[at(t)]) around[k].insert(root(t));
    }
    std::vector<int> result;
    for (const auto& [k, faces] : around) {
      if (faces.size() >= 3) result.push_back(k);
    }
    return result;
  }

  /// Returns the outlines of the faces; a point within an edge is left out by `number` (-1), the others are renumbered.
  std::vector<std::vector<int>> outlines(const std::map<int, int>& number) const {
    std::map<int, std::map<int, int>> next;  // of each face: the point that follows another one
    for (const auto& [edge, t] : owner_) {
      if (root(t) != root(owner_.at({edge.second, edge.first}))) next[root(t)][edge.first] = edge.second;
    }
    std::vector<std::vector<int>> result;
    for (const auto& [face, follows] : next) {
      std::vector<int> outline;
      int k = follows.begin()->first;
      do {
        if (const auto found = number.find(k); found != number.end()) outline.push_back(found->second);
        k = follows.at(k);
      } while (k != follows.begin()->first);
      result.push_back(std::move(outline));
    }
    return result;
  }

 private:
  int root(int t) const {
    while (face_[at(t)] != t) t = face_[at(t)];
    return t;
  }
  void join(int s, int t) {
    const int a = root(s);
    const int b = root(t);
    face_[at(std::max(a, b))] = std::min(a, b);
  }

  const std::vector<Triangle>& triangles_;
  std::vector<int> face_;
  std::map<DirectedEdge, int> owner_;  // triangle on the left of each edge
};

/// Puts faces into an order that the vertices alone determine: a hull that is made of the vertices of another one is
/// the same to the last bit.
void put_in_order(std::vector<std::vector<int>>& faces) {
  for (std::vector<int>& outline : faces) {
    std::rotate(outline.begin(), std::min_element(outline.begin(), outline.end()), outline.end());
  }
  std::sort(faces.begin(), faces.end());
}

void set_edges(Hull& hull) {
  std::map<DirectedEdge, int> left;
  for (int f = 0; f < static_cast<int>(hull.faces.size()); ++f) {
    const std::vector<int>& outline = hull.faces[at(f)];
    for (std::size_t i = 0; i < outline.size(); ++i) left[{outline[i], outline[(i + 1) % outline.size()]}] = f;
  }
  for (const auto& [edge, f] : left) {
    if (edge.first < edge.second) {
      hull.edges.push_back({edge.first, edge.second, f, left.at({edge.second, edge.first})});
    }
  }
}

Vector3d vertex(const Hull& hull, int k) {
  return hull.vertices.row(k).transpose();
}

/// Twice the area of a face, along its normal.
struct FaceArea {
  Vector3d sum = Vector3d::Zero();
  double scale = 0;  ///< sum of the products of lengths that rounding errors of the sum are relative to

  FaceArea(const Hull& hull, const std::vector<int>& outline) {
    const Vector3d origin = vertex(hull, outline[0]);
    for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
      const Vector3d u = vertex(hull, outline[i]) - origin;
      const Vector3d v = vertex(hull, outline[i + 1]) - origin;
      sum += u.cross(v);
      scale += u.stableNorm() * v.stableNorm();
    }
  }
  /// Returns whether rounding may turn the normal by more than some 1e-15.
  bool is_narrow() const { return !(sum.stableNorm() > kNarrow * scale); }

 private:
  static constexpr double kNarrow = 0.25;
};

/// Returns the same area in other units, accurate to rounding. Points that are in a line but for rounding are the
/// corners of faces, too.
Vector3d accurate_area(const Hull& hull, const std::vector<int>& outline) {
  int exponent = 0;
  std::frexp(hull.vertices.cwiseAbs().maxCoeff(), &exponent);
  const auto corner = [&](std::size_t i) {
    Vector3d p = vertex(hull, outline[i]);
    scale_down(p, exponent);
    return p;
  };
  Vector3d sum = Vector3d::Zero();
  for (std::size_t i = 1; i + 1 < outline.size(); ++i) sum += accurate_normal(corner(0), corner(i), corner(i + 1));
  return sum;
}

}  // namespace

void set_planes(Hull& hull, const Hull* exact) {
  hull.normals.clear();
  hull.offsets.clear();
  for (std::size_t f = 0; f < hull.faces.size(); ++f) {
    const FaceArea area(hull, hull.faces[f]);
    const bool narrow = area.is_narrow();
    const Vector3d normal = !narrow            ? area.sum
                            : exact != nullptr ? exact->normals[f]
                                               : accurate_area(hull, hull.faces[f]);
    hull.normals.push_back(normal.stableNormalized());
    hull.offsets.push_back((hull.vertices * hull.normals.back()).maxCoeff());
  }
}

Hull convex_hull(std::span<const Vector3d> points) {
  const std::vector<Vector3d> scaled = scaled_points(points);
  Triangulation triangulation(scaled);
  triangulation.build();
  const Faces faces(triangulation);
  const std::vector<int> vertices = faces.vertices();
  Hull hull;
  hull.vertices.resize(static_cast<Eigen::Index>(vertices.size()), 3);
  std::map<int, int> number;
  for (int k = 0; k < static_cast<int>(vertices.size()); ++k) {
    hull.vertices.row(k) = points[at(vertices[at(k)])].transpose();
    number[vertices[at(k)]] = k;
  }
  hull.faces = faces.outlines(number);
  put_in_order(hull.faces);
  set_edges(hull);
  set_planes(hull);
  return hull;
}

HullMoments moments(const Hull& hull) {
  HullMoments result;
  Vector3d first = Vector3d::Zero();
  Eigen::Matrix3d second = Eigen::Matrix3d::Zero();
  for (const std::vector<int>& outline : hull.faces) {
    const Vector3d a = hull.vertices.row(outline[0]).transpose();
    for (std::size_t i = 1; i + 1 < outline.size(); ++i) {
      const Vector3d b = hull.vertices.row(outline[i]).transpose();
      const Vector3d c = hull.vertices.row(outline[i + 1]).transpose();
      // The tetrahedron of the origin and a triangle, with its sign.
      const double six_volumes = a.dot(b.cross(c));
      const Vector3d sum = a + b + c;
      result.volume += six_volumes / 6;
      first += six_volumes / 24 * sum;
      second += six_volumes / 120 * (sum * sum.transpose() + a * a.transpose() + b * b.transpose() + c * c.transpose());
    }
  }
  result.centre = first / result.volume;
  result.second_moment = second / result.volume;
  return result;
}

}  // namespace geom::kernel
