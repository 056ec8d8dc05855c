#pragma once

/// Monte Carlo of hard bodies of one species at constant pressure, for comparison with the event loop. It shares no
/// code with that but geom's overlap query.

#include <common/geom/random.h>

#include <ed/system.h>

#include <geom/any_shape.h>
#include <geom/queries.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

namespace ed_test {

class MonteCarlo {
 public:
  /// `pressure`: P / kT, 1 / length^3. The system has one species.
  MonteCarlo(const ed::System& system, const geom::Shape& shape, double pressure, std::uint64_t seed)
      : shape_(shape),
        reach_(2 * geom::bounding_radius(shape)),
        inner_(2 * geom::inscribed_radius(shape)),
        pressure_(pressure),
        box_(system.box),
        random_(seed) {
    for (const ed::Body& body : system.bodies) {
      bodies_.push_back({body.position, Eigen::Quaterniond(body.rotation).normalized()});
    }
  }

  double volume() const { return box_ * box_ * box_; }

  /// Tries to move each body once on average, and the box three times: its volume is what relaxes most slowly.
  void sweep() {
    for (std::size_t k = 0; k < bodies_.size(); ++k) try_body();
    for (int k = 0; k < kBoxMoves; ++k) try_box();
  }

  /// Sweeps, and adjusts the lengths of the moves so that about a third of them succeeds.
  void equilibrate(int sweeps) {
    constexpr int kStretch = 20;
    for (int k = 0; k < sweeps; k += kStretch) {
      moved_ = {};
      turned_ = {};
      scaled_ = {};
      for (int sweep_in = 0; sweep_in < kStretch; ++sweep_in) sweep();
      adjust(step_, moved_);
      adjust(turn_step_, turned_);
      adjust(box_step_, scaled_);
    }
  }

  /// Returns body z of all bodies.
  std::vector<Eigen::Vector3d> axes() const {
    std::vector<Eigen::Vector3d> all;
    for (const Place& body : bodies_) all.push_back(body.rotation * Eigen::Vector3d::UnitZ());
    return all;
  }

 private:
  static constexpr int kBoxMoves = 3;

  struct Place {
    Eigen::Vector3d position;
    Eigen::Quaterniond rotation;
  };

  /// Numbers of moves.
  struct Tries {
    int all = 0, accepted = 0;
  };

  /// Makes a length of moves larger or smaller.
  static void adjust(double& step, const Tries& tries) { step *= 3 * tries.accepted > tries.all ? 1.1 : 0.9; }

  bool overlap(const Place& a, const Place& b) const {
    Eigen::Vector3d r = b.position - a.position;
    for (int k = 0; k < 3; ++k) r[k] -= box_ * std::round(r[k] / box_);
    const double r2 = r.squaredNorm();
    if (r2 >= reach_ * reach_) return false;
    if (r2 < inner_ * inner_) return true;
    const geom::Pose X_A(a.rotation.toRotationMatrix(), Eigen::Vector3d::Zero());
    const geom::Pose X_B(b.rotation.toRotationMatrix(), r);
    return geom::overlap(shape_, X_A, shape_, X_B) != geom::Answer::no;
  }

  bool overlaps(std::size_t k, const Place& trial) const {
    for (std::size_t other = 0; other < bodies_.size(); ++other) {
      if (other != k && overlap(trial, bodies_[other])) return true;
    }
    return false;
  }

  Eigen::Vector3d in_cube() { return {random_.uniform(-1, 1), random_.uniform(-1, 1), random_.uniform(-1, 1)}; }

  void try_body() {
    const auto k = static_cast<std::size_t>(random_.uniform() * static_cast<double>(bodies_.size()));
    Place trial = bodies_[k];
    Tries& tries = random_.coin() ? moved_ : turned_;
    if (&tries == &moved_) {
      trial.position += step_ * in_cube();
    } else {
      const Eigen::AngleAxisd turn(turn_step_ * random_.uniform(-1, 1), random_.direction());
      trial.rotation = (turn * trial.rotation).normalized();
    }
    ++tries.all;
    if (overlaps(k, trial)) return;
    bodies_[k] = trial;
    ++tries.accepted;
  }

  /// Changes ln V by a random amount; acceptance min(1, exp[(N + 1) d ln V - P dV]).
  void try_box() {
    ++scaled_.all;
    const double change = box_step_ * random_.uniform(-1, 1);
    const double before = volume();
    const double exponent = static_cast<double>(bodies_.size() + 1) * change - pressure_ * before * std::expm1(change);
    if (exponent < 0 && random_.uniform() >= std::exp(exponent)) return;
    const double factor = std::exp(change / 3);
    scale(factor);
    if (change < 0 && any_overlap()) {
      scale(1 / factor);
    } else {
      ++scaled_.accepted;
    }
  }

  void scale(double factor) {
    box_ *= factor;
    for (Place& body : bodies_) body.position *= factor;
  }

  bool any_overlap() const {
    for (std::size_t i = 0; i < bodies_.size(); ++i) {
      for (std::size_t j = 0; j < i; ++j) {
        if (overlap(bodies_[i], bodies_[j])) return true;
      }
    }
    return false;
  }

  geom::Shape shape_;
  double reach_, inner_;
  double pressure_;
  double box_;
  double step_ = 0.1, turn_step_ = 0.1, box_step_ = 0.02;
  Tries moved_, turned_, scaled_;
  std::vector<Place> bodies_;
  geom_test::Random random_;
};

}  // namespace ed_test
