#pragma once

/// First looks at bodies of revolution, in vectors. They take most of an event loop's time
/// (docs/decisions/014-first-looks.md).

#include "bodies/first_looks.h"
#include "bodies/uniaxial.h"
#include "vectors/kernels.h"

#include <optional>
#include <span>
#include <vector>

namespace ed::internal {

class UniaxialLooks final : public FirstLooks<UniaxialBodies> {
 public:
  /// `batches`: instruction set of the kernels, of which there is one for at least one family of pairs.
  UniaxialLooks(const UniaxialBodies& bodies, const std::optional<geom::InstructionSet>& batches);

  /// Returns whether vector kernels look at pairs of some family of these bodies.
  static bool serve(const UniaxialBodies& bodies, const std::optional<geom::InstructionSet>& batches);

  void take(const UniaxialBodies& bodies, double now, double box, std::span<PairLook> looks,
            FinderCounters& count) override;
  void use(const UniaxialBodies& bodies, geom::InstructionSet set) override;

 private:
  /// Looks at the pairs of one family; these share a kernel and the layout of the rows.
  struct Family {
    UniaxialFamily pairs;
    LookKernel* kernel;
    LookInput in;
  };

  static LookKernel* kernel_of(const UniaxialBodies& bodies, const std::optional<geom::InstructionSet>& batches,
                               UniaxialFamily pairs);
  void take(const UniaxialBodies& bodies, Family& family, std::span<PairLook> looks, FinderCounters& count);
  void put(const UniaxialBodies& bodies, Family& family, const PairLook& look, int lane);
  void read(int lane, PairLook& look, FinderCounters& count) const;

  std::vector<Family> families_;  ///< families that have kernels
  bool closed_forms_;             ///< rods, among which spheres are that meet in closed form
  bool one_kind_;                 ///< rows of the only kind are in all lanes
  bool mixed_;                    ///< pairs are of several families
  LookOutput out_;
};

}  // namespace ed::internal
