#pragma once

#include "trajectory/gsd/container.h"

#include <array>
#include <cstdint>

/// Definitions shared by the writer and the reader of gsd/frames.h: the arrays and their types.
namespace hardbody::gsd {

/// Arrays in the order of their numbers: those that are in frame 0 only come first.
enum Name : std::uint16_t {
  kDimensions,
  kBox,
  kNumber,
  kTypes,
  kTypeShapes,
  kTypeId,
  kMass,
  kInertia,
  kExactBox,
  kExactSpecies,
  kGroup,
  kStep,  // this and the following arrays are in every frame
  kPosition,
  kOrientation,
  kVelocity,
  kAngularMomentum,
  kImage,
  kEnergy,
  kZ,
  kS,
  kExactPosition,
  kExactRotation,
  kExactVelocity,
  kExactAngularVelocity,
  kTime,  // last array: a frame with it is complete
  kNames,
};

inline constexpr std::array<const char*, kNames> kNameTexts = {
    "configuration/dimensions",
    "configuration/box",
    "particles/N",
    "particles/types",
    "particles/type_shapes",
    "particles/typeid",
    "particles/mass",
    "particles/moment_inertia",
    "log/hardbody/box",
    "log/hardbody/species",
    "log/particles/hardbody/group",
    "configuration/step",
    "particles/position",
    "particles/orientation",
    "particles/velocity",
    "particles/angmom",
    "particles/image",
    "log/hardbody/energy",
    "log/hardbody/Z",
    "log/hardbody/S",
    "log/particles/hardbody/position",
    "log/particles/hardbody/rotation",
    "log/particles/hardbody/velocity",
    "log/particles/hardbody/angular_velocity",
    "log/hardbody/time",
};

/// Number of columns in a row of log/hardbody/species, without the vertices of polyhedra.
inline constexpr std::uint32_t kSpeciesColumns = 11;

template <class T>
inline constexpr GsdType kTypeOf = GsdType::uint8;
template <>
inline constexpr GsdType kTypeOf<std::uint32_t> = GsdType::uint32;
template <>
inline constexpr GsdType kTypeOf<std::uint64_t> = GsdType::uint64;
template <>
inline constexpr GsdType kTypeOf<std::int32_t> = GsdType::int32;
template <>
inline constexpr GsdType kTypeOf<float> = GsdType::float32;
template <>
inline constexpr GsdType kTypeOf<double> = GsdType::float64;

}  // namespace hardbody::gsd
