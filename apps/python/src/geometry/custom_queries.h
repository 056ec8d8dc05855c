#pragma once

/// Queries about pairs and bodies of which some are written in Python: the functions of libgeom, for shapes of any
/// kind.

#include <ed/shape.h>
#include <geom/distance.h>
#include <geom/pose.h>
#include <geom/queries.h>

#include <Eigen/Core>

#include <optional>

namespace hardbody::python::any {

geom::DistanceResult distance(const ed::BodyShape& a, const geom::Pose& X_WA, const ed::BodyShape& b,
                              const geom::Pose& X_WB, const geom::DistanceOptions& options);
double distance_lower_bound(const ed::BodyShape& a, const geom::Pose& X_WA, const ed::BodyShape& b,
                            const geom::Pose& X_WB, const Eigen::Vector3d& n);
geom::Answer overlap(const ed::BodyShape& a, const geom::Pose& X_WA, const ed::BodyShape& b, const geom::Pose& X_WB,
                     const Eigen::Vector3d& start);
geom::ClosestPoint closest_point(const ed::BodyShape& shape, const geom::Pose& X_WB, const Eigen::Vector3d& p_W);
/// Returns nullopt where neither answer is certain, which happens with shapes that have no implicit function.
std::optional<bool> contains(const ed::BodyShape& shape, const geom::Pose& X_WB, const Eigen::Vector3d& p_W);
geom::RayHit ray_cast(const ed::BodyShape& shape, const geom::Pose& X_WB, const Eigen::Vector3d& origin,
                      const Eigen::Vector3d& direction);

}  // namespace hardbody::python::any
