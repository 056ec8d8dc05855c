#include "run/phases/restored.h"

#include <ed/archive_system.h>

namespace hardbody {

ed::Simulation restored_simulation(const Config& config, Checkpoint& checkpoint, const std::string& name) {
  return restored(name, [&] {
    ed::Simulation simulation = ed::Simulation::restore(checkpoint.run->simulation.bytes(), checkpoint.system.species,
                                                        config.simulation_options());
    checkpoint.run->simulation = {};
    if (ed::archive::bytes_of(simulation.system()) == ed::archive::bytes_of(checkpoint.system)) return simulation;
    throw std::invalid_argument("state: two that should be the same differ");
  });
}

}  // namespace hardbody
