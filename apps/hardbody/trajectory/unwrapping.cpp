#include "trajectory/unwrapping.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <utility>

namespace hardbody {
namespace {

using Eigen::Vector3d;

/// Largest distance of a position outside the box, in edges, that is regarded as not wrapped yet, or as rounding.
constexpr double kNotWrappedYet = 0.25;
constexpr double kRounding = 1e-3;
/// Number of moves beyond half an edge, all of them within kBelievedMove of whole edges, from which on stored positions
/// are regarded as wrapped: a true move is that near to whole edges with a probability of less than 1/2.
constexpr std::size_t kManyJumps = 10;
/// Images that are all 0 are believed as long as bodies that jump within the box have at least this chance not to leave
/// it.
constexpr double kLeastChance = 0.01;

double largest_move(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b, const Vector3d& box) {
  double move = 0;
  for (std::size_t i = 0; i < a.size(); ++i) {
    move = std::max(move, (b[i] - a[i]).cwiseQuotient(box).cwiseAbs().maxCoeff());
  }
  return move;
}

/// Moves along an axis by half an edge or more.
struct Jumps {
  std::size_t count = 0;
  double chance = 1;  ///< probability that all end in the box: product of 1 - d, for bodies anywhere in it
};

Jumps jumps_between(const std::vector<Vector3d>& a, const std::vector<Vector3d>& b, const Vector3d& box) {
  Jumps jumps;
  for (std::size_t i = 0; i < a.size(); ++i) {
    const Vector3d moves = (b[i] - a[i]).cwiseQuotient(box);
    for (const double move : moves) {
      if (std::abs(move) < 0.5) continue;
      ++jumps.count;
      jumps.chance *= std::max(0.0, 1 - std::abs(move));
    }
  }
  return jumps;
}

}  // namespace

void Unwrapping::add(const Frame& frame, const std::vector<std::size_t>& order, bool kept) {
  Positions raw;
  Positions near;
  Positions unwrapped;
  Positions wrapped;
  for (const std::size_t i : order) {
    const FrameBody& body = frame.bodies[i];
    const std::size_t n = near.size();
    raw.push_back(frame.images && !frame.zero_images ? body.position : body.unwrapped);
    wrapped.push_back(body.position);
    unwrapped.push_back(body.unwrapped);
    near.push_back(body.position);
    if (!near_.empty()) {
      const Vector3d edges = (body.position - near_[n]).cwiseQuotient(frame.box);
      near.back() -= frame.box.cwiseProduct(edges.array().round().matrix());
    }
    lowest_ = std::min(lowest_, raw.back().cwiseQuotient(frame.box).minCoeff());
    highest_ = std::max(highest_, raw.back().cwiseQuotient(frame.box).maxCoeff());
  }
  if (!near_.empty()) {
    raw_move_ = std::max(raw_move_, largest_move(raw_, raw, frame.box));
    near_move_ = std::max(near_move_, largest_move(near_, near, frame.box));
    const Jumps jumps = jumps_between(raw_, raw, frame.box);
    jumps_ += jumps.count;
    chance_ *= jumps.chance;
  }
  if (by_.empty()) by_ = frame.unwrapped_by;
  all_unwrapped_ = all_unwrapped_ && frame.images;
  zero_images_ = zero_images_ && frame.zero_images;
  if (kept) {
    kept_wrapped_.push_back(std::move(wrapped));
    kept_unwrapped_.push_back(std::move(unwrapped));
    kept_raw_.push_back(raw);
    kept_near_.push_back(near);
  }
  raw_ = std::move(raw);
  near_ = std::move(near);
}

Unwrapping::Result Unwrapping::take() {
  const double outside = std::max(highest_, -lowest_) - 0.5;
  const bool from_corner = lowest_ >= -kRounding && highest_ <= 1 + kRounding;
  const bool not_kept = zero_images_ && chance_ < kLeastChance && (outside <= kNotWrappedYet || from_corner);
  if (all_unwrapped_ && !not_kept) return {by_, "", "", std::move(kept_unwrapped_)};
  const std::string notice =
      not_kept ? fmt::format(
                     "images: 0 in all frames, while bodies jump by up to {:.2g} of the box's edge between "
                     "frames: they are not kept, and not used",
                     raw_move_)
               : "";
  const auto unclear = [&] {
    return Result{
        "",
        fmt::format("positions lie outside the box by up to {:.2g} of its edge, and bodies move by up to {:.2g} of it "
                    "between frames: whether positions are wrapped is not clear; images tell",
                    outside, raw_move_),
        notice, std::move(kept_wrapped_)};
  };
  const bool jump = raw_move_ >= kBelievedMove;
  const bool near_believed = near_move_ < kBelievedMove * (1 - 1e-6);
  if (outside > kNotWrappedYet && !(from_corner && jump)) {
    if (near_believed && jumps_ >= kManyJumps) return unclear();
    return {"positions outside the box", "", notice, std::move(kept_raw_)};
  }
  if (!late_ && outside > kRounding && jump && !from_corner) return unclear();
  if (near_believed) return {"nearest images", "", notice, std::move(kept_near_)};
  return {"",
          fmt::format(
              "without images, and bodies move by up to {:.2g} of the box's edge between frames: nearest images "
              "do not tell beyond a quarter of the box, and are believed below {} of it; frames at shorter distances, "
              "images or unwrapped positions tell",
              near_move_, kBelievedMove),
          notice, std::move(kept_wrapped_)};
}

}  // namespace hardbody
