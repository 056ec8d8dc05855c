#include <geom/kernel/perram_wertheim.h>

#include <Eigen/LU>

#include <cmath>

namespace geom::kernel {

ContactFunction perram_wertheim(const Eigen::Matrix3d& Q_a, const Eigen::Matrix3d& Q_b, const Eigen::Vector3d& r) {
  // F' is decreasing, positive at 0 and negative at 1: [low, high] always brackets its zero.
  double low = 0;
  double high = 1;
  double lambda = 0.5;
  Eigen::Vector3d w;
  const Eigen::Matrix3d dG = Q_b - Q_a;
  for (int iteration = 0; iteration < 100; ++iteration) {
    const Eigen::Matrix3d G_inv = ((1 - lambda) * Q_a + lambda * Q_b).inverse();
    w = G_inv * r;  // dw/dlambda = -G^-1 dG w
    const Eigen::Vector3d dGw = dG * w;
    const double rw = r.dot(w);
    const double d1 = w.dot(dGw);            // -d(r.w)/dlambda
    const double d2 = dGw.dot(G_inv * dGw);  // (1/2) d2(r.w)/dlambda2
    const double m = lambda * (1 - lambda);
    const double slope = (1 - 2 * lambda) * rw - m * d1;
    const double curvature = -2 * rw - 2 * (1 - 2 * lambda) * d1 + 2 * m * d2;
    (slope > 0 ? low : high) = lambda;
    double next = lambda - slope / curvature;
    if (!(next > low && next < high)) next = 0.5 * (low + high);
    if (std::abs(next - lambda) <= 1e-15) break;
    lambda = next;
  }
  return {lambda * (1 - lambda) * r.dot(w), lambda, w.normalized()};
}

}  // namespace geom::kernel
