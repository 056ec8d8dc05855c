/// Kernel of linked cells.
///
/// Included once by each cells/kernels_*.cpp, which sets HARDBODY_CELL_KERNEL, the function's name, and is compiled for
/// its own instruction set. All give the bits of nearest_image (periodic.h).

#include "base/highway-inl.h"
#include "cells/kernels.h"

#include <cstddef>
#include <cstdint>

HWY_BEFORE_NAMESPACE();
namespace ed::internal {
namespace {

namespace hn = hwy::HWY_NAMESPACE;
using CellTag = hn::CappedTag<double, kCellBlock>;
using CellReal = hn::Vec<CellTag>;

constexpr int kCellLanes = static_cast<int>(HWY_MIN(HWY_LANES(double), kCellBlock));
static_assert(kCellBlock % kCellLanes == 0);

struct CellScales {
  CellReal box, inverse;
};

HWY_INLINE CellReal image(const double* row, CellReal from, const CellScales& scales) {
  const auto shift = hn::Set(CellTag(), 6755399441055744.0);  // see nearest_integer
  const auto d = hn::Sub(hn::Load(CellTag(), row), from);
  const auto boxes = hn::Sub(hn::Add(hn::Mul(d, scales.inverse), shift), shift);
  return hn::Sub(d, hn::Mul(scales.box, boxes));
}

/// Writes every lane, one body after the other, and advances only past those of `within`: which lanes these are is not
/// predictable.
HWY_INLINE std::ptrdiff_t keep(CellReal name, CellReal x, CellReal y, CellReal z, unsigned within, double* near) {
  const CellTag tag;
  std::ptrdiff_t found = 0;
#if HWY_MAX_BYTES >= 16 && HWY_TARGET != HWY_SCALAR
  const auto next = [&](unsigned lane) { found += static_cast<std::ptrdiff_t>((within >> lane) & 1U); };
  const auto even_nx = hn::InterleaveLower(tag, name, x);
  const auto even_yz = hn::InterleaveLower(tag, y, z);
  const auto odd_nx = hn::InterleaveUpper(tag, name, x);
  const auto odd_yz = hn::InterleaveUpper(tag, y, z);
#if HWY_MAX_BYTES >= 32
  static_assert(kCellLanes == 4);
  hn::StoreU(hn::ConcatLowerLower(tag, even_yz, even_nx), tag, near);
  next(0);
  hn::StoreU(hn::ConcatLowerLower(tag, odd_yz, odd_nx), tag, near + 4 * found);
  next(1);
  hn::StoreU(hn::ConcatUpperUpper(tag, even_yz, even_nx), tag, near + 4 * found);
  next(2);
  hn::StoreU(hn::ConcatUpperUpper(tag, odd_yz, odd_nx), tag, near + 4 * found);
  next(3);
#else
  static_assert(kCellLanes == 2);
  hn::StoreU(even_nx, tag, near);
  hn::StoreU(even_yz, tag, near + 2);
  next(0);
  hn::StoreU(odd_nx, tag, near + 4 * found);
  hn::StoreU(odd_yz, tag, near + 4 * found + 2);
  next(1);
#endif
#else
  static_assert(kCellLanes == 1);
  hn::StoreU(name, tag, near);
  hn::StoreU(x, tag, near + 1);
  hn::StoreU(y, tag, near + 2);
  hn::StoreU(z, tag, near + 3);
  found += static_cast<std::ptrdiff_t>(within & 1U);
#endif
  return found;
}

int find_near(const CellQuery& query, const CellBlock* blocks, const int* which, int count, double* near) {
  const CellTag tag;
  const CellReal px = hn::Set(tag, query.x);
  const CellReal py = hn::Set(tag, query.y);
  const CellReal pz = hn::Set(tag, query.z);
  const CellScales scales{hn::Set(tag, query.box), hn::Set(tag, 1 / query.box)};
  const CellReal reach2 = hn::Set(tag, query.reach2);
  std::ptrdiff_t found = 0;
  for (int k = 0; k < count; ++k) {
    const CellBlock& block = blocks[which[k]];
    for (int lane = 0; lane < kCellBlock; lane += kCellLanes) {
      const CellReal x = image(block.x + lane, px, scales);
      const CellReal y = image(block.y + lane, py, scales);
      const CellReal z = image(block.z + lane, pz, scales);
      const CellReal r2 = hn::Add(hn::Mul(x, x), hn::Add(hn::Mul(y, y), hn::Mul(z, z)));
      alignas(8) std::uint8_t within[8] = {};
      hn::StoreMaskBits(tag, hn::Le(r2, reach2), within);
      const CellReal name = hn::Load(tag, reinterpret_cast<const double*>(block.name + lane));
      found += keep(name, x, y, z, within[0], near + 4 * found);
    }
  }
  return static_cast<int>(found);
}

}  // namespace

CellKernel* HARDBODY_CELL_KERNEL() {
  return find_near;
}

}  // namespace ed::internal
HWY_AFTER_NAMESPACE();
