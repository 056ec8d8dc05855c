#pragma once

#include "base/large_vector.h"

#include <ed/simulation.h>

#include <Eigen/Core>

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <numeric>
#include <tuple>
#include <vector>

namespace ed::internal {

/// Log of a loop's collisions: their number for each body, the virial, and as many of them as were asked for.
class CollisionLog {
 public:
  explicit CollisionLog(int number) : of_body_(static_cast<std::size_t>(number), 0) {}

  /// Counts a collision of i and j, whose centres are r apart, with the impulse J n on j.
  void add(int i, int j, const Eigen::Vector3d& r, double J, const Eigen::Vector3d& n) {
    ++of_body_[static_cast<std::size_t>(i)];
    ++of_body_[static_cast<std::size_t>(j)];
    virial_ += J * r.dot(n);
    virial_tensor_ += r * (J * n).transpose();
  }
  bool wants_more() const { return recorded_.size() < wanted_; }
  void record(double time, int i, int j) { recorded_.push_back({time, std::min(i, j), std::max(i, j)}); }

  /// Forgets the recorded collisions; the next `number` are to be recorded.
  void start_record(std::size_t number) {
    recorded_.clear();
    wanted_ = number;
    reserve();
  }
  /// Makes room for records; more grows as it is needed.
  void reserve() { recorded_.reserve(std::min(wanted_, kReserved)); }

  double virial() const { return virial_; }
  const Eigen::Matrix3d& virial_tensor() const { return virial_tensor_; }
  const std::vector<Collision>& recorded() const { return recorded_; }
  /// Sum over bodies `first` to `end` - 1.
  std::uint64_t of_bodies(int first, int end) const {
    return std::accumulate(of_body_.begin() + first, of_body_.begin() + end, std::uint64_t{0});
  }
  std::size_t number() const { return of_body_.size(); }  ///< number of bodies

  /// Virial, its tensor, collisions of each body, recorded ones, number of those that are wanted.
  template <class Self>
  static auto members(Self& self) {
    return std::tie(self.virial_, self.virial_tensor_, self.of_body_, self.recorded_, self.wanted_);
  }

 private:
  static constexpr std::size_t kReserved = std::size_t{1} << 20;

  double virial_ = 0;
  Eigen::Matrix3d virial_tensor_ = Eigen::Matrix3d::Zero();
  LargeVector<std::uint64_t> of_body_;
  std::vector<Collision> recorded_;
  std::size_t wanted_ = 0;
};

}  // namespace ed::internal
