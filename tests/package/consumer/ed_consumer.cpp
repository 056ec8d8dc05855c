#include <ed/ed.h>

#include <cmath>
#include <iostream>

int main() {
  const geom::Ellipsoid ball({1.0, 1.0, 1.0});
  ed::Motion a, b;
  b.pose = geom::Pose::translation({5.0, 0.0, 0.0});
  b.velocity = {-1.5, 0.0, 0.0};
  const ed::ContactResult hit = ed::time_of_contact(ball, a, ball, b, 10.0);
  std::cout << to_string(hit.status) << ' ' << hit.time << '\n';
  // A gap of 3 at speed 1.5, to rounding.
  return hit.status == ed::ContactStatus::hit && std::abs(hit.time - 2.0) < 1e-14 ? 0 : 1;
}
