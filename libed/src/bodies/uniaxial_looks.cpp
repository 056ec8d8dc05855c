#include "bodies/uniaxial_looks.h"

#include "vectors/kernels.h"

#include <geom/kernel/uniaxial.h>

#include <Eigen/Core>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <span>
#include <vector>

namespace ed::internal {
namespace {

/// Fewer pairs are not worth a kernel's call.
constexpr int kFewestLooks = 3;

void put(const geom::kernel::Spheroid& shape, LookRow* rows, int lane) {
  rows[ShapeRows::a2][lane] = shape.a2;
  rows[ShapeRows::b2][lane] = shape.b2;
  rows[ShapeRows::c][lane] = shape.c;
  rows[ShapeRows::rho][lane] = shape.rho;
}

void put(const Rod& rod, LookRow* rows, int lane) {
  rows[RodRows::half_length][lane] = rod.half_length;
  rows[RodRows::radius][lane] = rod.radius;
}

void put(const UniaxialKind& a, const UniaxialKind& b, UniaxialFamily pairs, LookInput& in, int lane) {
  in.rows[LookInput::reach][lane] = a.bounding_radius + b.bounding_radius;
  if (pairs == UniaxialFamily::rods) {
    put(a.rod, in.rows + LookInput::shape_a, lane);
    put(b.rod, in.rows + LookInput::shape_b, lane);
    return;
  }
  put(a.shape, in.rows + LookInput::shape_a, lane);
  put(b.shape, in.rows + LookInput::shape_b, lane);
  in.rows[LookInput::turning_limit_a][lane] = a.shape.turning_limit;
  in.rows[LookInput::turning_limit_b][lane] = b.shape.turning_limit;
}

/// The numbers of LookBody.
const double* numbers(const AxisMotion& motion) {
  constexpr auto stands = [](std::size_t offset, int number) { return offset == sizeof(double) * number; };
  static_assert(stands(offsetof(AxisMotion, position), LookBody::position) &&
                stands(offsetof(AxisMotion, velocity), LookBody::velocity) &&
                stands(offsetof(AxisMotion, e1), LookBody::e1) && stands(offsetof(AxisMotion, e2), LookBody::e2) &&
                stands(offsetof(AxisMotion, rate), LookBody::rate) &&
                stands(offsetof(AxisMotion, time), LookBody::time) && stands(offsetof(AxisMotion, e0), LookBody::e0));
  return reinterpret_cast<const double*>(&motion);
}

/// Returns the families of pairs that there may be.
std::vector<UniaxialFamily> families_of(const UniaxialBodies& bodies) {
  if (bodies.family() != UniaxialFamily::mixed) return {bodies.family()};
  return {UniaxialFamily::spheroids, UniaxialFamily::rods, UniaxialFamily::mixed};
}

}  // namespace

LookKernel* UniaxialLooks::kernel_of(const UniaxialBodies& bodies, const std::optional<geom::InstructionSet>& batches,
                                     UniaxialFamily pairs) {
  const FamilyKernels kernels = bodies.kernels(batches, pairs);
  return bodies.spins() ? kernels.look_spinning : kernels.look_across;
}

bool UniaxialLooks::serve(const UniaxialBodies& bodies, const std::optional<geom::InstructionSet>& batches) {
  const std::vector<UniaxialFamily> families = families_of(bodies);
  return std::any_of(families.begin(), families.end(),
                     [&](UniaxialFamily pairs) { return kernel_of(bodies, batches, pairs) != nullptr; });
}

UniaxialLooks::UniaxialLooks(const UniaxialBodies& bodies, const std::optional<geom::InstructionSet>& batches)
    : closed_forms_(bodies.family() != UniaxialFamily::spheroids && !bodies.all_spheres()),
      one_kind_(bodies.kinds().size() == 1),
      mixed_(bodies.family() == UniaxialFamily::mixed) {
  for (const UniaxialFamily pairs : families_of(bodies)) {
    LookKernel* const kernel = kernel_of(bodies, batches, pairs);
    if (kernel != nullptr) families_.push_back({pairs, kernel, {}});
  }
  if (!one_kind_) return;
  const UniaxialKind& kind = bodies.kinds()[0];
  for (Family& family : families_) {
    for (int lane = 0; lane < kBlockLooks; ++lane) internal::put(kind, kind, family.pairs, family.in, lane);
  }
}

void UniaxialLooks::use(const UniaxialBodies& bodies, geom::InstructionSet set) {
  for (Family& family : families_) family.kernel = kernel_of(bodies, set, family.pairs);
}

void UniaxialLooks::put(const UniaxialBodies& bodies, Family& family, const PairLook& look, int lane) {
  const Pair& pair = *look.pair;
  LookInput& in = family.in;
  if (!one_kind_) internal::put(bodies.kind_of(pair.i), bodies.kind_of(pair.j), family.pairs, in, lane);
  in.body_a[lane] = numbers(bodies.axis_motion(pair.i));
  in.body_b[lane] = numbers(bodies.axis_motion(pair.j));
  in.normal[lane] = pair.normal.data();
  in.rows[LookInput::end][lane] = look.end;
}

void UniaxialLooks::read(int lane, PairLook& look, FinderCounters& count) const {
  const double verdict = out_.rows[LookOutput::verdict][lane];
  if (verdict == LookOutput::open) return;
  const double kernel_calls = out_.rows[LookOutput::kernel_calls][lane];
  const bool contact = verdict == LookOutput::contact;
  look.answered = true;
  look.finding = {Outcome::clear, look.end};
  if (verdict != LookOutput::clear) {
    look.finding = {contact ? Outcome::contact : Outcome::bound, out_.rows[LookOutput::time][lane]};
  }
  if (contact || kernel_calls > 1) {
    for (int k = 0; k < 3; ++k) look.pair->normal[k] = out_.rows[LookOutput::normal + k][lane];
  }
  ++count.predictions;
  if (kernel_calls > 0) ++count.evaluations;
  count.kernel_calls += static_cast<std::uint64_t>(kernel_calls);
}

void UniaxialLooks::take(const UniaxialBodies& bodies, double now, double box, std::span<PairLook> looks,
                         FinderCounters& count) {
  for (Family& family : families_) {
    family.in.now = now;
    family.in.box = box;
    take(bodies, family, looks, count);
  }
}

void UniaxialLooks::take(const UniaxialBodies& bodies, Family& family, std::span<PairLook> looks,
                         FinderCounters& count) {
  std::array<PairLook*, kBlockLooks> look_of;
  const auto look_in = [&](int lane) -> PairLook& { return *look_of[static_cast<std::size_t>(lane)]; };
  for (std::size_t next = 0; next < looks.size();) {
    int lanes = 0;
    for (; next < looks.size() && lanes < kBlockLooks; ++next) {
      const Pair& pair = *looks[next].pair;
      if (pair.normal.isZero(0) || (closed_forms_ && bodies.are_spheres(pair.i, pair.j))) continue;
      if (mixed_ && bodies.family_of(pair.i, pair.j) != family.pairs) continue;
      look_of[static_cast<std::size_t>(lanes++)] = &looks[next];
    }
    if (lanes < kFewestLooks) return;
    const int last = lanes - 1;
    const int filled = (lanes + kLongestVector - 1) / kLongestVector * kLongestVector;
    for (int lane = 0; lane < filled; ++lane) put(bodies, family, look_in(std::min(lane, last)), lane);
    family.kernel(family.in, lanes, out_);
    for (int lane = 0; lane < lanes; ++lane) read(lane, look_in(lane), count);
  }
}

}  // namespace ed::internal
