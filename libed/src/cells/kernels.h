#pragma once

/// Kernel of linked cells, compiled once for each instruction set (cells/kernels-inl.h). It uses plain arrays only, for
/// the reason given in vectors/kernels.h: kernels construct no CellBlock.

#include <cstdint>
#include <limits>

namespace ed::internal {

constexpr int kCellBlock = 4;

/// Block of bodies of a cell, in rows of one number of each: two cache lines.
struct alignas(64) CellBlock {
  /// Layout of the beginning of a NearBody.
  struct alignas(8) Name {
    std::int32_t body;
    std::int32_t none;
  };

  double x[kCellBlock];
  double y[kCellBlock];
  double z[kCellBlock];
  Name name[kCellBlock];

  CellBlock() {
    for (int lane = 0; lane < kCellBlock; ++lane) clear(lane);
  }
  /// Empties a lane: nothing is near an infinite position.
  void clear(int lane) {
    x[lane] = y[lane] = z[lane] = std::numeric_limits<double>::infinity();
    name[lane] = {-1, 0};
  }
};
static_assert(sizeof(CellBlock) == 128);

struct CellQuery {
  double x, y, z;
  double box;
  double reach2;
};

/// Finds the bodies in these blocks, in their order, that are within reach. Writes body and vector to its nearest
/// image, as in NearBody, one after another from `near` on, and returns their number. `near` must have room for
/// kCellBlock * count.
using CellKernel = int(const CellQuery& query, const CellBlock* blocks, const int* which, int count, double* near);

CellKernel* cell_kernel_portable();
CellKernel* cell_kernel_avx2();
CellKernel* cell_kernel_avx512();

}  // namespace ed::internal
