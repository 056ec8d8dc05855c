#pragma once

/// First looks at bodies of revolution, in vectors. They take most of an event loop's time
/// (docs/decisions/014-first-looks.md).

#include "bodies/first_looks.h"
#include "bodies/uniaxial.h"
#include "vectors/kernels.h"

#include <span>

namespace ed::internal {

class UniaxialLooks final : public FirstLooks<UniaxialBodies> {
 public:
  UniaxialLooks(const UniaxialBodies& bodies, const FamilyKernels& kernels);

  void take(const UniaxialBodies& bodies, double now, double box, std::span<PairLook> looks,
            FinderCounters& count) override;
  void use(const UniaxialBodies& bodies, geom::InstructionSet set) override;

 private:
  static LookKernel* kernel_of(const UniaxialBodies& bodies, const FamilyKernels& kernels) {
    return bodies.spins() ? kernels.look_spinning : kernels.look_across;
  }
  void put(const UniaxialBodies& bodies, const PairLook& look, int lane);
  void read(int lane, PairLook& look, FinderCounters& count) const;

  LookKernel* kernel_;
  bool closed_forms_;  ///< rods, among which spheres are that meet in closed form
  bool one_kind_;      ///< rows of the only kind are in all lanes
  LookInput in_;
  LookOutput out_;
};

}  // namespace ed::internal
