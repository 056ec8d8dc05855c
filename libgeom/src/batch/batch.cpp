#include "batch/checks.h"
#include "batch/kernel.h"

#include <geom/batch.h>
#include <geom/kernel/refuse.h>

#include <algorithm>
#include <array>
#include <optional>
#include <sstream>
#include <utility>
#include <variant>

namespace geom {
namespace {

using kernel::BatchKernels;
using kernel::BatchOutput;
using kernel::BatchRow;
using kernel::checked;
using kernel::GeneralInput;
using kernel::Input;
using kernel::kBlockPairs;
using kernel::kLongestVector;
using kernel::UniaxialInput;

/// Returns null pointers if the build has no such kernels or the processor cannot run them.
BatchKernels find_kernels(InstructionSet set) {
#ifdef HARDBODY_X86_KERNELS
  const bool avx2 = __builtin_cpu_supports("avx2") && __builtin_cpu_supports("fma") && __builtin_cpu_supports("bmi") &&
                    __builtin_cpu_supports("bmi2");
  if (set == InstructionSet::avx2 && avx2) return kernel::batch_kernels_avx2();
  const bool avx512 = __builtin_cpu_supports("avx512f") && __builtin_cpu_supports("avx512vl") &&
                      __builtin_cpu_supports("avx512dq") && __builtin_cpu_supports("avx512bw");
  if (set == InstructionSet::avx512 && avx2 && avx512) return kernel::batch_kernels_avx512();
#endif
  if (set == InstructionSet::portable) return kernel::batch_kernels_portable();
  return {nullptr, nullptr};
}

/// Input of a batch, and the destination of its answers.
struct Query {
  Input<Ellipsoid> a;
  Input<Pose> X_WA;
  Input<Ellipsoid> b;
  Input<Pose> X_WB;
  std::span<const Eigen::Vector3d> starts;
  std::span<DistanceResult> results;
  DistanceOptions scalar;

  DistanceResult by_distance(std::size_t pair) const {
    DistanceOptions options = scalar;
    if (!starts.empty()) options.start = starts[pair];
    return distance(a[pair], X_WA[pair], b[pair], X_WB[pair], options);
  }
};

/// Pair of bodies, and the destination of their answer.
struct Pair {
  const Ellipsoid* a;
  const Pose* X_WA;
  const Ellipsoid* b;
  const Pose* X_WB;
  std::size_t index;

  double depth() const { return a->min_curvature_radius() + b->min_curvature_radius(); }
};

void put_shapes(const Pair& pair, GeneralInput& in, int lane) {
  in.semi_axes_a[lane] = pair.a->semi_axes().data();
  in.semi_axes_b[lane] = pair.b->semi_axes().data();
  in.rotation_a[lane] = pair.X_WA->rotation().data();
  in.rotation_b[lane] = pair.X_WB->rotation().data();
}

/// Writes the numbers of a body of revolution into the rows. Returns the address of its axis.
const double* put_revolution(const Ellipsoid& shape, const Pose& X, BatchRow* rows, int lane) {
  const int axis = *shape.symmetry_axis();
  rows[0][lane] = shape.semi_axes()[axis];
  rows[1][lane] = shape.semi_axes()[axis == 0 ? 1 : 0];
  return &X.rotation()(0, axis);
}

void put_shapes(const Pair& pair, UniaxialInput& in, int lane) {
  in.axis_a[lane] = put_revolution(*pair.a, *pair.X_WA, in.rows + UniaxialInput::along_a, lane);
  in.axis_b[lane] = put_revolution(*pair.b, *pair.X_WB, in.rows + UniaxialInput::along_b, lane);
}

int iterations_of(const BatchOutput& out, int lane) {
  return static_cast<int>(out.iterations[lane]);
}

/// Writes the answer in place: a result built elsewhere would be copied in other pieces than it was written, which
/// causes stalls.
void read_answer(const BatchOutput& out, int lane, DistanceResult& result) {
  const double* const first = out.records[BatchOutput::distance_and_point_a][lane];
  const double* const second = out.records[BatchOutput::point_b_and_residual][lane];
  const double* const third = out.records[BatchOutput::normal_and_error_bound][lane];
  result.distance = first[0];
  result.point_a = Eigen::Vector3d::Map(first + 1);
  result.point_b = Eigen::Vector3d::Map(second);
  result.normal = Eigen::Vector3d::Map(third);
  result.status = first[0] >= 0 ? DistanceStatus::separated : DistanceStatus::overlapping;
  result.iterations = iterations_of(out, lane);
  result.residual = second[3];
  result.error_bound = third[3];
}

/// Collects pairs of one kind until there are enough for one call of their kernel.
template <class KernelInput>
class Block {
 public:
  using Kernel = void(const KernelInput& in, int pairs, BatchOutput& out);

  Block(const Query& query, Kernel* kernel) : query_(query), kernel_(kernel) { in_.has_starts = !query.starts.empty(); }

  void add(const Pair& pair) {
    pairs_[count_++] = pair;
    if (count_ == kBlockPairs) flush();
  }

  /// Answers what has been collected.
  void flush() {
    if (count_ == 0) return;
    const int filled = (count_ + kLongestVector - 1) / kLongestVector * kLongestVector;
    for (int lane = count_; lane < filled; ++lane) pairs_[lane] = pairs_[count_ - 1];
    for (int lane = 0; lane < filled; ++lane) put(pairs_[lane], lane);
    kernel_(in_, count_, out_);
    for (int lane = 0; lane < count_; ++lane) {
      DistanceResult& result = query_.results[pairs_[lane].index];
      if (is_answered(lane)) [[likely]] {
        read_answer(out_, lane, result);
      } else {
        result = query_.by_distance(pairs_[lane].index);
        ++redone_;
      }
    }
    count_ = 0;
  }

  std::size_t redone() const { return redone_; }

 private:
  /// True if the kernel answered: a pair that it started has at least one evaluation.
  bool is_answered(int lane) const {
    return out_.iterations[lane] > 0 && iterations_of(out_, lane) <= std::max(1, query_.scalar.max_iterations);
  }

  void put(const Pair& pair, int lane) {
    put_shapes(pair, in_, lane);
    in_.rows[KernelInput::depth][lane] = pair.depth();
    in_.position_a[lane] = pair.X_WA->position().data();
    in_.position_b[lane] = pair.X_WB->position().data();
    if (in_.has_starts) in_.start[lane] = query_.starts[pair.index].data();
  }

  const Query& query_;
  Kernel* kernel_;
  int count_ = 0;
  std::size_t redone_ = 0;
  std::array<Pair, kBlockPairs> pairs_;
  KernelInput in_;
  BatchOutput out_;
};

[[noreturn]] void refuse_instruction_set(InstructionSet wanted) {
  std::ostringstream message;
  message << "distance_batch: instruction_set is " << to_string(wanted)
          << ", which this processor or this build does not have; accepted: best";
  for (const InstructionSet set : {InstructionSet::portable, InstructionSet::avx2, InstructionSet::avx512}) {
    if (is_available(set)) message << ", " << to_string(set);
  }
  kernel::refuse(message.str());
}

}  // namespace

namespace kernel {

void refuse_size(const char* name, std::size_t size, const char* other, std::size_t pairs) {
  std::ostringstream message;
  message << "distance_batch: " << name << " has " << size << " elements; accepted: " << other << ", or as many as"
          << " results, which has " << pairs;
  kernel::refuse(message.str());
}

DistanceOptions scalar_options(const BatchOptions& options) {
  DistanceOptions scalar;
  scalar.max_iterations = options.max_iterations;
  scalar.penetration = options.penetration;
  return scalar;
}

void check_starts(const BatchOptions& options, std::size_t pairs) {
  if (!options.starts.empty() && options.starts.size() != pairs) {
    refuse_size("starts", options.starts.size(), "0", pairs);
  }
}

InstructionSet chosen(InstructionSet wanted) {
  const InstructionSet set = wanted == InstructionSet::best ? batch_instruction_set() : wanted;
  if (find_kernels(set).general == nullptr) refuse_instruction_set(set);
  return set;
}

}  // namespace kernel

const char* to_string(InstructionSet set) {
  switch (set) {
    case InstructionSet::best:
      return "best";
    case InstructionSet::portable:
      return "portable";
    case InstructionSet::avx2:
      return "avx2";
    case InstructionSet::avx512:
      return "avx512";
  }
  return "unknown";
}

bool is_available(InstructionSet set) {
  return set == InstructionSet::best || find_kernels(set).general != nullptr;
}

InstructionSet batch_instruction_set() {
  for (const InstructionSet set : {InstructionSet::avx512, InstructionSet::avx2}) {
    if (is_available(set)) return set;
  }
  return InstructionSet::portable;
}

BatchSummary distance_batch(std::span<const Ellipsoid> a, std::span<const Pose> X_WA, std::span<const Ellipsoid> b,
                            std::span<const Pose> X_WB, std::span<DistanceResult> results,
                            const BatchOptions& options) {
  const std::size_t pairs = results.size();
  const Query query{checked("a", a, pairs),
                    checked("X_WA", X_WA, pairs),
                    checked("b", b, pairs),
                    checked("X_WB", X_WB, pairs),
                    options.starts,
                    results,
                    kernel::scalar_options(options)};
  kernel::check_starts(options, pairs);
  const InstructionSet set = kernel::chosen(options.instruction_set);
  const BatchKernels kernels = find_kernels(set);

  Block<UniaxialInput> uniaxial(query, kernels.uniaxial);
  Block<GeneralInput> general(query, kernels.general);
  const Ellipsoid* shape_a = query.a.data;
  const Pose* pose_a = query.X_WA.data;
  const Ellipsoid* shape_b = query.b.data;
  const Pose* pose_b = query.X_WB.data;
  for (std::size_t pair = 0; pair < pairs; ++pair) {
    if (shape_a->symmetry_axis() && shape_b->symmetry_axis()) {
      uniaxial.add({shape_a, pose_a, shape_b, pose_b, pair});
    } else {
      general.add({shape_a, pose_a, shape_b, pose_b, pair});
    }
    shape_a += query.a.stride;
    shape_b += query.b.stride;
    pose_a += query.X_WA.stride;
    pose_b += query.X_WB.stride;
  }
  uniaxial.flush();
  general.flush();
  return {set, uniaxial.redone() + general.redone()};
}

}  // namespace geom
