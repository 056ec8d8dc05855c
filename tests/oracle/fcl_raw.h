#pragma once

/// FCL asked directly, without the checks of fcl_seed: it may end the process. For oracle tests and benchmarks.

#include <geom/geom.h>

#include <Eigen/Core>

#include <memory>
#include <vector>

namespace geom_test {

struct FclDistance {
  enum class Outcome { answered, threw };
  Outcome outcome;
  double distance;  ///< FCL's; unsigned queries give -1 for what FCL takes for an overlap
  Eigen::Vector3d point_a;
  Eigen::Vector3d point_b;
};

/// FCL's distance of two ellipsoids with GST_LIBCCD at its default tolerance of 1e-6 (an absolute length).
FclDistance fcl_distance(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b,
                         const geom::Pose& X_WB, bool signed_distance);

/// A pair of ellipsoids as FCL keeps it, made once and asked often.
class FclPair {
 public:
  FclPair(const geom::Ellipsoid& a, const geom::Pose& X_WA, const geom::Ellipsoid& b, const geom::Pose& X_WB);

  /// As fcl_distance.
  FclDistance distance(bool signed_distance) const;

 private:
  struct Objects;
  std::shared_ptr<const Objects> objects_;
};

/// The same, unsigned, for the convex hulls of two sets of points.
FclDistance fcl_distance(const std::vector<Eigen::Vector3d>& a, const geom::Pose& X_WA,
                         const std::vector<Eigen::Vector3d>& b, const geom::Pose& X_WB);

/// A support function: the point of the body furthest along `direction` (any length but 0), both in world axes.
using SupportFunction = Eigen::Vector3d (*)(const void* body, const Eigen::Vector3d& direction);

/// FCL's own GJK (the one behind GST_LIBCCD, at its defaults) fed with a support function; -1 for what it takes for an
/// overlap.
double fcl_gjk_distance(const void* a, const void* b, SupportFunction support);

}  // namespace geom_test
