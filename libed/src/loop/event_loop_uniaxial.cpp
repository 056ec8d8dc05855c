// The loop of ellipsoids of revolution. A source for each kind of bodies: in larger ones the compiler inlines less.

#include "loop/event_loop_impl.h"

namespace ed::internal {

template class EventLoop<UniaxialBodies>;

}  // namespace ed::internal
