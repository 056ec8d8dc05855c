#pragma once

/// Numbers of each arc of two bodies' nested norms (contact_elements.h): the inner and the outer one of A and B. They
/// fill two registers, whose chains of operations the processor works on at once.

#include <geom/kernel/lanes.h>

namespace geom::kernel {

struct ArcLanes {
  Lanes inner, outer;

  ArcLanes() = default;
  ArcLanes(Lanes of_inner, Lanes of_outer) : inner(of_inner), outer(of_outer) {}
  ArcLanes(double value) : inner(both(value)), outer(both(value)) {}  // implicit: constants apply to all four
};

struct ArcBits {
  LaneBits inner, outer;
};

inline ArcLanes operator-(const ArcLanes& v) {
  return {-v.inner, -v.outer};
}
inline ArcLanes operator+(const ArcLanes& u, const ArcLanes& v) {
  return {u.inner + v.inner, u.outer + v.outer};
}
inline ArcLanes operator-(const ArcLanes& u, const ArcLanes& v) {
  return {u.inner - v.inner, u.outer - v.outer};
}
inline ArcLanes operator*(const ArcLanes& u, const ArcLanes& v) {
  return {u.inner * v.inner, u.outer * v.outer};
}
inline ArcLanes operator/(const ArcLanes& u, const ArcLanes& v) {
  return {u.inner / v.inner, u.outer / v.outer};
}
inline ArcBits operator~(const ArcBits& where) {
  return {~where.inner, ~where.outer};
}
inline ArcBits operator&(const ArcBits& u, const ArcBits& v) {
  return {u.inner & v.inner, u.outer & v.outer};
}
inline ArcBits operator^(const ArcBits& u, const ArcBits& v) {
  return {u.inner ^ v.inner, u.outer ^ v.outer};
}

inline ArcBits below(const ArcLanes& u, const ArcLanes& v) {
  return {below(u.inner, v.inner), below(u.outer, v.outer)};
}
inline bool any(const ArcBits& where) {
  return any(where.inner | where.outer);
}
inline ArcLanes select(const ArcBits& where, const ArcLanes& yes, const ArcLanes& no) {
  return {select(where.inner, yes.inner, no.inner), select(where.outer, yes.outer, no.outer)};
}
inline ArcLanes abs(const ArcLanes& v) {
  return {abs(v.inner), abs(v.outer)};
}
inline ArcLanes sqrt(const ArcLanes& v) {
  return {sqrt(v.inner), sqrt(v.outer)};
}
inline ArcLanes exp(const ArcLanes& v) {
  return {exp(v.inner), exp(v.outer)};
}
inline ArcLanes log(const ArcLanes& v) {
  return {log(v.inner), log(v.outer)};
}

}  // namespace geom::kernel
