// The event loop's state as bytes. Apart from the loop, which the compiler inlines less of in a larger source.

#include "loop/state_impl.h"

#include "loop/event_loop.h"

namespace ed::internal {

std::unique_ptr<AnyEventLoop> load_event_loop(const System& system, const SimulationOptions& options, Reader& reader) {
  if (UniaxialBodies::can_hold(system)) return std::make_unique<EventLoop<UniaxialBodies>>(system, options, reader);
  return std::make_unique<EventLoop<GeneralBodies>>(system, options, reader);
}

template void EventLoop<UniaxialBodies>::save(Writer& writer) const;
template void EventLoop<GeneralBodies>::save(Writer& writer) const;

}  // namespace ed::internal
