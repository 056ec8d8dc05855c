#pragma once

#include <ed/simulation.h>

#include <filesystem>
#include <string>

namespace hardbody {

/// failures/*.json: a pair of bodies that the simulation could not predict as it should, for `hardbody
/// replay`.
///
/// {"format": "hardbody pair", "reason": .., "time": .., "i": .., "j": ..,
///  "a": {"shape": {"kind": "ellipsoid", "semi_axes": [..]}, "position": [..], "rotation": [[..], [..],
///  [..]],
///        "velocity": [..], "angular_velocity": [..], "inertia": [..], "time": ..}, "b": {..}}
///
/// World frame; rotation: rows of the matrix from body to world, or instead of it "orientation": [w, x, y,
/// z]. Numbers are written so that they read back as the same double.
std::string failure_json(const ed::FailedPair& pair);

/// Throws InputError. Only the bodies' shapes, positions and orientations must be there: bodies are at rest
/// by default, their inertia is that of uniform density.
ed::FailedPair read_failure(const std::filesystem::path& path);

}  // namespace hardbody
