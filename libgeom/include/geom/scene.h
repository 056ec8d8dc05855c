#pragma once

/// @file
/// Many bodies: pairs that are close, the body that is nearest to a point or to a shape, ray casts. Open space or a
/// periodic lattice.

#include <geom/any_convex.h>
#include <geom/distance.h>
#include <geom/export.h>
#include <geom/pose.h>
#include <geom/queries.h>
#include <geom/shape_variant.h>

#include <Eigen/Core>

#include <array>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <memory>
#include <optional>
#include <span>
#include <type_traits>
#include <utility>
#include <variant>
#include <vector>

namespace geom {

/// Handle of a body of one Scene. Handles grow in the order in which bodies are added, from 0, and are never reused.
enum class BodyId : std::uint32_t {};

/// Lattice vectors along which a scene repeats. A zero vector: the scene does not repeat along it; three: open space.
struct Lattice {
  std::array<Eigen::Vector3d, 3> vectors = {Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero(), Eigen::Vector3d::Zero()};

  /// Returns the lattice of a cube with this edge.
  static Lattice cube(double edge) {
    return {{edge * Eigen::Vector3d::UnitX(), edge * Eigen::Vector3d::UnitY(), edge * Eigen::Vector3d::UnitZ()}};
  }
};

/// Shape of a body, or of a query: one of those that geom::Shape holds, a geom::Shape, or any other SupportShape.
class SceneShape {
 public:
  /// Constructs it from a shape; those that geom::Shape does not hold become an AnyConvex.
  template <class T>
  requires(!std::same_as<T, SceneShape> && (std::is_constructible_v<Shape, T> || SupportShape<T>))
      SceneShape(T shape)  // NOLINT: a shape is one of any kind
      : any_(held(std::move(shape))) {}

  const std::variant<Shape, AnyConvex>& any() const { return any_; }  ///< shape inside

 private:
  template <class T>
  static std::variant<Shape, AnyConvex> held(T shape) {
    if constexpr (std::is_constructible_v<Shape, T>) {
      return Shape(std::move(shape));
    } else {
      return AnyConvex(std::move(shape));
    }
  }

  std::variant<Shape, AnyConvex> any_;
};

/// Properties of a scene that do not change.
struct SceneOptions {
  /// Length by which boxes around bodies are larger on each side than the bodies, >= 0. Bodies that stay inside their
  /// boxes move at no cost; larger boxes mean more candidates.
  double margin = 0;
  Lattice lattice = {};
};

/// Groups of a body. Two bodies are paired if each one's `meets` has a bit of the other's `group`.
struct Filter {
  std::uint32_t group = 1;    ///< groups to which the body belongs, as bits
  std::uint32_t meets = ~0U;  ///< groups that it is paired with
};

/// Returns whether two bodies with these filters are paired.
inline bool meet(const Filter& a, const Filter& b) {
  return (a.meets & b.group) != 0 && (b.meets & a.group) != 0;
}

/// Two bodies and a lattice vector; i < j in the answers about all pairs.
struct ScenePair {
  BodyId i{}, j{};
  /// Vector to be added to the position of j; 0 in open space.
  Eigen::Vector3d image = Eigen::Vector3d::Zero();
  /// Distance from i to that image of j.
  DistanceResult result = {};
};

/// Two bodies, i < j, that overlap or may do so.
struct SceneOverlap {
  BodyId i{}, j{};
  Eigen::Vector3d image = Eigen::Vector3d::Zero();  ///< vector to be added to the position of j
  Answer answer = Answer::unknown;                  ///< `yes` or `unknown`, see `overlap`
};

/// Body, or an image of it, that a query of one point, ray or shape has found.
struct SceneImage {
  BodyId body{};
  Eigen::Vector3d image = Eigen::Vector3d::Zero();  ///< lattice vector to be added to its position
};

/// Closest body and the point of its surface that is closest to the given one.
struct ScenePoint {
  std::optional<SceneImage> body;  ///< nullopt: no body within the distance
  ClosestPoint closest;
};

/// Closest body and the distance from the given shape to it.
struct SceneNearest {
  std::optional<SceneImage> body;  ///< nullopt: no body within the distance
  DistanceResult result;
};

/// First body that a ray meets.
struct SceneRayHit {
  std::optional<SceneImage> body;  ///< nullopt: none
  RayHit hit;
};

/// Bodies in a broad phase, a tree of boxes around bodies.
///
/// Queries are const and may run in any number of threads at a time, while none adds, moves or removes bodies. Answers
/// are ordered by handles and lattice vectors; they depend on bodies and poses alone, not on how these came about or on
/// the number of threads. Each is that of trying all pairs: boxes leave out only what is certainly further away.
/// DistanceOptions::start does not count. If a user's shape throws, the exception is passed on, and outputs stay.
///
/// Periodic scenes: positions may be anywhere; every body stands for all its images. A body and images of itself are
/// no pair. Queries that reach over more than 1e8 lattice vectors throw std::invalid_argument.
///
/// Functions that take handles throw std::invalid_argument for one that no body of the scene has, before anything is
/// changed.
class GEOM_EXPORT Scene {
 public:
  /// Constructs a scene without bodies. Throws std::invalid_argument if the margin is negative or not finite, or if
  /// lattice vectors are not finite or nearly in one plane.
  explicit Scene(const SceneOptions& options = {});
  ~Scene();
  /// Move a scene with its bodies, whose handles stay. The one moved from may only be destroyed or assigned to.
  /// @{
  Scene(Scene&& other) noexcept;
  Scene& operator=(Scene&& other) noexcept;
  /// @}

  /// Adds a body and returns its handle.
  BodyId add(const SceneShape& shape, const Pose& X_WB, Filter filter = {});

  /// Removes a body.
  void remove(BodyId body);

  /// Moves bodies to new poses, all of them or, if an exception is thrown, by a user's shape for instance, none. Throws
  /// std::invalid_argument unless there are as many poses as bodies.
  void move(std::span<const BodyId> bodies, std::span<const Pose> X_WB);
  /// Overload for one body.
  void move(BodyId body, const Pose& X_WB);

  /// Poses of bodies, and the boxes there.
  struct Places;
  /// Returns where bodies are, for `put_back`.
  std::shared_ptr<const Places> places(std::span<const BodyId> bodies) const;
  /// Moves bodies to where they were when this scene returned `places`; those that were removed since then stay away.
  /// Asks nothing of shapes, and does not throw.
  void put_back(const Places& places) noexcept;

  /// Changes which bodies a body is paired with.
  void set_filter(BodyId body, Filter filter);

  std::size_t size() const;      ///< number of bodies
  bool has(BodyId body) const;   ///< whether the scene has the body
  Pose pose(BodyId body) const;  ///< pose of a body, as it was given
  /// Returns the shape of a body; it may share memory with the scene's.
  std::variant<Shape, AnyConvex> shape(BodyId body) const;
  Filter filter(BodyId body) const;     ///< filter of a body
  std::vector<BodyId> bodies() const;   ///< handles of all bodies, in ascending order
  const SceneOptions& options() const;  ///< options that the scene was constructed with

  /// Finds every pair of bodies, images included, whose distance is at most `cutoff`, and every pair that may be and
  /// whose distance was declined (`result.status`). `out` is overwritten. Uses `threads` threads, >= 1, but no more
  /// than a few for each processor, for the distances. Distances agree to rounding with those of Scene::distance, and
  /// whether they are within the cut-off does exactly: those of ellipsoids are of `distance_batch`, unless they are
  /// near the cut-off. Throws std::invalid_argument if the cut-off is negative or not finite.
  void pairs_within(double cutoff, std::vector<ScenePair>& out, const DistanceOptions& options = {},
                    int threads = 1) const;

  /// Finds every pair that overlaps, images included, and every pair for which `overlap` answers `unknown`. `out` is
  /// overwritten.
  void overlapping_pairs(std::vector<SceneOverlap>& out, int threads = 1) const;

  /// Finds every body that overlaps a shape, or may do so. `out` is overwritten. Filters do not count.
  void overlapping(const SceneShape& shape, const Pose& X_WS, std::vector<SceneImage>& out) const;

  /// Visits pairs among which are all those within `cutoff`, in no particular order: bodies i < j and the lattice
  /// vector to be added to the position of j. `visit` returns false to stop.
  void candidates(double cutoff,
                  const std::function<bool(BodyId i, BodyId j, const Eigen::Vector3d& image)>& visit) const;

  /// Returns the distance of two bodies, the least over all images of j; i > j is accepted, the answer is then from i
  /// to j. Overlaps have the depth of Penetration::global. Throws std::invalid_argument for i = j.
  ScenePair distance(BodyId i, BodyId j, const DistanceOptions& options = {}) const;

  /// Returns the body that is nearest to a shape, not further than `within`, and the distance from the shape to it. Of
  /// bodies equally far the one with the smallest handle. If the distance of a body that may be the nearest is
  /// declined, that body is returned, with that status. Overlaps have the depth of Penetration::global. Filters do not
  /// count.
  SceneNearest nearest(const SceneShape& shape, const Pose& X_WS,
                       double within = std::numeric_limits<double>::infinity(),
                       const DistanceOptions& options = {}) const;
  /// Returns the body that is nearest to another one of the scene, of those that the filters pair it with.
  SceneNearest nearest(BodyId body, double within = std::numeric_limits<double>::infinity(),
                       const DistanceOptions& options = {}) const;

  /// Returns the body whose surface is closest to a point, not further than `within`, with `closest_point`; a point
  /// inside bodies belongs to the one in which it is deepest.
  ScenePoint closest_point(const Eigen::Vector3d& p_W, double within = std::numeric_limits<double>::infinity()) const;

  /// Returns the first body that origin + t direction, 0 <= t <= t_max, meets, with `ray_cast`. If a body that may be
  /// the first declines, that body is returned, with that status. Throws std::invalid_argument if a number is not
  /// finite, the direction is zero, t_max is negative, or a periodic ray begins further away than 1e9 times the
  /// shortest lattice vector, is longer than 1e6 times that, or has more than 1e8 images on its way; of its length,
  /// what is beyond all bodies along directions in which the scene does not repeat does not count.
  SceneRayHit ray_cast(const Eigen::Vector3d& origin, const Eigen::Vector3d& direction,
                       double t_max = std::numeric_limits<double>::infinity()) const;

 private:
  struct Bodies;
  std::unique_ptr<Bodies> bodies_;
};

}  // namespace geom
