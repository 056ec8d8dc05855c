#pragma once

/// Rotations of bodies of revolution, several at a time, compiled once for each instruction set
/// (bodies/rotations-inl.h). Plain arrays only, as in vectors/kernels.h.

namespace ed::internal {

inline constexpr int kRotationsAtATime = 16;  ///< bodies of a call of the kernel

/// Rotations of bodies, component by component; members as in UniaxialInertia, AxisMotion and BodyFrame.
struct alignas(64) RotationRows {
  using Row = double[kRotationsAtATime];

  Row dt;  ///< time since that of the motion
  Row rate;
  Row perpendicular, axial, spin;  ///< used only of bodies that spin
  Row e0[3], e1[3], e2[3];
  Row momentum_dir[3], x_axis[3];
  Row phi_lab[3], phi_body[2];

  Row axis[3], omega[3];  ///< results, as in SampledRotation; the others take the places of phi_lab and phi_body
};

/// Sets axis, omega, phi_lab and phi_body to what sampled() returns of bodies that spin, or of those that do not, with
/// the same bits where dt is not 0 and (|rate| + |spin|) |dt| is at most kLargestAngle; others are no numbers to be
/// used.
using RotationKernel = void(RotationRows& bodies, bool spins);

RotationKernel* rotation_kernel_portable();
RotationKernel* rotation_kernel_avx2();
RotationKernel* rotation_kernel_avx512();

/// Returns the kernel of the fastest instruction set there is. All give the same bits.
RotationKernel* find_rotation_kernel();

}  // namespace ed::internal
