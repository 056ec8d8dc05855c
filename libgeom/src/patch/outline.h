#pragma once

#include "patch/polygon.h"
#include "patch/surface.h"

#include <geom/contact_patch.h>

#include <cstddef>
#include <optional>

namespace geom::patch {

/// Outline of the patch of two surfaces, found from outside: a polygon that contains it loses corners that are not in
/// it. Refers to its arguments.
class Outline {
 public:
  /// `rounding`: distance (length) that is rounding.
  Outline(const Surface& a, const Surface& b, const PatchOptions& options, double rounding)
      : a_(a), b_(b), options_(options), rounding_(rounding), is_exact_(a.exact() && b.exact()) {}

  /// Finds the polygon; empty if there is none.
  Polygon find();

  /// Names sides that are within `slack` of one of polytope A's after that one, where tilts decide which of two bodies
  /// bounds the patch, and leaves out corners between two sides of one name.
  void join_sides(Polygon& polygon, double slack) const;

  /// Returns whether both surfaces are polytopes or planes, so that the corners are those of the patch.
  bool is_exact() const { return is_exact_; }
  /// Returns the diameter of the part of the plane that both shadows can have in common, after find().
  double extent() const { return extent_; }
  /// Returns how far a corner may be outside.
  double error() const { return error_ > rounding_ ? error_ : rounding_; }

  /// Place in both shadows, and the heights of both surfaces there.
  struct Heights {
    Vector2d place;
    double a = 0, b = 0;
    double gap() const { return -(a + b); }
  };

  /// Returns the heights at a place; where that is not in both shadows, at the first one that is on the way inwards, or
  /// at the place of the patch that the search has found; nullopt where a ray found no surface.
  std::optional<Heights> heights(const Vector2d& x, const Vector2d& inner) const;

  /// Returns the heights of polytopes at the place nearest to x that is on no wall, a steep face that bounds the
  /// others; where that is further away than `most`, on the way to it.
  ///
  /// Walls of bodies that are tilted a little bound the patch beyond the faces that touch, where the gap is as large as
  /// it may be. This is the depth of the faces.
  std::optional<Heights> heights_off_walls(const Vector2d& x, double most) const;

 private:
  /// Returns a rectangle around both shadows' common part.
  Polygon box() const;
  /// Cuts off a corner, or marks it as one of the patch. Returns whether anything is left.
  bool treat(Polygon& polygon, std::size_t k, double diameter);
  /// Excess of the gap over a place beyond what it may be, and its gradient; infinite outside of a shadow.
  struct Excess {
    double value = 0;
    Vector2d slope = Vector2d::Zero();
  };
  Excess excess_at(const Vector2d& x) const;
  /// Looks for a place of the patch: that of the witness points, or the middle of the polygon. Returns whether one is
  /// known.
  bool find_inner(const Polygon& polygon);
  struct Ending;
  /// Returns where the patch ends on the way from a place in it to a corner, as well as a cut needs.
  Ending ending(const Vector2d& x, const Excess& at_corner, double tolerance) const;
  /// Returns the tangent of the patch near its end, or the line that bounds a shadow there.
  std::optional<Line> tangent_at(const Ending& end) const;
  /// Cuts along the tangent at the end of the patch on the way from a place in it to a corner, unless the corner is
  /// near that.
  bool treat_smooth(Polygon& polygon, std::size_t k, double tolerance, const Excess& at_corner);
  /// Cuts along the tangent over a corner that is in both shadows.
  bool treat_gap(Polygon& polygon, std::size_t k, double diameter);
  std::optional<Heights> heights_at(const Vector2d& place) const;

  const Surface& a_;
  const Surface& b_;
  const PatchOptions& options_;
  double rounding_;
  bool is_exact_;
  double error_ = 0;
  double extent_ = 0;
  std::optional<Vector2d> inner_;  ///< place of the patch
  double inner_excess_ = 0;
};

}  // namespace geom::patch
