#include "loop/event_loop.h"

#include "contact/body_shapes.h"

namespace ed::internal {

std::unique_ptr<AnyEventLoop> make_event_loop(const System& system, const SimulationOptions& options) {
  for (const Species& species : system.species) check_finder(options.contact, species.shape);
  if (UniaxialBodies::can_hold(system)) return std::make_unique<EventLoop<UniaxialBodies>>(system, options);
  return std::make_unique<EventLoop<GeneralBodies>>(system, options);
}

}  // namespace ed::internal
