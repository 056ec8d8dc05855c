// Apart from the loop, as state.cpp.

#include "loop/stall_impl.h"

namespace ed::internal {

template void EventLoop<UniaxialBodies>::look_for_stall(double end);
template void EventLoop<GeneralBodies>::look_for_stall(double end);

}  // namespace ed::internal
