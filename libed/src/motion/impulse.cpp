#include <ed/impulse.h>

#include <Eigen/Geometry>

namespace ed {

double normal_velocity(const ContactBody& a, const ContactBody& b, const Eigen::Vector3d& normal) {
  return normal.dot(b.velocity + b.angular_velocity.cross(b.arm) - a.velocity - a.angular_velocity.cross(a.arm));
}

double collide(ContactBody& a, ContactBody& b, const Eigen::Vector3d& normal) {
  const double v_n = normal_velocity(a, b, normal);
  if (!(v_n < 0)) return 0;
  const Eigen::Vector3d torque_a = a.arm.cross(normal);
  const Eigen::Vector3d torque_b = b.arm.cross(normal);
  const Eigen::Vector3d turn_a = a.inverse_inertia * torque_a;
  const Eigen::Vector3d turn_b = b.inverse_inertia * torque_b;
  const double inverse_effective_mass = a.inverse_mass + b.inverse_mass + torque_a.dot(turn_a) + torque_b.dot(turn_b);
  const auto push = [&](double J) {
    a.velocity -= (J * a.inverse_mass) * normal;
    b.velocity += (J * b.inverse_mass) * normal;
    a.angular_velocity -= J * turn_a;
    b.angular_velocity += J * turn_b;
  };
  const double J = -2 * v_n / inverse_effective_mass;
  push(J);
  // |normal|^2 deviates from 1 by rounding of a fixed sign, and so does the mass: the energy would drift by half a unit
  // in the last place with every collision. The remainder of the reflection has no fixed sign.
  const double rest = -(v_n + normal_velocity(a, b, normal)) / inverse_effective_mass;
  push(rest);
  return J + rest;
}

}  // namespace ed
