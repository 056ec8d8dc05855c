#pragma once

/// Envelopes and first looks for the kind of bodies that a loop holds.

#include "bodies/first_looks.h"
#include "bodies/general.h"
#include "bodies/uniaxial.h"
#include "neighbours/envelopes.h"

#include <ed/simulation.h>

#include <memory>

namespace ed::internal {

/// Makes envelopes of this thickness, or of the nearest thickness that the box allows.
std::unique_ptr<Envelopes<UniaxialBodies>> make_envelopes(const UniaxialBodies& bodies,
                                                          const SimulationOptions& options, double thickness,
                                                          double exit_share, double box);
std::unique_ptr<Envelopes<GeneralBodies>> make_envelopes(const GeneralBodies& bodies, const SimulationOptions& options,
                                                         double thickness, double exit_share, double box);

/// Makes the vector code of first looks; null if pairs are to be looked at one by one.
std::unique_ptr<FirstLooks<UniaxialBodies>> make_first_looks(const UniaxialBodies& bodies,
                                                             const SimulationOptions& options);
std::unique_ptr<FirstLooks<GeneralBodies>> make_first_looks(const GeneralBodies& bodies,
                                                            const SimulationOptions& options);

}  // namespace ed::internal
