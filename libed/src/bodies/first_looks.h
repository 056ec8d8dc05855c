#pragma once

/// First looks: what a contact search finds with one evaluation, at many pairs at once.

#include "bodies/pair.h"
#include "contact/certified.h"

#include <span>

namespace ed::internal {

/// A pair to look at now, and what was found.
struct PairLook {
  Pair* pair;
  double end;  ///< of the search
  bool answered = false;
  Finding finding{};
};

/// `Bodies`: UniaxialBodies or GeneralBodies.
template <class Bodies>
class FirstLooks {
 public:
  virtual ~FirstLooks() = default;

  /// Answers the looks that it can, setting finding and normal, and counts them, all as certified_contact with one
  /// evaluation does, bit for bit. The others are left as they are. Centres are as far apart as nearest images are.
  virtual void take(const Bodies& bodies, double now, double box, std::span<PairLook> looks, FinderCounters& count) = 0;
};

}  // namespace ed::internal
