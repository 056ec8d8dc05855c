#pragma once

/// Kernels of distance_batch, compiled once for each instruction set (batch/kernel-inl.h).
///
/// They use plain arrays only, neither Eigen nor containers: a template that a translation unit compiled for AVX-512
/// instantiates could be linked into code for processors without it.

namespace geom::kernel {

/// Maximum number of pairs that a kernel answers in one call, and a multiple of every vector's length.
constexpr int kBlockPairs = 32;
constexpr int kLongestVector = 8;

/// Row of one number of each pair of a block.
using BatchRow = double[kBlockPairs];

/// Addresses of consecutive numbers of each pair.
using BatchRecords = const double* [kBlockPairs];

/// Input of pairs of two ellipsoids.
struct GeneralInput {
  enum Row {
    depth = 0,  ///< the sum of both min_curvature_radius()
    count = 1,
  };
  alignas(64) BatchRow rows[count];
  BatchRecords semi_axes_a, semi_axes_b;
  BatchRecords position_a, position_b;
  BatchRecords rotation_a, rotation_b;  ///< rotations, body to world, column by column
  BatchRecords start;                   ///< see DistanceOptions::start
  bool has_starts;                      ///< false: cold starts for all pairs
};

/// Input of pairs of two ellipsoids of revolution, by their axes of revolution in world coordinates.
struct UniaxialInput {
  enum Row {
    along_a = 0,   ///< semi-axis along the axis of revolution
    across_a = 1,  ///< the two equal semi-axes
    along_b = 2,
    across_b = 3,
    depth = 4,
    count = 5,
  };
  alignas(64) BatchRow rows[count];
  BatchRecords position_a, position_b;
  BatchRecords axis_a, axis_b;  ///< unit vectors along the axes of revolution
  BatchRecords start;
  bool has_starts;
};

/// Records of four numbers of each pair, pair after pair.
using BatchRecord = double[kBlockPairs][4];

struct BatchOutput {
  enum Record {
    distance_and_point_a = 0,
    point_b_and_residual = 1,
    normal_and_error_bound = 2,
    count = 3,
  };
  alignas(64) BatchRecord records[count];
  /// Number of evaluations; 0 if the pair was not answered: its other numbers are meaningless.
  alignas(64) double iterations[kBlockPairs];
};

/// Functions that answer the first `pairs` pairs; up to the next multiple of kLongestVector the input must hold valid
/// pairs too.
struct BatchKernels {
  void (*general)(const GeneralInput& in, int pairs, BatchOutput& out);
  void (*uniaxial)(const UniaxialInput& in, int pairs, BatchOutput& out);
};

/// Returns the kernels of one instruction set.
BatchKernels batch_kernels_portable();
BatchKernels batch_kernels_avx2();
BatchKernels batch_kernels_avx512();

}  // namespace geom::kernel
