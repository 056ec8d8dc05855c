#pragma once

/// Pairs of bodies in motion as they occur in a dense fluid, for tests of the contact finder.

#include <common/finder/reference.h>

#include <ed/random.h>
#include <ed/simulation.h>
#include <ed/start.h>
#include <ed/system.h>

#include <geom/distance.h>
#include <geom/ellipsoid.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>
#include <utility>
#include <vector>

namespace finder_test {

/// Returns an ellipsoid with semi-axes along x, y, z, a along z, X0 = a / b and a b^2 = 1.
inline geom::Ellipsoid spheroid(double aspect_ratio) {
  const double b = 1 / std::cbrt(aspect_ratio);
  return geom::Ellipsoid({b, b, aspect_ratio * b});
}

/// Pair of bodies of the same kind.
struct MovingPair {
  BodyState a;
  BodyState b;
};

inline double log_uniform(ed::Random& random, double low, double high) {
  return low * std::exp(random.uniform() * std::log(high / low));
}

/// Returns the velocity of B's contact point relative to A's, at a point given in the world frame.
inline Eigen::Vector3d contact_velocity(const BodyState& a, const BodyState& b, const Eigen::Vector3d& point) {
  return b.velocity + b.omega().cross(point - b.position) - a.velocity - a.omega().cross(point - a.position);
}

/// Returns near neighbours in an equilibrated fluid: their positions and orientations, A at the origin. These do not
/// depend on the moments of inertia.
inline std::vector<MovingPair> near_neighbours(double aspect_ratio, double packing_fraction, int number,
                                               std::uint64_t seed) {
  /// Largest surface-to-surface distance of near neighbours (the geometric mean of the semi-axes is 1).
  constexpr double kNear = 0.5;
  const geom::Ellipsoid shape = spheroid(aspect_ratio);
  ed::StartOptions options;
  options.packing_fraction = packing_fraction;
  options.number = std::max(number, ed::smallest_number(shape, packing_fraction));
  options.seed = seed;
  ed::Simulation simulation(ed::random_start(ed::paper_species(shape), options));
  simulation.run_collisions(20 * static_cast<std::uint64_t>(options.number));
  const ed::System system = simulation.system();
  std::vector<MovingPair> neighbours;
  for (int i = 0; i < system.size(); ++i) {
    for (int j = i + 1; j < system.size(); ++j) {
      const ed::Body& a = system.bodies[static_cast<std::size_t>(i)];
      const ed::Body& b = system.bodies[static_cast<std::size_t>(j)];
      Eigen::Vector3d r = b.position - a.position;
      for (double& x : r) x -= system.box * std::round(x / system.box);
      const geom::DistanceResult d =
          geom::distance(shape, geom::Pose(a.rotation, Eigen::Vector3d::Zero()), shape, geom::Pose(b.rotation, r));
      if (d.status != geom::DistanceStatus::separated || d.distance > kNear) continue;
      MovingPair pair;
      pair.a.rotation = a.rotation;
      pair.b.rotation = b.rotation;
      pair.b.position = r;
      neighbours.push_back(pair);
    }
  }
  return neighbours;
}

/// Pairs of near neighbours of a fluid with fresh velocities.
class Fluid {
 public:
  /// Constructs the fluid. `spins`: uniform moments of inertia and spin about the axis; else the paper's moments and no
  /// spin.
  Fluid(double aspect_ratio, bool spins, std::vector<MovingPair> neighbours, std::uint64_t seed)
      : shape_(spheroid(aspect_ratio)), spins_(spins), random_(seed), neighbours_(std::move(neighbours)) {
    const Eigen::Vector3d inertia = spins ? shape_.inertia(1.0) : ed::paper_species(shape_).inertia;
    moments_ = {inertia.x(), inertia.z()};
  }

  const geom::Ellipsoid& shape() const { return shape_; }
  const Moments& moments() const { return moments_; }
  bool spins() const { return spins_; }
  double size() const { return 2 * shape_.bounding_radius(); }
  ed::Random& random() { return random_; }

  /// Returns neighbours with thermal velocities (kT = m = 1), rotating `boost` times as fast.
  MovingPair thermal_pair(double boost = 1) {
    const auto index = static_cast<std::size_t>(random_.uniform() * static_cast<double>(neighbours_.size()));
    MovingPair pair = neighbours_[index];
    set_thermal(pair.a, boost);
    set_thermal(pair.b, boost);
    return pair;
  }

  /// Returns a pair that touches at time 0, moved together along its normal. The normal velocity of the contact points
  /// is made `share` of their relative velocity (> 0: parting), and the bodies are then moved apart by `gap` (< 0: an
  /// overlap).
  MovingPair touching_pair(double boost, double share, double gap) {
    while (true) {
      MovingPair pair = thermal_pair(boost);
      const geom::Pose X_a(pair.a.rotation, pair.a.position);
      const geom::DistanceResult d = geom::distance(shape_, X_a, shape_, geom::Pose(pair.b.rotation, pair.b.position));
      if (d.status != geom::DistanceStatus::separated) continue;
      pair.b.position -= d.distance * d.normal;
      const Eigen::Vector3d v = contact_velocity(pair.a, pair.b, d.point_a);
      pair.b.velocity += (share * v.norm() - v.dot(d.normal)) * d.normal;
      pair.b.position += gap * d.normal;
      return pair;
    }
  }

  /// Returns the same motion with its time 0 moved `before` earlier.
  MovingPair earlier(const MovingPair& pair, double before) const {
    return {FreeMotion(pair.a, moments_).at(-before), FreeMotion(pair.b, moments_).at(-before)};
  }

  /// Returns the pair as it was up to `longest` before, where the bodies were apart; nullopt if no such time is found.
  std::optional<MovingPair> approach(const MovingPair& pair, double longest) const {
    constexpr int kAttempts = 19;
    double before = longest;
    for (int attempt = 0; attempt < kAttempts; ++attempt) {
      const MovingPair start = earlier(pair, before);
      const geom::DistanceResult d = geom::distance(shape_, geom::Pose(start.a.rotation, start.a.position), shape_,
                                                    geom::Pose(start.b.rotation, start.b.position));
      if (d.status == geom::DistanceStatus::separated && d.distance > 1e-9 * size()) return start;
      before *= 0.6;
    }
    return std::nullopt;
  }

 private:
  void set_thermal(BodyState& body, double boost) {
    body.velocity = random_.normal3();
    const Eigen::Vector3d u = body.axis();
    const Eigen::Vector3d w = boost / std::sqrt(moments_.perpendicular) * random_.normal3();
    body.across = w - w.dot(u) * u;
    body.spin = spins_ ? boost / std::sqrt(moments_.axial) * random_.normal() : 0;
  }

  geom::Ellipsoid shape_;
  bool spins_;
  ed::Random random_;
  Moments moments_;
  std::vector<MovingPair> neighbours_;
};

}  // namespace finder_test
