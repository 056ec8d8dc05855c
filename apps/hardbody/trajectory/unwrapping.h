#pragma once

#include "trajectory/frame.h"

#include <Eigen/Core>

#include <cstddef>
#include <string>
#include <vector>

namespace hardbody {

/// Positions of bodies that are followed from frame to frame across the faces of the box, by whatever the file has:
/// unwrapped positions, or such as go on outside the box, or the nearest images, as long as bodies move little.
/// Positions from 0 to the edge, where the box is about the origin, are wrapped ones, too. Images that are 0 in all
/// frames, while bodies jump so often and far within the box as they hardly could without leaving it, are no images:
/// nobody has kept them.
class Unwrapping {
 public:
  /// Component of a move between frames, in edges of the box, from which on nearest images are not believed. Beyond
  /// half an edge they would be wrong; bodies of which none moves by a fifth hardly ever move by more than a half.
  static constexpr double kBelievedMove = 0.2;

  /// `late`: the program that writes such files may leave positions a little outside the box before it wraps them.
  explicit Unwrapping(bool late) : late_(late) {}

  /// Takes the next frame; `kept`: its positions are wanted.
  void add(const Frame& frame, const std::vector<std::size_t>& order, bool kept);

  /// Result: the source of unwrapped positions, or why there is none.
  struct Result {
    std::string by;
    std::string reason;
    std::string notice;                                   ///< about images that are not used; mostly empty
    std::vector<std::vector<Eigen::Vector3d>> positions;  ///< of the frames that were kept; wrapped without a source
  };
  Result take();

 private:
  using Positions = std::vector<Eigen::Vector3d>;

  bool late_;
  bool all_unwrapped_ = true;
  bool zero_images_ = true;  ///< images are 0 in all frames
  std::string by_;
  Positions raw_;          ///< of the frame before, as stored
  Positions near_;         ///< the same by nearest images
  double lowest_ = 0;      ///< least component of a stored position, in edges from the middle of the box
  double highest_ = 0;     ///< largest one
  double raw_move_ = 0;    ///< the largest component of a move by stored positions
  double near_move_ = 0;   ///< the same by nearest images
  std::size_t jumps_ = 0;  ///< components of moves by half an edge or more, by stored positions
  double chance_ = 1;      ///< that all these jumps end in the box, of bodies that are anywhere in it
  std::vector<Positions> kept_unwrapped_, kept_raw_, kept_near_, kept_wrapped_;
};

}  // namespace hardbody
