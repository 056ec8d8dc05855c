#pragma once

/// First looks: contact searches with one evaluation each, for many pairs at once.

#include "bodies/pair.h"
#include "contact/certified.h"

#include <geom/batch.h>

#include <span>

namespace ed::internal {

/// A pair whose contact search is wanted, and its result.
struct PairLook {
  Pair* pair;
  double end;  ///< end of the search
  bool answered = false;
  Finding finding{};
};

/// `Bodies`: UniaxialBodies or GeneralBodies.
template <class Bodies>
class FirstLooks {
 public:
  virtual ~FirstLooks() = default;

  /// Searches where it can, sets finding and normal, and counts, all as certified_contact with one evaluation does, bit
  /// for bit. The other looks stay unanswered. Pairs are in the nearest image.
  virtual void take(const Bodies& bodies, double now, double box, std::span<PairLook> looks, FinderCounters& count) = 0;

  /// Uses the kernels of an instruction set from now on.
  virtual void use(const Bodies& bodies, geom::InstructionSet set) = 0;
};

}  // namespace ed::internal
