#pragma once

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace geom {

/// Instruction set that the kernel of `distance_batch` is compiled for. All kernels are compiled from one source and
/// agree to rounding; their bits differ.
enum class InstructionSet {
  best,      ///< best available instruction set of this processor
  portable,  ///< instruction set of the whole library: by default any processor of the architecture
  avx2,      ///< x86-64 with AVX2 and FMA: 4 pairs at a time
  avx512,    ///< x86-64 with AVX-512 F, VL, DQ, BW: 8 pairs at a time
};

/// Returns the enumerator's name.
GEOM_EXPORT const char* to_string(InstructionSet set);

/// Returns whether this build has a kernel for `set` and this processor can run it.
GEOM_EXPORT bool is_available(InstructionSet set);

/// Returns the instruction set that InstructionSet::best stands for on this processor. The last bits of results depend
/// on it; with avx512 they also depend on the processor's estimates of roots and inverses, of which only the error is
/// bounded.
GEOM_EXPORT InstructionSet batch_instruction_set();

/// Warm starts, instruction set and limits of `distance_batch`.
struct BatchOptions {
  /// Warm starts, the DistanceOptions::start of each pair: guesses of the normals from A to B. Empty: cold starts.
  std::span<const Eigen::Vector3d> starts = {};
  InstructionSet instruction_set = InstructionSet::best;
  /// Maximum number of evaluations, see DistanceOptions::max_iterations. The kernels leave pairs that need more to
  /// `distance`, which then spends as many again before its fallback.
  int max_iterations = kMaxIterations;
  /// Treatment of overlaps, see DistanceOptions::penetration. With `local`, deep overlaps avoid the search over all
  /// normals, which takes thousands of times as long as a pair in the kernels.
  Penetration penetration = Penetration::global;
};

/// Statistics of a batch.
struct BatchSummary {
  InstructionSet instruction_set;  ///< instruction set used; never `best`
  std::size_t redone;              ///< number of pairs that went to `distance`, see there
};

/// Computes results[i] = distance(a[i], X_WA[i], b[i], X_WB[i], {.start = options.starts[i], .max_iterations =
/// options.max_iterations, .penetration = options.penetration}), many pairs at a time.
///
/// Each of the four input spans holds one element a pair, or a single one that serves all pairs: equal bodies, or one
/// body against many. Throws std::invalid_argument, before anything is computed, if the size of a span is neither 1 nor
/// results.size(), if `starts` is neither empty nor of that size, or if `instruction_set` is not available.
///
/// The answers agree with those of `distance`: the distance within 1e-14 of the pair's size (|p_AB| + both bounding
/// radii), the same status (except for touching bodies, whose distance may round to either sign), the same
/// certificates. An answer does not depend on the other pairs, not even in its last bit. Pairs that the kernels do not
/// answer go to `distance`: overlaps deeper than the sum of both bodies' `min_curvature_radius`, pairs that need many
/// evaluations or one more last step, and those whose numbers over- or underflow (bodies beyond 1e-25 ... 1e25);
/// `iterations` then counts the evaluations there. Never allocates.
GEOM_EXPORT BatchSummary distance_batch(std::span<const Ellipsoid> a, std::span<const Pose> X_WA,
                                        std::span<const Ellipsoid> b, std::span<const Pose> X_WB,
                                        std::span<DistanceResult> results, const BatchOptions& options = {});

/// Pair of ellipsoids by reference: bodies in many pairs are stored once.
struct EllipsoidPair {
  const Ellipsoid* a;
  const Pose* X_WA;
  const Ellipsoid* b;
  const Pose* X_WB;
};

/// Overload for pairs by reference. Throws std::invalid_argument unless there are as many pairs as results.
GEOM_EXPORT BatchSummary distance_batch(std::span<const EllipsoidPair> pairs, std::span<DistanceResult> results,
                                        const BatchOptions& options = {});

}  // namespace geom
