#pragma once

#include <geom/distance.h>
#include <geom/ellipsoid.h>
#include <geom/export.h>
#include <geom/pose.h>

#include <Eigen/Core>

#include <cstddef>
#include <span>

namespace geom {

/// What the kernel of `distance_batch` is compiled for. All of them follow one source and answer the same to rounding;
/// the bits differ.
enum class InstructionSet {
  best,      ///< the last of the following that this processor has
  portable,  ///< what the whole library is compiled for: by default any processor of the architecture
  avx2,      ///< x86-64 with AVX2 and FMA: 4 pairs at a time
  avx512,    ///< x86-64 with AVX-512 F, VL, DQ, BW: 8 pairs at a time
};

/// The enumerator's name.
GEOM_EXPORT const char* to_string(InstructionSet set);

/// Whether this build has a kernel for `set` and this processor can run it.
GEOM_EXPORT bool is_available(InstructionSet set);

/// What InstructionSet::best stands for on this processor. Results depend on it in their last bits; with avx512 also on
/// the processor's estimates of roots and inverses, of which only the error is bounded.
GEOM_EXPORT InstructionSet batch_instruction_set();

/// How `distance_batch` starts, with what, and how far it goes.
struct BatchOptions {
  /// Warm starts, DistanceOptions::start of each pair: guesses of the normals from A to B. Empty: cold starts.
  std::span<const Eigen::Vector3d> starts = {};
  InstructionSet instruction_set = InstructionSet::best;
  /// As DistanceOptions::max_iterations. The kernels leave pairs that need more evaluations to `distance`, which then
  /// spends as many again before its fallback.
  int max_iterations = kMaxIterations;
  /// As DistanceOptions::penetration. `local` spares deep overlaps the search over all normals, which takes thousands
  /// of times as long as a pair of the kernels.
  Penetration penetration = Penetration::global;
};

/// What a batch did beside answering.
struct BatchSummary {
  InstructionSet instruction_set;  ///< the one that was used; never `best`
  std::size_t redone;              ///< pairs that went to `distance`, see there
};

/// results[i] = distance(a[i], X_WA[i], b[i], X_WB[i], {.start = options.starts[i], .max_iterations =
/// options.max_iterations, .penetration = options.penetration}), many pairs at a time.
///
/// Each of the four input spans holds one element a pair, or a single one that serves all pairs: equal bodies, or one
/// body against many. Throws std::invalid_argument, before anything is computed, if the size of a span is neither 1 nor
/// results.size(), if `starts` is neither empty nor of that size, or if `instruction_set` is not available.
///
/// Same answers as `distance`: the distance within 1e-14 of the pair's size (|p_AB| + both bounding radii), the same
/// status (but for touching bodies, whose distance may round to either sign), the same certificates. An answer does not
/// depend on the other pairs, not in its last bit. What the kernels do not answer goes to `distance`: overlaps deeper
/// than the sum of both bodies' `min_curvature_radius`, pairs that need many evaluations or a last step more, and those
/// whose numbers over- or underflow (bodies beyond 1e-25 ... 1e25); `iterations` then counts the evaluations there.
/// Never allocates.
GEOM_EXPORT BatchSummary distance_batch(std::span<const Ellipsoid> a, std::span<const Pose> X_WA,
                                        std::span<const Ellipsoid> b, std::span<const Pose> X_WB,
                                        std::span<DistanceResult> results, const BatchOptions& options = {});

}  // namespace geom
