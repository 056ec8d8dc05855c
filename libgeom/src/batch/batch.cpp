#include "batch/checks.h"
#include "batch/kernel.h"

#include <geom/batch.h>
#include <geom/kernel/refuse.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <optional>
#include <sstream>
#include <string>
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
#ifdef __x86_64__
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

/// Pair of bodies, and the index of their answer.
struct Pair : EllipsoidPair {
  std::size_t index;

  double depth() const { return a->min_curvature_radius() + b->min_curvature_radius(); }
};

/// Warm starts and limits of a batch, and the destination of its answers.
struct Query {
  std::span<const Eigen::Vector3d> starts;
  std::span<DistanceResult> results;
  DistanceOptions scalar;

  DistanceResult by_distance(const Pair& pair) const {
    DistanceOptions options = scalar;
    if (!starts.empty()) options.start = starts[pair.index];
    return distance(*pair.a, *pair.X_WA, *pair.b, *pair.X_WB, options);
  }
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
        result = query_.by_distance(pairs_[lane]);
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

namespace {

/// Answers the pairs that next() returns, one a call, in the order of the results.
template <class Next>
BatchSummary answer(std::span<DistanceResult> results, const BatchOptions& options, Next next) {
  kernel::check_starts(options, results.size());
  const InstructionSet set = kernel::chosen(options.instruction_set);
  const BatchKernels kernels = find_kernels(set);
  const Query query{options.starts, results, kernel::scalar_options(options)};
  Block<UniaxialInput> uniaxial(query, kernels.uniaxial);
  Block<GeneralInput> general(query, kernels.general);
  for (std::size_t index = 0; index < results.size(); ++index) {
    const EllipsoidPair pair = next();
    if (pair.a->symmetry_axis() && pair.b->symmetry_axis()) {
      uniaxial.add({pair, index});
    } else {
      general.add({pair, index});
    }
  }
  uniaxial.flush();
  general.flush();
  return {set, uniaxial.redone() + general.redone()};
}

}  // namespace

BatchSummary distance_batch(std::span<const Ellipsoid> a, std::span<const Pose> X_WA, std::span<const Ellipsoid> b,
                            std::span<const Pose> X_WB, std::span<DistanceResult> results,
                            const BatchOptions& options) {
  const std::size_t pairs = results.size();
  const Input<Ellipsoid> in_a = checked("a", a, pairs), in_b = checked("b", b, pairs);
  const Input<Pose> in_X_WA = checked("X_WA", X_WA, pairs), in_X_WB = checked("X_WB", X_WB, pairs);
  EllipsoidPair next{in_a.data, in_X_WA.data, in_b.data, in_X_WB.data};
  return answer(results, options, [&] {
    const EllipsoidPair pair = next;
    next.a += in_a.stride;
    next.X_WA += in_X_WA.stride;
    next.b += in_b.stride;
    next.X_WB += in_X_WB.stride;
    return pair;
  });
}

BatchSummary distance_batch(std::span<const EllipsoidPair> pairs, std::span<DistanceResult> results,
                            const BatchOptions& options) {
  if (pairs.size() != results.size()) {
    kernel::refuse("distance_batch: pairs has " + std::to_string(pairs.size()) +
                   " elements; accepted: as many as results, which has " + std::to_string(results.size()));
  }
  return answer(results, options, [next = pairs.data()]() mutable { return *next++; });
}

}  // namespace geom
