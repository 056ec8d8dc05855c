#pragma once

/// What both readers of trajectories must do with any bytes: refuse them with one line, or read every frame (or refuse
/// it) with finite numbers.

#include "errors.h"
#include "frame.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string_view>

namespace fuzz {

inline void require(bool holds, const char* what) {
  if (holds) return;
  std::fprintf(stderr, "does not hold: %s\n", what);
  std::abort();
}

inline void check_frame(const hardbody::Frame& frame) {
  require(!frame.bodies.empty(), "a frame has bodies");
  require(frame.box.allFinite() && frame.box.minCoeff() > 0, "a box has edges");
  for (const hardbody::FrameBody& body : frame.bodies) {
    require(body.position.allFinite() && body.unwrapped.allFinite(), "positions are finite");
    require((body.position.cwiseAbs() - 0.5000001 * frame.box).maxCoeff() <= 0, "positions are in the box");
    require(body.rotation.allFinite() && body.velocity.allFinite(), "rotations and velocities are finite");
    require(body.type < frame.types.size(), "a body's type is there");
  }
  if (frame.exact) require(frame.exact->bodies.size() == frame.bodies.size(), "the state is of all bodies");
}

template <class Read>
void refused_or_read(const Read& read) {
  try {
    read();
  } catch (const hardbody::InputError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a refusal is one line");
  }
}

/// `open` makes the reader.
template <class Open>
void read_all(const Open& open) {
  constexpr std::uint64_t kMostFrames = 8;  // enough of those that repeat the first one
  refused_or_read([&] {
    const auto reader = open();
    for (std::uint64_t k = 0; k < std::min(reader.frame_count(), kMostFrames); ++k) {
      refused_or_read([&] { check_frame(reader.read(k)); });
    }
  });
}

}  // namespace fuzz
