#pragma once

/// The kernels of bodies of revolution, compiled once for each instruction set (vectors/kernels-inl.h).
///
/// Plain arrays only, neither Eigen nor containers: what a translation unit compiled for AVX-512 instantiates of them
/// could be linked into code for processors without it.

#include <cstddef>
#include <cstdint>

namespace ed::internal {

constexpr int kLongestVector = 8;

/// Rows of a shape, as in Spheroid.
struct ShapeRows {
  enum Row { a2 = 0, b2 = 1, c = 2, rho = 3, count = 4 };
};

/// Rows of a capsule or a sphere, as in Rod.
struct RodRows {
  enum Row { half_length = 0, radius = 1 };
};

/// A shape, in the order of its rows.
struct ShapeNumbers {
  double numbers[ShapeRows::count];
};

// ---- First looks: certified_contact with one evaluation ------------------------------------------------------------

/// Largest number of pairs in one call; a multiple of every vector's length.
constexpr int kBlockLooks = 48;

/// One number of each pair of a block.
using LookRow = double[kBlockLooks];

/// The numbers of an AxisMotion, one after the other.
struct LookBody {
  enum Number {
    position = 0,
    velocity = 3,
    e1 = 6,
    e2 = 9,
    rate = 12,
    time = 13,
    e0 = 14,  ///< read of bodies that spin only
  };
};

struct LookInput {
  enum Row {
    shape_a = 0,
    shape_b = ShapeRows::count,
    turning_limit_a = 2 * ShapeRows::count,  ///< turning limits, as in Spheroid; not read of rods
    turning_limit_b,
    reach,  ///< the sum of both bounding radii
    end,    ///< end of the search
    count,
  };
  alignas(64) LookRow rows[count];
  // Where each lane's numbers stand.
  const double* body_a[kBlockLooks];
  const double* body_b[kBlockLooks];
  const double* normal[kBlockLooks];  ///< three numbers of the unit normal from A to B
  double now;
  double box;
};

struct LookOutput {
  enum Row {
    verdict = 0,
    time = 1,          ///< time of a bound or a contact
    kernel_calls = 2,  ///< 0: the bounding spheres do not meet; 1: the normal is as it was, but for a contact
    normal = 3,
    count = 6,
  };
  /// Values of `verdict`.
  static constexpr double open = 0;  ///< unanswered: the other rows mean nothing
  static constexpr double clear = 1;
  static constexpr double bound = 2;
  static constexpr double contact = 3;
  alignas(64) LookRow rows[count];
};

/// Answers the first pairs of a block; up to the next multiple of kLongestVector the input must hold valid pairs too.
using LookKernel = void(const LookInput& in, int pairs, LookOutput& out);

// ---- Overlaps: whether dilated envelopes may overlap ----------------------------------------------------------------

/// Largest number of bodies in one call.
constexpr int kBlockOverlaps = 64;

/// Dilated envelope of a body. Half of its cache line is what kernels read, the other half is for exit_time alone.
struct alignas(64) DilatedEnvelope {
  double axis[3];
  std::int32_t kind;
  std::int32_t none;  ///< 0: kernels read it with the kind, as one number
  double centre[3];
};

static_assert(offsetof(DilatedEnvelope, kind) == 3 * sizeof(double));

struct OverlapInput {
  const void* near;                  ///< NearBodys
  int count;                         ///< number of them
  const DilatedEnvelope* envelopes;  ///< envelopes of all bodies
  const ShapeNumbers* shapes;        ///< shapes of all kinds
  bool one_kind;
  std::int32_t one;    ///< body whose envelope the others may overlap; itself it is left out
  std::int32_t first;  ///< number of the first body that counts
  double limit;        ///< gap above which envelopes are apart
};

/// Results in the order of the bodies, without those that were told apart at once.
struct OverlapOutput {
  enum Row { verdict = 0, normal = 1, rows_count = 4 };
  static constexpr double open = 0;  ///< unanswered
  static constexpr double apart = 1;
  static constexpr double overlapping = 2;
  int count;
  int place[kBlockOverlaps];  ///< place among the NearBodys
  alignas(64) double rows[rows_count][kBlockOverlaps];
};

using OverlapKernel = void(const OverlapInput& in, OverlapOutput& out);

// ---------------------------------------------------------------------------------------------------------------------

/// Kernels of one instruction set for bodies of one family; null if pairs are to be answered one by one.
struct FamilyKernels {
  LookKernel* look_across = nullptr;    ///< kernel for bodies that turn about axes across their own (e0 = 0)
  LookKernel* look_spinning = nullptr;  ///< kernel for bodies that spin
  OverlapKernel* overlap = nullptr;
};

/// Kernels of one instruction set.
struct UniaxialKernels {
  FamilyKernels spheroids;
  FamilyKernels rods;
  FamilyKernels spheres;  ///< kernels for rods that are all spheres
};

/// Return the kernels of one instruction set each.
UniaxialKernels uniaxial_kernels_portable();
UniaxialKernels uniaxial_kernels_avx2();
UniaxialKernels uniaxial_kernels_avx512();

}  // namespace ed::internal
