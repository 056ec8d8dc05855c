#pragma once

/// The kernels of distance_batch, compiled once for each instruction set (batch_kernel-inl.h).
///
/// Plain arrays only, neither Eigen nor containers: what a translation unit compiled for AVX-512 instantiates of them
/// could be linked into code for processors without it.

namespace geom::internal {

/// Pairs that a kernel answers in one call, at most, and a multiple of every vector's length.
constexpr int kBlockPairs = 32;
constexpr int kLongestVector = 8;

/// Four numbers of each pair of a block, pair after pair: they are copied as they lie, and only the kernels turn them
/// into vectors of one number each.
using BatchRecord = double[4 * kBlockPairs];

/// Two ellipsoids. What comes before `pose_a` is of the shapes alone.
struct GeneralInput {
  enum Record {
    shape_a = 0,  ///< semi-axes, min_curvature_radius()
    shape_b = 1,
    pose_a = 2,  ///< body to world: the rotation, column by column, and the position; three records
    pose_b = 5,
    start = 8,  ///< as DistanceOptions::start: 0 for a cold start
    count = 9,
  };
  alignas(64) BatchRecord records[count];
};

/// Two ellipsoids of revolution, by their axes of revolution in world coordinates.
struct UniaxialInput {
  enum Record {
    shape_a = 0,  ///< semi-axis along the axis of revolution, the two equal ones, min_curvature_radius()
    shape_b = 1,
    axis_a = 2,  ///< unit vector
    axis_b = 3,
    position_a = 4,
    position_b = 5,
    start = 6,
    count = 7,
  };
  alignas(64) BatchRecord records[count];
};

struct BatchOutput {
  enum Record {
    distance_and_point_a = 0,
    point_b_and_residual = 1,
    normal_and_error_bound = 2,
    count = 3,
  };
  alignas(64) BatchRecord records[count];
  /// Evaluations; 0 where the pair was not answered: its numbers mean nothing.
  alignas(64) double iterations[kBlockPairs];
};

/// Answer the first `pairs` pairs; up to the next multiple of kLongestVector the input must hold valid pairs too.
struct BatchKernels {
  void (*general)(const GeneralInput& in, int pairs, BatchOutput& out);
  void (*uniaxial)(const UniaxialInput& in, int pairs, BatchOutput& out);
};

/// Of one instruction set each.
BatchKernels batch_kernels_portable();
BatchKernels batch_kernels_avx2();
BatchKernels batch_kernels_avx512();

}  // namespace geom::internal
