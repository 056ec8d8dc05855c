#pragma once

/// Numbers of 113 bits, the reference for double precision. The arithmetic is the compiler's; no library is needed.

#include <Eigen/Core>

#include <cmath>

namespace quad {

#if defined(__SIZEOF_FLOAT128__)
__extension__ typedef __float128 Quad;
#else
using Quad = long double;  // 113 bits too, for compilers without __float128
#endif

inline Quad abs(Quad x) {
  return x < 0 ? -x : x;
}

/// Returns the root by Newton's method, which doubles the digits of the double.
inline Quad sqrt(Quad x) {
  if (!(x > 0)) return 0;
  Quad root = std::sqrt(static_cast<double>(x));
  for (int k = 0; k < 2; ++k) root = (root + x / root) / 2;
  return root;
}
inline Quad cbrt(Quad x) {
  if (!(x > 0)) return 0;
  Quad root = std::cbrt(static_cast<double>(x));
  for (int k = 0; k < 2; ++k) root = (2 * root + x / (root * root)) / 3;
  return root;
}

/// Returns the exponential by its series, of the argument reduced by multiples of ln 2 and divided by 256; squared
/// again. The error is about 1e-31 of the value.
inline Quad exp(Quad x) {
  // ln 2 as the sum of a double and two corrections.
  const Quad ln2 = static_cast<Quad>(0x1.62e42fefa39efp-1) + static_cast<Quad>(0x1.abc9e3b39803fp-56) +
                   static_cast<Quad>(0x1.7b57a079a1934p-111);
  const auto twos = static_cast<int>(std::lround(static_cast<double>(x / ln2)));
  const Quad z = (x - twos * ln2) / 256;
  // exp(z) - 1, so that squaring loses nothing.
  Quad e = 0;
  for (int k = 13; k >= 1; --k) e = z / k * (1 + e);
  for (int k = 0; k < 8; ++k) e = e * (2 + e);
  return (1 + e) * static_cast<Quad>(std::ldexp(1.0, twos));
}
/// Returns the logarithm by Newton's method (Halley's form) from the double: its error is cubed.
inline Quad log(Quad x) {
  const Quad y = std::log(static_cast<double>(x));
  const Quad e = exp(y);
  return y + 2 * (x - e) / (x + e);
}
inline Quad pow(Quad x, Quad p) {
  return x > 0 ? exp(p * log(x)) : Quad(0);
}

struct SinCos {
  Quad sin, cos;
};

/// Returns sine and cosine by their series, of an angle halved to below 1/8 radian. The error is about 1e-32 for angles
/// of some hundred radian.
inline SinCos sincos(Quad x) {
  // pi / 2 as the sum of a double and two corrections.
  const Quad half_pi = static_cast<Quad>(1.57079632679489655800) + static_cast<Quad>(6.12323399573676603587e-17) +
                       static_cast<Quad>(-1.49738490485916983e-33);
  const auto turns = static_cast<Quad>(std::nearbyint(static_cast<double>(x / half_pi)));
  const Quad z = (x - turns * half_pi) / 8;
  const Quad z2 = z * z;
  Quad s = 1;
  Quad c = 1;
  for (int k = 11; k >= 1; --k) {
    s = 1 - s * z2 / (2 * k * (2 * k + 1));
    c = 1 - c * z2 / ((2 * k - 1) * 2 * k);
  }
  s *= z;
  for (int k = 0; k < 3; ++k) {
    const Quad twice = 2 * s * c;
    c = 1 - 2 * s * s;
    s = twice;
  }
  switch (static_cast<long>(static_cast<double>(turns)) & 3) {
    case 0:
      return {s, c};
    case 1:
      return {c, -s};
    case 2:
      return {-s, -c};
    default:
      return {-c, s};
  }
}

struct Quad3 {
  Quad x = 0, y = 0, z = 0;

  Quad3() = default;
  Quad3(Quad x_, Quad y_, Quad z_) : x(x_), y(y_), z(z_) {}
  explicit Quad3(const Eigen::Vector3d& v) : x(v.x()), y(v.y()), z(v.z()) {}

  Quad dot(const Quad3& b) const { return x * b.x + y * b.y + z * b.z; }
  Quad3 cross(const Quad3& b) const { return {y * b.z - z * b.y, z * b.x - x * b.z, x * b.y - y * b.x}; }
  Quad norm() const { return quad::sqrt(dot(*this)); }
};
inline Quad3 operator+(const Quad3& a, const Quad3& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
inline Quad3 operator-(const Quad3& a, const Quad3& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
inline Quad3 operator*(Quad s, const Quad3& a) {
  return {s * a.x, s * a.y, s * a.z};
}
inline Quad3 unit(const Quad3& a) {
  return (1 / a.norm()) * a;
}

/// Returns v rotated about the unit vector l.
inline Quad3 turned(const Quad3& v, const Quad3& l, Quad angle) {
  const SinCos sc = sincos(angle);
  return sc.cos * v + sc.sin * l.cross(v) + ((1 - sc.cos) * l.dot(v)) * l;
}

}  // namespace quad
