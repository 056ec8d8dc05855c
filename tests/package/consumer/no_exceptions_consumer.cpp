// hardbody::geom in a program that is compiled without exceptions, as those of robots and games are: templates are
// instantiated here, with a shape of the program's own.
#include <geom/geom.h>

#include <Eigen/Geometry>

#include <cmath>
#include <cstdio>

#ifdef __cpp_exceptions
#error "compile this with -fno-exceptions"
#endif

namespace {

struct Ball {
  double radius;

  geom::Support support(const Eigen::Vector3d& n) const { return {radius * n.norm(), radius * n.normalized()}; }
  Eigen::Matrix3d support_hessian(const Eigen::Vector3d& n) const {
    const Eigen::Vector3d u = n.normalized();
    return radius / n.norm() * (Eigen::Matrix3d::Identity() - u * u.transpose());
  }
  double bounding_radius() const { return radius; }
  double inscribed_radius() const { return radius; }
  double value(const Eigen::Vector3d& x) const { return x.squaredNorm() - radius * radius; }
  Eigen::Vector3d gradient(const Eigen::Vector3d& x) const { return 2 * x; }
  Eigen::Matrix3d hessian(const Eigen::Vector3d& /*x*/) const { return 2 * Eigen::Matrix3d::Identity(); }
};

bool near(double value, double wanted) {
  return std::abs(value - wanted) < 1e-13;
}

}  // namespace

int main() {
  const geom::Ellipsoid needle({1.0, 1.0, 3.0});
  const Ball ball{0.5};
  const geom::Pose X_WA = geom::Pose::normalized_quaternion(Eigen::Quaternionf(2, 0, 0, 0));
  const geom::Pose X_WB = X_WA * geom::Pose::from_isometry(Eigen::Isometry3d(Eigen::Translation3d(0, 0, 4)));
  const geom::WitnessPair seed = geom::normal_seed(needle, X_WA, ball, X_WB, {0, 0, 1});
  int wrong = !near(geom::distance(needle, X_WA, ball, X_WB).distance, 0.5);
  wrong += !near(geom::newton_distance(needle, X_WA, ball, X_WB, geom::NewtonSystem::eight, seed).distance, 0.5);
  wrong += !near(geom::ray_cast(ball, X_WB, {0, 0, 1e7}, {0, 0, -1}).point.z(), 4.5);
  wrong += X_WB.inverse().isometry().translation() != Eigen::Vector3d(0, 0, -4);
  wrong += !near(geom::mass_properties(ball, 0.5).volume, 0.5235987755982988);
  std::printf("%d wrong\n", wrong);
  return wrong;
}
