#pragma once

/// Vectors of two numbers, one for body A in lane 0 and one for body B in lane 1, with exponential and logarithm.
///
/// Both functions consist of operations that IEEE 754 rounds exactly, so that they give the same bits on every
/// processor. The C library's pow, with its variants for each processor, does not guarantee that.

#include <Eigen/Core>

#include <cstdint>

namespace geom::kernel {

using Lanes = double __attribute__((vector_size(16)));
using LaneBits = std::uint64_t __attribute__((vector_size(16)));

inline Lanes both(double value) {
  return Lanes{value, value};
}
inline double sum(Lanes v) {
  return v[0] + v[1];
}
inline Lanes select(LaneBits where, Lanes yes, Lanes no) {
  return reinterpret_cast<Lanes>((where & reinterpret_cast<LaneBits>(yes)) | (~where & reinterpret_cast<LaneBits>(no)));
}
/// Exchanges the lanes of A and B.
inline Lanes swapped(Lanes v) {
  return Lanes{v[1], v[0]};
}
inline LaneBits below(Lanes a, Lanes b) {
  return reinterpret_cast<LaneBits>(a < b);
}
inline bool any(LaneBits where) {
  return (where[0] | where[1]) != 0;
}
inline Lanes abs(Lanes v) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneBits>(v) & LaneBits{~kSign, ~kSign});
}
/// Returns `size`, which is positive, with the sign of `sign`.
inline Lanes with_sign(Lanes size, Lanes sign) {
  constexpr std::uint64_t kSign = std::uint64_t{1} << 63;
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneBits>(size) |
                                 (reinterpret_cast<LaneBits>(sign) & LaneBits{kSign, kSign}));
}
inline Lanes sqrt(Lanes v) {
  return Lanes{__builtin_sqrt(v[0]), __builtin_sqrt(v[1])};
}

/// Returns ln x to 1 ulp for positive normal x; about -709 for 0.
///
/// x = 2^k m, sqrt(1/2) <= m < sqrt(2), z = (m - 1)/(m + 1): ln m = 2 atanh z = f - z (f - z^2 P(z^2)), f = m - 1, with
/// P a Chebyshev fit, to 5e-18.
inline Lanes log(Lanes x) {
  constexpr std::uint64_t kOne = 0x3ff0000000000000;
  constexpr std::uint64_t kSqrtHalf = 0x3fe6a09e667f3bcd;
  constexpr std::uint64_t kTwo52 = 0x4330000000000000;
  const LaneBits bits = reinterpret_cast<LaneBits>(x);
  const LaneBits biased = (bits + (kOne - kSqrtHalf)) >> 52;
  const Lanes m = reinterpret_cast<Lanes>(bits - (biased << 52) + kOne);
  const Lanes k = reinterpret_cast<Lanes>(biased | kTwo52) - (0x1p52 + 1023);
  const Lanes f = m - 1;
  const Lanes z = f / (m + 1);
  const Lanes w = z * z;
  const Lanes w2 = w * w;
  const Lanes low = (0.66666666666666697077 + 0.39999999999898890514 * w) +
                    (0.28571428626253837606 + 0.22222211089379496214 * w) * w2;
  const Lanes high = (0.181828924325368712 + 0.15331611722055007897 * w) + 0.14617807153417324815 * w2;
  const Lanes P = low + high * (w2 * w2);
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;  // k times this is exact
  constexpr double kLn2Low = 5.497923018708371174712472e-14;
  return k * kLn2High - ((z * (f - w * P) - k * kLn2Low) - f);
}

/// Returns e^y to 1 ulp for y <= 700; e^-700 below -700.
///
/// y = n ln 2 + r, |r| <= ln 2 / 2: e^r = 1 + r + r^2 Q(r), with Q a Chebyshev fit, to 1.3e-17.
inline Lanes exp(Lanes y) {
  constexpr double kRound = 0x1.8p52;  // the last bit of this number is worth 1
  constexpr double kLn2High = 0x1.62e42fefa3800p-1;
  constexpr double kLn2Low = 5.497923018708371174712472e-14;
  const Lanes least = both(-700);
  y = select(below(y, least), least, y);
  const Lanes shifted = y * 1.442695040888963407359925 + kRound;
  const Lanes n = shifted - kRound;
  const Lanes r = (y - n * kLn2High) - n * kLn2Low;
  const Lanes r2 = r * r;
  const Lanes r4 = r2 * r2;
  const Lanes low = (0.50000000000000010314 + 0.1666666666666666746 * r) +
                    (0.041666666666623820532 + 0.0083333333333300381973 * r) * r2;
  const Lanes middle = (0.0013888888917367080562 + 0.00019841269863171556026 * r) +
                       (0.000024801521057868205199 + 2.7557268276905696187e-6 * r) * r2;
  const Lanes high = 2.7620201591031548778e-7 + 2.5100472505694995992e-8 * r;
  const Lanes Q = low + (middle + high * r4) * r4;
  const Lanes e = 1 + (r + r2 * Q);
  return reinterpret_cast<Lanes>(reinterpret_cast<LaneBits>(e) + (reinterpret_cast<LaneBits>(shifted) << 52));
}

/// Vector of each of the two bodies.
struct LaneVector {
  Lanes x, y, z;

  static LaneVector of(const Eigen::Vector3d& a, const Eigen::Vector3d& b) {
    return {Lanes{a.x(), b.x()}, Lanes{a.y(), b.y()}, Lanes{a.z(), b.z()}};
  }
  static LaneVector same(const Eigen::Vector3d& v) { return {both(v.x()), both(v.y()), both(v.z())}; }

  Eigen::Vector3d a() const { return {x[0], y[0], z[0]}; }
  Eigen::Vector3d b() const { return {x[1], y[1], z[1]}; }
  Lanes dot(const LaneVector& v) const { return x * v.x + y * v.y + z * v.z; }
  Lanes dot(const Eigen::Vector3d& v) const { return x * v.x() + y * v.y() + z * v.z(); }
  LaneVector cross(const LaneVector& v) const { return {y * v.z - z * v.y, z * v.x - x * v.z, x * v.y - y * v.x}; }
};

inline LaneVector operator+(const LaneVector& u, const LaneVector& v) {
  return {u.x + v.x, u.y + v.y, u.z + v.z};
}
inline LaneVector operator-(const LaneVector& u, const LaneVector& v) {
  return {u.x - v.x, u.y - v.y, u.z - v.z};
}
inline LaneVector operator*(Lanes s, const LaneVector& v) {
  return {s * v.x, s * v.y, s * v.z};
}
inline LaneVector swapped(const LaneVector& v) {
  return {swapped(v.x), swapped(v.y), swapped(v.z)};
}
/// Returns the product component by component.
inline LaneVector product(const LaneVector& u, const LaneVector& v) {
  return {u.x * v.x, u.y * v.y, u.z * v.z};
}
/// Returns the absolute value of each component.
inline LaneVector abs(const LaneVector& v) {
  return {abs(v.x), abs(v.y), abs(v.z)};
}
inline LaneVector normalized(const LaneVector& v) {
  return (1 / sqrt(v.dot(v))) * v;
}

/// Rotation of each of the two bodies, by its columns.
struct LaneRotation {
  LaneVector x, y, z;

  static LaneRotation of(const Eigen::Matrix3d& a, const Eigen::Matrix3d& b) {
    return {LaneVector::of(a.col(0), b.col(0)), LaneVector::of(a.col(1), b.col(1)), LaneVector::of(a.col(2), b.col(2))};
  }
  LaneVector operator*(const LaneVector& v) const { return v.x * x + v.y * y + v.z * z; }
  LaneVector transposed_times(const LaneVector& v) const { return {x.dot(v), y.dot(v), z.dot(v)}; }
};

}  // namespace geom::kernel
