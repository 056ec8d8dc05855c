#include "loop/factory.h"

#include "bodies/uniaxial_looks.h"
#include "neighbours/cell.h"
#include "neighbours/dilated.h"
#include "neighbours/general.h"
#include "neighbours/limits.h"
#include "neighbours/oriented.h"

#include <algorithm>

namespace ed::internal {
namespace {

/// Returns a thickness of dilated envelopes that is possible in this box, as near to the wanted one as can be.
template <class Bodies>
double possible_thickness(const Bodies& bodies, double wanted, double box) {
  const double thinnest = kThinnestEnvelope * bodies.bounding_radius();
  return std::clamp(wanted, thinnest, std::max(thinnest, thickest_envelope(box, bodies.bounding_radius())));
}

}  // namespace

std::unique_ptr<Envelopes<UniaxialBodies>> make_envelopes(const UniaxialBodies& bodies,
                                                          const SimulationOptions& options, double thickness,
                                                          double exit_share, double box) {
  switch (options.neighbours) {
    case Neighbours::dilated:
      thickness = possible_thickness(bodies, thickness, box);
      return std::make_unique<DilatedEnvelopes>(bodies, thickness, exit_share * thickness,
                                                bodies.kernels(options.batches).overlap);
    case Neighbours::obp:
      return std::make_unique<OrientedEnvelopes>(bodies, std::min(thickness, thickest_oriented_envelope(bodies, box)));
    case Neighbours::cells:
      break;
  }
  return std::make_unique<CellEnvelopes<UniaxialBodies>>(bodies.number(), box, bodies.bounding_radius());
}

std::unique_ptr<FirstLooks<UniaxialBodies>> make_first_looks(const UniaxialBodies& bodies,
                                                             const SimulationOptions& options) {
  // Cells have images of their own.
  if (options.contact.finder != Finder::certified || options.neighbours == Neighbours::cells) return nullptr;
  if (!UniaxialLooks::serve(bodies, options.batches)) return nullptr;
  return std::make_unique<UniaxialLooks>(bodies, options.batches);
}

std::unique_ptr<Envelopes<GeneralBodies>> make_envelopes(const GeneralBodies& bodies, const SimulationOptions& options,
                                                         double thickness, double exit_share, double box) {
  switch (options.neighbours) {
    case Neighbours::dilated:
      thickness = possible_thickness(bodies, thickness, box);
      return std::make_unique<GeneralDilatedEnvelopes>(bodies, thickness, exit_share * thickness);
    case Neighbours::obp:
      return std::make_unique<GeneralOrientedEnvelopes>(bodies,
                                                        std::min(thickness, thickest_oriented_envelope(bodies, box)));
    case Neighbours::cells:
      break;
  }
  return std::make_unique<CellEnvelopes<GeneralBodies>>(bodies.number(), box, bodies.bounding_radius());
}

std::unique_ptr<FirstLooks<GeneralBodies>> make_first_looks(const GeneralBodies& /*bodies*/,
                                                            const SimulationOptions& /*options*/) {
  return nullptr;
}

}  // namespace ed::internal
