#pragma once

/// Contract of both readers of trajectories for any bytes: refuse them with one line, or read every frame (or refuse
/// it) with finite numbers, and without numbers that the file does not contain.

#include "base/errors.h"
#include "trajectory/frame.h"
#include "trajectory/stored_trajectory.h"

#include <algorithm>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <string>
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
    require(!frame.tilt.isZero(0) || (body.position.cwiseAbs() - 0.5000001 * frame.box).maxCoeff() <= 0,
            "positions are in the box");
    require(body.rotation.allFinite() && body.velocity.allFinite(), "rotations and velocities are finite");
    require(body.angular_velocity.allFinite(), "angular velocities are finite");
    require(frame.orientations || body.rotation.isIdentity(0), "no rotation where none is known");
    require(frame.velocities || body.velocity.isZero(0), "no velocity where none is known");
    require(frame.angular_velocities || body.angular_velocity.isZero(0), "no angular velocity where none is known");
    require(body.type < frame.types.size(), "a body's type is there");
  }
  require(frame.images == !frame.unwrapped_by.empty(), "unwrapped positions have a source");
  for (const std::string& notice : frame.notices) {
    require(notice.find('\n') == std::string::npos, "a notice is one line");
  }
  if (frame.exact) require(frame.exact->bodies.size() == frame.bodies.size(), "the state is of all bodies");
}

/// Checks frames in the form that `hardbody analyze` takes: all of the same bodies, each quantity in all of them or in
/// none.
inline void check_trajectory(const hardbody::StoredTrajectory& trajectory) {
  require(!trajectory.frames.empty(), "a trajectory has frames");
  const ed::StoredFrame& first = trajectory.frames.front();
  require(!first.position.empty(), "a trajectory has bodies");
  for (const ed::StoredFrame& frame : trajectory.frames) {
    require(frame.position.size() == first.position.size(), "all frames have all bodies");
    require(frame.rotation.size() == first.rotation.size(), "orientations are known in all frames or in none");
    require(frame.velocity.size() == first.velocity.size(), "velocities are known in all frames or in none");
    for (const Eigen::Vector3d& x : frame.position) require(x.allFinite(), "unwrapped positions are finite");
  }
  require(trajectory.not_unwrapped.empty() == trajectory.options.unwrapped, "a reason where nothing is unwrapped");
  require(trajectory.not_followed.empty() == trajectory.options.same_bodies, "a reason where nothing is followed");
}

template <class Read>
void refused_or_read(const Read& read) {
  try {
    read();
  } catch (const hardbody::InputError& error) {
    require(std::string_view(error.what()).find('\n') == std::string_view::npos, "a refusal is one line");
  }
}

/// Reads all frames. `open` makes the reader; `also(frame, k)` checks each frame too.
template <class Open, class Also>
void read_all(const Open& open, const Also& also) {
  constexpr std::uint64_t kMostFrames = 8;  // enough frames that repeat the first one
  refused_or_read([&] {
    const auto reader = open();
    for (std::uint64_t k = 0; k < std::min(reader.frame_count(), kMostFrames); ++k) {
      refused_or_read([&] {
        const hardbody::Frame frame = reader.read(k);
        require(reader.has_positions(k), "a frame that is read has positions");
        check_frame(frame);
        also(frame, k);
      });
    }
    if (reader.frame_count() > kMostFrames) return;
    refused_or_read([&] {
      hardbody::ReadingOptions options;
      options.time_step = 1;
      check_trajectory(hardbody::read_trajectory(reader, options));
    });
  });
}

}  // namespace fuzz
