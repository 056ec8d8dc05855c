#include "uniaxial_looks.h"

#include "find_kernels.h"

#include <array>
#include <cstddef>

namespace ed::internal {
namespace {

/// Fewer pairs are not worth a kernel's call.
constexpr int kFewestLooks = 3;

void put(const geom::internal::Spheroid& shape, LookRow* rows, int lane) {
  put_shape(shape, rows + LookBody::shape, lane);
  rows[LookBody::turning_limit][lane] = shape.turning_limit;
}

void put(const AxisMotion& motion, bool spins, LookRow* rows, int lane) {
  put_vector(motion.position, rows + LookBody::position, lane);
  put_vector(motion.velocity, rows + LookBody::velocity, lane);
  put_vector(motion.e1, rows + LookBody::e1, lane);
  put_vector(motion.e2, rows + LookBody::e2, lane);
  rows[LookBody::rate][lane] = motion.rate;
  rows[LookBody::time][lane] = motion.time;
  if (spins) put_vector(motion.e0, rows + LookBody::e0, lane);
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

void UniaxialLooks::put(const UniaxialBodies& bodies, const Look& look, int lane) {
  const Pair& pair = *look.pair;
  if (!one_kind_) internal::put(bodies.kind_of(pair.i), bodies.kind_of(pair.j), in_, lane);
  internal::put(bodies.axis_motion(pair.i), spins_, in_.rows + LookInput::body_a, lane);
  internal::put(bodies.axis_motion(pair.j), spins_, in_.rows + LookInput::body_b, lane);
  in_.rows[LookInput::end][lane] = look.end;
  put_vector(pair.normal, in_.rows + LookInput::normal, lane);
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
  for (std::size_t next = 0; next < looks.size();) {
    int lanes = 0;
    for (; next < looks.size() && lanes < kBlockLooks; ++next) {
      if (looks[next].pair->normal.isZero(0)) continue;
      put(bodies, looks[next], lanes);
      look_of[static_cast<std::size_t>(lanes++)] = &looks[next];
    }
    if (lanes < kFewestLooks) return;
    const Look& last = *look_of[static_cast<std::size_t>(lanes - 1)];
    for (int lane = lanes; lane % kLongestVector != 0; ++lane) put(bodies, last, lane);
    kernel_(in_, lanes, out_);
    for (int lane = 0; lane < lanes; ++lane) read(lane, *look_of[static_cast<std::size_t>(lane)], count);
  }
}

}  // namespace ed::internal
