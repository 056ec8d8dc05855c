#pragma once

/// Bodies that meet, and what an answer of time_of_contact has to fulfil.

#include <ed/contact_options.h>
#include <ed/motion.h>
#include <ed/time_of_contact.h>

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

namespace contact_scenes {

using ed::ContactResult;
using ed::ContactStatus;
using ed::Motion;
using Eigen::Vector3d;
using geom::Ellipsoid;

inline Ellipsoid sphere(double radius) {
  return Ellipsoid(Vector3d::Constant(radius));
}

inline Motion at(const Vector3d& position, const Vector3d& velocity) {
  Motion m;
  m.pose = geom::Pose::translation(position);
  m.velocity = velocity;
  return m;
}

/// d at time t, by libgeom.
inline double distance_at(const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b, const Motion& motion_b,
                          double t) {
  return geom::distance(a, ed::propagate(motion_a, t).pose, b, ed::propagate(motion_b, t).pose).distance;
}

/// A hit is where the bodies touch, its point on both surfaces, its normal that of the distance.
inline void expect_touching(const ContactResult& hit, const Ellipsoid& a, const Motion& motion_a, const Ellipsoid& b,
                            const Motion& motion_b) {
  ASSERT_EQ(hit.status, ContactStatus::hit);
  const double size = a.bounding_radius() + b.bounding_radius();
  const Motion now_a = ed::propagate(motion_a, hit.time);
  const Motion now_b = ed::propagate(motion_b, hit.time);
  const geom::DistanceResult d = geom::distance(a, now_a.pose, b, now_b.pose);
  EXPECT_NEAR(d.distance, 0, 1e-13 * size);
  EXPECT_LE((d.normal - hit.normal).norm(), 1e-7);
  EXPECT_NEAR(hit.normal.norm(), 1, 1e-14);
  EXPECT_LE((d.point_a - hit.point).norm(), 1e-7 * size);
  // The surface's level function near it is 2 / (smallest semi-axis) times the distance from it at most.
  EXPECT_NEAR(a.value(now_a.pose.to_body(hit.point)), 0, 1e-12 * size / a.inscribed_radius());
  EXPECT_NEAR(b.value(now_b.pose.to_body(hit.point)), 0, 1e-12 * size / b.inscribed_radius());
  const Vector3d v_a = now_a.velocity + now_a.angular_velocity.cross(hit.point - now_a.pose.position());
  const Vector3d v_b = now_b.velocity + now_b.angular_velocity.cross(hit.point - now_b.pose.position());
  EXPECT_LT((v_b - v_a).dot(hit.normal), 0) << "the bodies must approach";
}

inline void expect_separated_until(const ContactResult& result, double t_max) {
  EXPECT_EQ(result.status, ContactStatus::separated);
  EXPECT_EQ(result.time, t_max);
  EXPECT_TRUE(result.point.hasNaN());
  EXPECT_TRUE(result.normal.hasNaN());
}

inline ed::ContactOptions bracketing(ed::DistanceMethod distance, ed::ContactRoot root = ed::ContactRoot::newton) {
  ed::ContactOptions options;
  options.finder = ed::Finder::bracketing;
  options.distance = distance;
  options.root = root;
  return options;
}

}  // namespace contact_scenes
