#include "simulation/options.h"

#include "base/arguments.h"
#include "geometry/contact_options.h"

#include <geom/batch.h>

#include <array>
#include <limits>
#include <string>
#include <string_view>

namespace hardbody::python {
namespace {

using geom::InstructionSet;

constexpr std::array kNeighbours = {ed::Neighbours::dilated, ed::Neighbours::obp, ed::Neighbours::cells};
constexpr std::array kInstructionSets = {InstructionSet::best, InstructionSet::portable, InstructionSet::avx2,
                                         InstructionSet::avx512};

constexpr double kUsualEpsD = 1e-6;  ///< unit: mean radius of spheres of the bodies' volumes
constexpr int kLeastPrepared = 64;

/// Returns the neighbours that the program's "auto" chooses. Only ellipsoids of revolution of one size have been
/// measured.
ed::Neighbours usual_neighbours(const ed::System& system, ed::Finder finder) {
  if (system.species.size() != 1 || system.bodies.empty()) return ed::Neighbours::dilated;
  const ed::Species& species = system.species[0];
  if (!ed::is_spheroid(species.shape) || !ed::symmetry_axis(species)) return ed::Neighbours::dilated;
  const ed::Neighbours fastest =
      ed::fastest_neighbours(species.shape, system.size(), ed::packing_fraction(system), finder);
  return fastest == ed::Neighbours::cells ? fastest : ed::Neighbours::dilated;
}

double usual_eps_d(ed::System system) {
  for (ed::Species& species : system.species) species.mass = 1;
  return kUsualEpsD * ed::time_unit(system);
}

}  // namespace

ed::SimulationOptions simulation_options(const OptionArguments& given, const ed::System& system) {
  ed::SimulationOptions options;
  ed::ContactOptions& contact = options.contact;
  contact.eps_d = usual_eps_d(system);
  read_method(contact, given.finder, given.eps_d, given.distance, given.root);
  options.neighbours = given.neighbours.is_none() ? usual_neighbours(system, contact.finder)
                                                  : choice(given.neighbours, "neighbours", kNeighbours);
  if (!given.envelope.is_none()) {
    options.envelope = positive(given.envelope, "envelope");
    if (options.neighbours == ed::Neighbours::cells) {
      const bool chosen = given.neighbours.is_none();
      const char* const with =
          chosen ? " with neighbours=None, where cells are the fastest" : " with neighbours=\"cells\"";
      refuse_value("envelope", shown(options.envelope) + with, "None, as cells have none; or neighbours=\"dilated\"");
    }
  }
  options.batches.reset();
  if (!given.instruction_set.is_none()) {
    options.batches = choice(given.instruction_set, "instruction_set", kInstructionSets);
    if (!geom::is_available(*options.batches)) {
      refuse_value("instruction_set", '"' + std::string(to_string(*options.batches)) + '"',
                   "one that this processor has");
    }
  }
  options.prepare_from =
      static_cast<int>(integer(given.prepare_from, "prepare_from", kLeastPrepared, std::numeric_limits<int>::max()));
  options.least_progress = positive(given.least_progress, "least_progress");
  return options;
}

}  // namespace hardbody::python
