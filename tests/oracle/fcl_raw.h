#pragma once

/// Direct calls of FCL, without the checks of fcl_seed: FCL may abort the process. For oracle tests and benchmarks.

#include <geom/geom.h>

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace geom_test {

struct FclDistance {
  enum class Outcome { answered, threw };
  Outcome outcome;
  double distance;  ///< FCL's distance; unsigned queries give -1 if FCL finds an overlap
  Eigen::Vector3d point_a;
  Eigen::Vector3d point_b;
};

/// Returns FCL's distance of two ellipsoids with GST_LIBCCD at its default tolerance of 1e-6 (an absolute length).
FclDistance fcl_distance(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b,
                         const geom::Pose& X_WB, bool signed_distance);

/// Pair of ellipsoids in FCL's form, made once for many queries.
class FclPair {
 public:
  FclPair(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b, const geom::Pose& X_WB);

  /// Returns the distance, see fcl_distance.
  FclDistance distance(bool signed_distance) const;

 private:
  struct Objects;
  std::shared_ptr<const Objects> objects_;
};

/// Overload for the convex hulls of two sets of points; unsigned.
FclDistance fcl_distance(const std::vector<Eigen::Vector3d>& a, const geom::Pose& X_WA,
                         const std::vector<Eigen::Vector3d>& b, const geom::Pose& X_WB);

/// Pair of FCL's own primitives, made once for many queries. Boxes and capsules by their extents (capsule: half-length
/// along z and radius), hulls by their points and faces.
class FclPrimitives {
 public:
  FclPrimitives(const geom::kernel::CoreView& a, const geom::Pose& X_WA, const geom::kernel::CoreView& b,
                const geom::Pose& X_WB);

  /// Returns the distance at FCL's defaults, with nearest points; -1 if it finds an overlap.
  FclDistance distance() const;

 private:
  struct Objects;
  std::shared_ptr<const Objects> objects_;
};

/// Many bodies in FCL's dynamic tree of axis-aligned boxes. Superellipsoids, which FCL does not know, are hulls of
/// points of their surfaces.
class FclScene {
 public:
  FclScene();

  void add(const geom::Shape& shape, const geom::Pose& X_WB);
  /// Builds the tree, after the last body.
  void build();
  /// Moves all bodies and brings the tree up to date.
  void move(const std::vector<geom::Pose>& X_WB);

  /// Returns the distances, at FCL's defaults, of all pairs whose distance is at most `cutoff`; -1 of overlaps.
  std::vector<double> pairs_within(double cutoff) const;

 private:
  struct Objects;
  std::shared_ptr<Objects> objects_;
};

/// Support function: returns the point of the body furthest along `direction` (any length except 0), both in world
/// axes.
using SupportFunction = Eigen::Vector3d (*)(const void* body, const Eigen::Vector3d& direction);

/// Returns the distance by FCL's own GJK (the one behind GST_LIBCCD, at its defaults) with a support function; -1 if it
/// finds an overlap.
double fcl_gjk_distance(const void* a, const void* b, SupportFunction support);

}  // namespace geom_test
