// The loop of bodies of any shape; see event_loop_uniaxial.cpp.

#include "loop/event_loop_impl.h"

namespace ed::internal {

template class EventLoop<GeneralBodies>;

}  // namespace ed::internal
