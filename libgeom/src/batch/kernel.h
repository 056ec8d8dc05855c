#pragma once

/// The kernels of distance_batch, compiled once for each instruction set (batch_kernel-inl.h).
///
/// Plain arrays only, neither Eigen nor containers: what a translation unit compiled for AVX-512 instantiates of them
/// could be linked into code for processors without it.

namespace geom::kernel {

/// Pairs that a kernel answers in one call, at most, and a multiple of every vector's length.
constexpr int kBlockPairs = 32;
constexpr int kLongestVector = 8;

/// One number of each pair of a block.
using BatchRow = double[kBlockPairs];

/// Where some numbers of each pair stand, one after the other.
using BatchRecords = const double* [kBlockPairs];

/// Two ellipsoids.
struct GeneralInput {
  enum Row {
    depth = 0,  ///< the sum of both min_curvature_radius()
    count = 1,
  };
  alignas(64) BatchRow rows[count];
  BatchRecords semi_axes_a, semi_axes_b;
  BatchRecords position_a, position_b;
  BatchRecords rotation_a, rotation_b;  ///< body to world, column by column
  BatchRecords start;                   ///< as DistanceOptions::start
  bool has_starts;                      ///< else all are 0, cold
};

/// Two ellipsoids of revolution, by their axes of revolution in world coordinates.
struct UniaxialInput {
  enum Row {
    along_a = 0,   ///< semi-axis along the axis of revolution
    across_a = 1,  ///< the two equal ones
    along_b = 2,
    across_b = 3,
    depth = 4,
    count = 5,
  };
  alignas(64) BatchRow rows[count];
  BatchRecords position_a, position_b;
  BatchRecords axis_a, axis_b;  ///< unit vectors
  BatchRecords start;
  bool has_starts;
};

/// Four numbers of each pair, pair after pair.
using BatchRecord = double[kBlockPairs][4];

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

}  // namespace geom::kernel
