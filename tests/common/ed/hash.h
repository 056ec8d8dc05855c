#pragma once

/// Hash over the bits of a simulation's state.

#include <ed/ed.h>

#include <Eigen/Core>

#include <cstddef>
#include <cstdint>
#include <cstring>

namespace ed_test {

/// FNV-1a, 64 bits.
class Hash {
 public:
  void add(std::uint64_t word) {
    unsigned char bytes[sizeof word];
    std::memcpy(bytes, &word, sizeof word);
    for (const unsigned char byte : bytes) value_ = (value_ ^ byte) * 1099511628211ULL;
  }
  void add(double x) {
    std::uint64_t word = 0;
    std::memcpy(&word, &x, sizeof word);
    add(word);
  }
  void add(const Eigen::Vector3d& v) {
    for (int k = 0; k < 3; ++k) add(v[k]);
  }
  std::uint64_t value() const { return value_; }

 private:
  std::uint64_t value_ = 14695981039346656037ULL;
};

/// Returns the hash of box, positions, all three body axes, velocities and angular velocities.
inline std::uint64_t hash_of(const ed::System& system) {
  Hash hash;
  hash.add(system.box);
  for (const ed::Body& body : system.bodies) {
    hash.add(body.position);
    for (int k = 0; k < 3; ++k) hash.add(Eigen::Vector3d(body.rotation.col(k)));
    hash.add(body.velocity);
    hash.add(body.angular_velocity);
  }
  return hash.value();
}

/// Returns the hash of the system together with the time, the number of collisions, their virial and the integrals of
/// the angular velocities.
inline std::uint64_t hash_of(const ed::Simulation& simulation) {
  Hash hash;
  hash.add(hash_of(simulation.system()));
  hash.add(simulation.time());
  hash.add(simulation.counters().collisions);
  hash.add(simulation.virial());
  ed::Snapshot snapshot;
  simulation.sample(snapshot);
  for (const Eigen::Vector3d& phi : snapshot.phi_lab) hash.add(phi);
  for (const Eigen::Vector3d& position : snapshot.position) hash.add(position);
  return hash.value();
}

}  // namespace ed_test
