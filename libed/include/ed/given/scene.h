#pragma once

/// @file
/// First contact of bodies of a scene, some of which move.

#include <ed/export.h>
#include <ed/given/contact.h>
#include <ed/given/motion.h>
#include <ed/time_of_contact.h>

#include <geom/scene.h>

#include <Eigen/Core>

#include <span>

namespace ed {

/// Body of a scene, and how it moves.
struct MovingBody {
  geom::BodyId body{};
  GivenMotion motion;
};

/// First contact in a scene.
struct [[nodiscard]] SceneContact {
  /// Two bodies, i < j. i = j = 0: no pair's contact; `separated`, or `budget_exhausted` by intervals (first_contact).
  geom::BodyId i{}, j{};
  /// Lattice vector to be added to the position of j; 0 in open space.
  Eigen::Vector3d image = Eigen::Vector3d::Zero();
  /// Contact of i with that image of j, as of time_of_contact. `separated`: no two bodies touch up to t_max.
  /// `evaluations` are those of all pairs that were searched.
  ContactResult contact;
};

/// Returns the first time in [t_min, t_max] at which a body of `moving` touches another body of the scene, moving or
/// not, that its filter pairs it with. Bodies that are not in `moving` stay where they are.
///
/// Each pair is searched by time_of_contact, with its certificate. Pairs are taken from the scene's boxes, over
/// intervals as long as bodies reach few others, images included. The outcome of the earliest pair is returned: if that
/// is no hit (two bodies overlap, a budget is exhausted), contacts after its time are not known. Of pairs at the same
/// time the one with the smallest handles. The budget is that of each pair, and of the number of intervals: it is
/// exhausted by a body that meets nobody but passes others, or images of them, all the time.
///
/// Bodies of `moving` are moved: they end at their poses at the time returned, also if they were elsewhere before. If
/// an exception is thrown, by a motion or a user's shape too, they are where they were. Throws as time_of_contact;
/// std::invalid_argument, too, for handles that no body has or that are given twice.
ED_EXPORT SceneContact first_contact(geom::Scene& scene, std::span<const MovingBody> moving, double t_min, double t_max,
                                     const GivenContactOptions& options = {});

}  // namespace ed
