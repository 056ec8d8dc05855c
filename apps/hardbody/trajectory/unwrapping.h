#pragma once

#include "trajectory/frame.h"

#include <Eigen/Core>

#include <cstddef>
#include <string>
#include <vector>

namespace hardbody {

/// Unwraps the positions of bodies, from frame to frame across the faces of the box. The source is what the file
/// contains: unwrapped positions, positions that continue outside the box, or the nearest images, if bodies move
/// little. Positions from 0 to the edge, while the box is about the origin, are also treated as wrapped. Images that
/// are 0 in all frames are not used if bodies jump so often and so far within the box that they could hardly do so
/// without leaving it: the program has then not kept track of images.
class Unwrapping {
 public:
  /// Largest accepted component of a move between frames by nearest images, in edges of the box. Beyond half an edge
  /// nearest images are wrong; if none of the bodies moves by a fifth, a move by more than a half is very unlikely.
  static constexpr double kBelievedMove = 0.2;

  /// Constructs an empty object. `late`: the program that writes such files may leave positions slightly outside the
  /// box before it wraps them.
  explicit Unwrapping(bool late) : late_(late) {}

  /// Adds the next frame; `kept`: whether its positions are part of the result.
  void add(const Frame& frame, const std::vector<std::size_t>& order, bool kept);

  /// Result: the source of unwrapped positions, or why there is none.
  struct Result {
    std::string by;
    std::string reason;
    std::string notice;  ///< text about images that are not used; mostly empty
    /// Positions of the frames that were kept; wrapped if there is no source.
    std::vector<std::vector<Eigen::Vector3d>> positions;
  };
  Result take();

 private:
  using Positions = std::vector<Eigen::Vector3d>;

  bool late_;
  bool all_unwrapped_ = true;
  bool zero_images_ = true;  ///< images are 0 in all frames
  std::string by_;
  Positions raw_;          ///< positions of the previous frame, as stored
  Positions near_;         ///< positions of the previous frame by nearest images
  double lowest_ = 0;      ///< smallest component of a stored position, in edges from the middle of the box
  double highest_ = 0;     ///< largest component of a stored position, in edges from the middle of the box
  double raw_move_ = 0;    ///< largest component of a move by stored positions
  double near_move_ = 0;   ///< largest component of a move by nearest images
  std::size_t jumps_ = 0;  ///< number of components of moves by half an edge or more, by stored positions
  double chance_ = 1;      ///< probability that all these jumps end in the box, for bodies that are anywhere in it
  std::vector<Positions> kept_unwrapped_, kept_raw_, kept_near_, kept_wrapped_;
};

}  // namespace hardbody
