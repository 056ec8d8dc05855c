#pragma once

#include <ed/simulation.h>

#include <filesystem>
#include <string>
#include <vector>

namespace hardbody {

/// failures/*.json: a pair of bodies that the simulation could not predict as it should, for `hardbody
/// replay`.
///
/// {"format": "hardbody pair", "reason": .., "time": .., "i": .., "j": ..,
///  "a": {"shape": {"kind": "ellipsoid", "semi_axes": [..]}, "position": [..], "rotation": [[..], [..],
///  [..]],
///        "velocity": [..], "angular_velocity": [..], "inertia": [..], "time": ..}, "b": {..},
///  "eps_d": ..,
///  "newton": {"method": "newton8" or "newton5", "status": .., "point_a": [..] or null, "point_b": ..,
///             "a": {"shape": .., "position": .., "rotation": ..}, "b": {..}}}
///
/// shape: or {"kind": "superellipsoid", "semi_axes": [..], "exponents": [e1, e2]}. eps_d: with the finder "bracketing"
/// only. newton: the call of newton_distance that gave no answer, if that is the reason; its points are null where
/// there was no seed, its frame has its origin at a's centre. World frame; rotation: rows of the matrix from body to
/// world, or instead of it "orientation": [w, x, y, z]. Numbers are written so that they read back as the same double.
struct Failure {
  std::string reason;  ///< reason in words; that of a file may differ from to_string(pair.reason)
  ed::FailedPair pair;
  std::vector<std::string> notices;  ///< notices about a file that was read: quaternions that were normalized
};

std::string failure_json(const Failure& failure);

/// Throws InputError. Only the bodies' shapes, positions and orientations must be there: bodies are at rest
/// by default, their inertia is that of uniform density.
Failure read_failure(const std::filesystem::path& path);

}  // namespace hardbody
