#pragma once

/// Which kernels to use, and how numbers get into their rows.

#include "cell_kernels.h"
#include "uniaxial_kernels.h"

#include <geom/batch.h>
#include <geom/internal/uniaxial.h>

#include <Eigen/Core>

#include <optional>

namespace ed::internal {

/// `batches`: as SimulationOptions has it. None for `best` where that would be vectors of one lane: they are slower
/// than one pair at a time. Throws std::invalid_argument if the processor or the build does not have the instruction
/// set.
UniaxialKernels find_uniaxial_kernels(const std::optional<geom::InstructionSet>& batches);

/// Of the same instruction set; that of the whole library for none. Throws as find_uniaxial_kernels.
CellKernel* find_cell_kernel(const std::optional<geom::InstructionSet>& batches);

template <class Row>
void put_vector(const Eigen::Vector3d& v, Row* rows, int lane) {
  for (int k = 0; k < 3; ++k) rows[k][lane] = v[k];
}

template <class Row>
void put_shape(const geom::internal::Spheroid& shape, Row* rows, int lane) {
  rows[ShapeRows::a2][lane] = shape.a2;
  rows[ShapeRows::b2][lane] = shape.b2;
  rows[ShapeRows::c][lane] = shape.c;
  rows[ShapeRows::rho][lane] = shape.rho;
}

}  // namespace ed::internal
