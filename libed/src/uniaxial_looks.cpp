#include "uniaxial_looks.h"

#include "uniaxial_kernels.h"

#include <geom/internal/lanes.h>
#include <geom/internal/uniaxial.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <cstring>

namespace ed::internal {
namespace {

/// Fewer pairs are not worth a kernel's call.
constexpr int kFewestLooks = 3;

void put_vector(const Eigen::Vector3d& v, LookRow* rows, int lane) {
  for (int k = 0; k < 3; ++k) rows[k][lane] = v[k];
}

void put(const geom::internal::Spheroid& shape, LookRow* rows, int lane) {
  LookRow* const of_shape = rows + LookBody::shape;
  of_shape[ShapeRows::a2][lane] = shape.a2;
  of_shape[ShapeRows::b2][lane] = shape.b2;
  of_shape[ShapeRows::c][lane] = shape.c;
  of_shape[ShapeRows::rho][lane] = shape.rho;
  rows[LookBody::turning_limit][lane] = shape.turning_limit;
}

/// The rows of a body from `position` on are the members of AxisMotion, number by number.
constexpr int kFirstRow = LookBody::position;
constexpr int kNumbers = LookBody::e0 - kFirstRow;  ///< of bodies without spin
static_assert(offsetof(AxisMotion, velocity) == sizeof(double) * (LookBody::velocity - kFirstRow) &&
              offsetof(AxisMotion, e1) == sizeof(double) * (LookBody::e1 - kFirstRow) &&
              offsetof(AxisMotion, e2) == sizeof(double) * (LookBody::e2 - kFirstRow) &&
              offsetof(AxisMotion, rate) == sizeof(double) * (LookBody::rate - kFirstRow) &&
              offsetof(AxisMotion, time) == sizeof(double) * (LookBody::time - kFirstRow) &&
              offsetof(AxisMotion, e0) == sizeof(double) * kNumbers && kNumbers % 2 == 0);

/// Two bodies of lanes beside each other, two numbers of each at a time: half as many loads and stores.
void put(const AxisMotion& first, const AxisMotion& second, bool spins, LookRow* rows, int lane) {
  using Two = geom::internal::Lanes;
  const auto* const of_first = reinterpret_cast<const char*>(&first);
  const auto* const of_second = reinterpret_cast<const char*>(&second);
  for (int k = 0; k < kNumbers; k += 2) {
    Two x, y;
    std::memcpy(&x, of_first + sizeof(double) * k, sizeof x);
    std::memcpy(&y, of_second + sizeof(double) * k, sizeof y);
    const Two here{x[0], y[0]};
    const Two next{x[1], y[1]};
    std::memcpy(rows[kFirstRow + k] + lane, &here, sizeof here);
    std::memcpy(rows[kFirstRow + k + 1] + lane, &next, sizeof next);
  }
  if (!spins) return;
  put_vector(first.e0, rows + LookBody::e0, lane);
  put_vector(second.e0, rows + LookBody::e0, lane + 1);
}

void put(const UniaxialKind& a, const UniaxialKind& b, LookInput& in, int lane) {
  put(a.shape, in.rows + LookInput::body_a, lane);
  put(b.shape, in.rows + LookInput::body_b, lane);
  in.rows[LookInput::reach][lane] = a.bounding_radius + b.bounding_radius;
}

}  // namespace

UniaxialLooks::UniaxialLooks(const UniaxialBodies& bodies, const UniaxialKernels& kernels)
    : kernel_(bodies.spins() ? kernels.look_spinning : kernels.look_across),
      spins_(bodies.spins()),
      one_kind_(bodies.kinds().size() == 1) {
  if (!one_kind_) return;
  for (int lane = 0; lane < kBlockLooks; ++lane) internal::put(bodies.kinds()[0], bodies.kinds()[0], in_, lane);
}

void UniaxialLooks::put(const UniaxialBodies& bodies, const Look& first, const Look& second, int lane) {
  const Pair& one = *first.pair;
  const Pair& other = *second.pair;
  if (!one_kind_) {
    internal::put(bodies.kind_of(one.i), bodies.kind_of(one.j), in_, lane);
    internal::put(bodies.kind_of(other.i), bodies.kind_of(other.j), in_, lane + 1);
  }
  internal::put(bodies.axis_motion(one.i), bodies.axis_motion(other.i), spins_, in_.rows + LookInput::body_a, lane);
  internal::put(bodies.axis_motion(one.j), bodies.axis_motion(other.j), spins_, in_.rows + LookInput::body_b, lane);
  in_.rows[LookInput::end][lane] = first.end;
  in_.rows[LookInput::end][lane + 1] = second.end;
  put_vector(one.normal, in_.rows + LookInput::normal, lane);
  put_vector(other.normal, in_.rows + LookInput::normal, lane + 1);
}

void UniaxialLooks::read(int lane, Look& look, FinderCounters& count) const {
  const double verdict = out_.rows[LookOutput::verdict][lane];
  if (verdict == LookOutput::open) return;
  const double kernel_calls = out_.rows[LookOutput::kernel_calls][lane];
  look.answered = true;
  look.finding = verdict == LookOutput::clear ? Finding{Outcome::clear, look.end}
                                              : Finding{Outcome::bound, out_.rows[LookOutput::time][lane]};
  if (kernel_calls > 1) {
    for (int k = 0; k < 3; ++k) look.pair->normal[k] = out_.rows[LookOutput::normal + k][lane];
  }
  ++count.predictions;
  if (kernel_calls > 0) ++count.evaluations;
  count.kernel_calls += static_cast<std::uint64_t>(kernel_calls);
}

void UniaxialLooks::take(const UniaxialBodies& bodies, double now, double box, std::span<Look> looks,
                         FinderCounters& count) {
  in_.now = now;
  in_.box = box;
  std::array<Look*, kBlockLooks> look_of;
  const auto look_in = [&](int lane) -> Look& { return *look_of[static_cast<std::size_t>(lane)]; };
  for (std::size_t next = 0; next < looks.size();) {
    int lanes = 0;
    for (; next < looks.size() && lanes < kBlockLooks; ++next) {
      if (looks[next].pair->normal.isZero(0)) continue;
      look_of[static_cast<std::size_t>(lanes++)] = &looks[next];
    }
    if (lanes < kFewestLooks) return;
    const int last = lanes - 1;
    const int filled = (lanes + kLongestVector - 1) / kLongestVector * kLongestVector;
    for (int lane = 0; lane < filled; lane += 2) {
      put(bodies, look_in(std::min(lane, last)), look_in(std::min(lane + 1, last)), lane);
    }
    kernel_(in_, lanes, out_);
    for (int lane = 0; lane < lanes; ++lane) read(lane, look_in(lane), count);
  }
}

}  // namespace ed::internal
