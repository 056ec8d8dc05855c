#pragma once

/// The kernels of distance_batch, compiled once for each instruction set (batch_kernel-inl.h).
///
/// Plain arrays only, neither Eigen nor containers: what a translation unit compiled for AVX-512 instantiates of them
/// could be linked into code for processors without it.

namespace geom::internal {

/// Pairs that a kernel answers in one call, at most, and a multiple of every vector's length.
constexpr int kBlockPairs = 32;
constexpr int kLongestVector = 8;

/// One number of each pair of a block.
using BatchRow = double[kBlockPairs];

/// Two ellipsoids. What comes before `position_a` is of the shapes alone.
struct GeneralInput {
  enum Row {
    semi_axes_a = 0,
    semi_axes_b = 3,
    depth = 6,  ///< the sum of both min_curvature_radius()
    radii = 7,  ///< the sum of both bounding radii
    position_a = 8,
    position_b = 11,
    rotation_a = 14,  ///< body to world, column by column
    rotation_b = 23,
    start = 32,  ///< as DistanceOptions::start: 0 for a cold start
    count = 35,
  };
  alignas(64) BatchRow rows[count];
};

/// Two ellipsoids of revolution, by their axes of revolution in world coordinates.
struct UniaxialInput {
  enum Row {
    along_a = 0,   ///< semi-axis along the axis of revolution
    across_a = 1,  ///< the two equal ones
    along_b = 2,
    across_b = 3,
    depth = 4,
    radii = 5,
    position_a = 6,
    position_b = 9,
    axis_a = 12,  ///< unit vector
    axis_b = 15,
    start = 18,
    count = 21,
  };
  alignas(64) BatchRow rows[count];
};

struct BatchOutput {
  enum Row {
    distance = 0,
    point_a = 1,
    point_b = 4,
    normal = 7,
    residual = 10,
    error_bound = 11,
    iterations = 12,
    answered = 13,  ///< 1: the numbers of this pair are an answer; 0: they mean nothing
    count = 14,
  };
  alignas(64) BatchRow rows[count];
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
