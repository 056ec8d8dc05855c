#pragma once

/// Point of a simplex that is closest to the origin, with a direction that is exact where the point is.

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>

namespace geom::kernel {

/// Point of the difference B - A, and the vertices that it comes from.
struct DifferenceVertex {
  Eigen::Vector3d p, a, b;
  int id_a = 0, id_b = 0;
};

/// Hull of up to four points of the difference, and after reduce_to_closest() the weights of the closest point of their
/// hull.
struct CoreSimplex {
  std::array<DifferenceVertex, 4> vertex;
  std::array<double, 4> weight{};
  std::size_t count = 0;
  Eigen::Vector3d closest = Eigen::Vector3d::Zero();
  double squared = std::numeric_limits<double>::infinity();  ///< |closest|^2
  bool inside = false;                                       ///< four points around the origin

  bool has(const DifferenceVertex& v) const {
    for (std::size_t k = 0; k < count; ++k) {
      if (vertex[k].id_a == v.id_a && vertex[k].id_b == v.id_b) return true;
    }
    return false;
  }
};

/// Tries the faces of a simplex for the one that is closest to the origin.
///
/// The closest point of an edge is made orthogonal to it, that of a triangle parallel to its normal: its direction is
/// then right even where the point is much nearer to the origin than the simplex is large, and its coordinates are
/// rounding errors.
class SimplexFaces {
 public:
  explicit SimplexFaces(CoreSimplex& simplex) : all_(simplex) {}

  void point(std::size_t i) { offer({i}, {1.0}, p(i), 1); }

  void edge(std::size_t i, std::size_t j) {
    const Eigen::Vector3d e = p(j) - p(i);
    const double e2 = e.squaredNorm();
    const double t = -p(i).dot(e);
    if (!(t > 0)) return point(i);
    if (!(t < e2)) return point(j);
    Eigen::Vector3d x = t < 0.5 * e2 ? Eigen::Vector3d(p(i) + t / e2 * e) : Eigen::Vector3d(p(j) - (e2 - t) / e2 * e);
    x -= x.dot(e) / e2 * e;
    offer({i, j}, {1 - t / e2, t / e2}, x, 2);
  }

  void triangle(std::size_t i, std::size_t j, std::size_t k) {
    const Eigen::Vector3d d = p(j) - p(i);
    const Eigen::Vector3d e = p(k) - p(i);
    const Eigen::Vector3d n = d.cross(e);
    const double n2 = n.squaredNorm();
    if (!(n2 > 1e-28 * d.squaredNorm() * e.squaredNorm())) return edges(i, j, k);
    const double u = n.dot(p(j).cross(p(k)));
    const double v = n.dot(p(k).cross(p(i)));
    const double w = n.dot(p(i).cross(p(j)));
    if (u >= 0 && v >= 0 && w >= 0) {
      const double sum = u + v + w;
      return offer({i, j, k}, {u / sum, v / sum, w / sum}, foot_on_plane(i, j, k, n, n2), 3);
    }
    if (u < 0) edge(j, k);
    if (v < 0) edge(k, i);
    if (w < 0) edge(i, j);
  }

  void tetrahedron() {
    constexpr std::size_t kFaces[4][4] = {{0, 1, 2, 3}, {0, 1, 3, 2}, {0, 2, 3, 1}, {1, 2, 3, 0}};
    bool inside = true;
    for (const auto& [i, j, k, l] : kFaces) {
      const Eigen::Vector3d d = p(j) - p(i);
      const Eigen::Vector3d e = p(k) - p(i);
      const Eigen::Vector3d n = d.cross(e);
      const double apex = n.dot(p(l) - p(i));
      const double origin = -n.dot(p(i));
      const bool flat = !(apex * apex > 1e-28 * n.squaredNorm() * (p(l) - p(i)).squaredNorm());
      if (!flat && (apex > 0) == (origin > 0) && origin != 0) continue;
      inside = false;
      triangle(i, j, k);
    }
    inside_ = inside;
  }

  /// Leaves the closest face alone in the simplex.
  void keep_closest() {
    all_.inside = inside_;
    if (inside_) return;
    all_.count = count_;
    all_.closest = closest_;
    all_.squared = squared_;
    std::array<DifferenceVertex, 3> kept;
    for (std::size_t k = 0; k < count_; ++k) kept[k] = all_.vertex[chosen_[k]];
    for (std::size_t k = 0; k < count_; ++k) {
      all_.vertex[k] = kept[k];
      all_.weight[k] = weight_[k];
    }
  }

  /// Returns the point of a triangle's plane closest to the origin, by the more accurate of two ways.
  ///
  /// The normal n has a direction error of e L / t, e an ulp, L the longest edge and t the height above it. The point
  /// of the longest edge, moved across it into the plane by less than t, has an error of e |p|, and a direction error
  /// of that over its length: less for thin triangles that are not too near.
  Eigen::Vector3d foot_on_plane(std::size_t i, std::size_t j, std::size_t k, const Eigen::Vector3d& n,
                                double n2) const {
    Eigen::Vector3d by_normal = n.dot(p(i)) / n2 * n;
    const std::array<std::size_t, 3> corner{i, j, k};
    std::size_t opposite = 0;
    double longest2 = 0;
    for (std::size_t c = 0; c < 3; ++c) {
      const double edge2 = (p(corner[(c + 1) % 3]) - p(corner[(c + 2) % 3])).squaredNorm();
      if (edge2 > longest2) {
        longest2 = edge2;
        opposite = c;
      }
    }
    const Eigen::Vector3d& from = p(corner[(opposite + 1) % 3]);
    const double far2 = std::max(from.squaredNorm(), p(corner[(opposite + 2) % 3]).squaredNorm());
    if (by_normal.squaredNorm() * longest2 * longest2 <= n2 * far2) return by_normal;
    const Eigen::Vector3d e = p(corner[(opposite + 2) % 3]) - from;
    const auto across = [&](const Eigen::Vector3d& x) {
      const Eigen::Vector3d once = x - x.dot(e) / longest2 * e;
      return Eigen::Vector3d(once - once.dot(e) / longest2 * e);
    };
    const Eigen::Vector3d height = across(p(corner[opposite]) - from);
    const Eigen::Vector3d x = across(from);
    return x - x.dot(height) / height.squaredNorm() * height;
  }

 private:
  const Eigen::Vector3d& p(std::size_t k) const { return all_.vertex[k].p; }

  void edges(std::size_t i, std::size_t j, std::size_t k) {
    edge(i, j);
    edge(j, k);
    edge(k, i);
  }

  void offer(const std::array<std::size_t, 3>& chosen, const std::array<double, 3>& weights, const Eigen::Vector3d& x,
             std::size_t count) {
    const double squared = x.squaredNorm();
    if (!(squared < squared_)) return;
    squared_ = squared;
    closest_ = x;
    count_ = count;
    chosen_ = chosen;
    weight_ = weights;
  }

  CoreSimplex& all_;
  std::array<std::size_t, 3> chosen_{};
  std::array<double, 3> weight_{};
  std::size_t count_ = 0;
  Eigen::Vector3d closest_ = Eigen::Vector3d::Zero();
  double squared_ = std::numeric_limits<double>::infinity();
  bool inside_ = false;
};

/// Reduces a simplex to its face that is closest to the origin, with its closest point.
inline void reduce_to_closest(CoreSimplex& simplex) {
  SimplexFaces faces(simplex);
  switch (simplex.count) {
    case 1:
      faces.point(0);
      break;
    case 2:
      faces.edge(0, 1);
      break;
    case 3:
      faces.triangle(0, 1, 2);
      break;
    default:
      faces.tetrahedron();
  }
  faces.keep_closest();
}

}  // namespace geom::kernel
