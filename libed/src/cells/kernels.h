#pragma once

/// The kernel of linked cells, compiled once for each instruction set (cell_kernels-inl.h). Plain arrays only, as in
/// uniaxial_kernels.h, which says why: kernels make no CellBlock.

#include <cstdint>
#include <limits>

namespace ed::internal {

constexpr int kCellBlock = 4;

/// Some bodies of a cell, a number of each in a row: two cache lines.
struct alignas(64) CellBlock {
  /// As a NearBody begins.
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
  /// Nothing is near an infinite place.
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

/// Of the bodies in these blocks, in their order, those within reach: body and vector to its nearest image, as in
/// NearBody, one after another from `near` on. Returns how many. There must be room for kCellBlock * count.
using CellKernel = int(const CellQuery& query, const CellBlock* blocks, const int* which, int count, double* near);

CellKernel* cell_kernel_portable();
CellKernel* cell_kernel_avx2();
CellKernel* cell_kernel_avx512();

}  // namespace ed::internal
