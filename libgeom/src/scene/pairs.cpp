#include "scene/bodies.h"
#include "scene/parallel.h"

#include <geom/batch.h>
#include <geom/kernel/refuse.h>

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <span>
#include <string>
#include <vector>

namespace geom {

using Eigen::Vector3d;
using scene::Body;
using scene::Candidate;

namespace {

constexpr std::size_t kBlock = 64;  ///< number of pairs that a thread takes at a time

void check_cutoff(double cutoff) {
  if (!(cutoff >= 0) || !std::isfinite(cutoff)) {
    kernel::refuse("Scene: cutoff is " + std::to_string(cutoff) + "; accepted: a finite length, 0 or more");
  }
}

const Ellipsoid* ellipsoid(const Body& body) {
  const Shape* shape = std::get_if<Shape>(&body.shape);
  return shape == nullptr ? nullptr : std::get_if<Ellipsoid>(shape);
}

/// Computes the distances of a block of pairs: those of ellipsoids side by side. Pairs that are certainly further apart
/// than the cut-off have that bound as their distance.
class BlockOfPairs {
 public:
  BlockOfPairs(const scene::Images& images, double cutoff, const DistanceOptions& options)
      : images_(images), cutoff_(cutoff), options_(options) {
    batch_.max_iterations = options.max_iterations;
    batch_.penetration = options.penetration;
    options_.start.setZero();
  }

  template <class BodyOf>
  void run(std::span<const Candidate> pairs, const BodyOf& body_of, std::span<ScenePair> out) {
    std::size_t ellipsoids = 0;
    for (std::size_t k = 0; k < pairs.size(); ++k) {
      const Body& i = body_of(pairs[k].i);
      const Body& j = body_of(pairs[k].j);
      const Vector3d image = images_.vector(pairs[k].cell);
      poses_[k] = kernel::moved(j.X_WB, image);
      out[k] = {i.id, j.id, image, {}};
      const Ellipsoid* a = ellipsoid(i);
      const Ellipsoid* b = ellipsoid(j);
      if (a != nullptr && b != nullptr) {
        batch_pairs_[ellipsoids] = {a, &i.X_WB, b, &poses_[k]};
        place_[ellipsoids++] = k;
        continue;
      }
      const double bound = scene::lower_bound(i.shape, i.X_WB, j.shape, poses_[k]);
      if (bound > cutoff_) {
        out[k].result.distance = bound;
        out[k].result.status = DistanceStatus::separated;
      } else {
        out[k].result = scene::distance(i.shape, i.X_WB, j.shape, poses_[k], options_);
      }
    }
    distance_batch(std::span(batch_pairs_).first(ellipsoids), std::span(found_).first(ellipsoids), batch_);
    for (std::size_t k = 0; k < ellipsoids; ++k) {
      const geom::EllipsoidPair& pair = batch_pairs_[k];
      out[place_[k]].result = near_cutoff(pair, found_[k].distance)
                                  ? geom::distance(*pair.a, *pair.X_WA, *pair.b, *pair.X_WB, options_)
                                  : found_[k];
    }
  }

 private:
  /// Returns whether the rounding of `distance_batch` may decide whether a pair is within the cut-off.
  bool near_cutoff(const geom::EllipsoidPair& pair, double distance) const {
    // Both distances agree within 1e-14 of this size.
    const double size =
        (pair.X_WB->position() - pair.X_WA->position()).norm() + pair.a->bounding_radius() + pair.b->bounding_radius();
    return std::abs(distance - cutoff_) <= 1e-13 * size;
  }

  const scene::Images& images_;
  double cutoff_;
  DistanceOptions options_;
  BatchOptions batch_;
  std::array<Pose, kBlock> poses_;
  std::array<geom::EllipsoidPair, kBlock> batch_pairs_;
  std::array<std::size_t, kBlock> place_{};
  std::array<DistanceResult, kBlock> found_;
};

bool declined(const DistanceResult& result) {
  return result.status != DistanceStatus::separated && result.status != DistanceStatus::overlapping;
}

/// Calls fill(first, found) for blocks of `number` candidates, which sets what it finds of candidates first, first + 1,
/// .. Returns what is to be kept; the other answers take no memory.
template <class Found, class Fill, class Keep>
std::vector<Found> answers_of(std::size_t number, int threads, const Fill& fill, const Keep& keep) {
  constexpr std::size_t kRound = std::size_t{1} << 18;  // candidates at a time
  std::vector<Found> answers, found;
  for (std::size_t begin = 0; begin < number; begin += kRound) {
    found.resize(std::min(kRound, number - begin));
    scene::in_blocks(found.size(), kBlock, threads, [&](std::size_t first, std::size_t last) {
      fill(begin + first, std::span(found).subspan(first, last - first));
    });
    std::copy_if(found.begin(), found.end(), std::back_inserter(answers), keep);
  }
  return answers;
}

}  // namespace

void Scene::pairs_within(double cutoff, std::vector<ScenePair>& out, const DistanceOptions& options,
                         int threads) const {
  check_cutoff(cutoff);
  scene::check_threads(threads);
  const std::vector<Candidate> pairs = bodies_->candidates(cutoff);
  const auto body_of = [this](std::int32_t item) -> const Body& { return bodies_->at(item); };
  const auto find = [&](std::size_t first, std::span<ScenePair> found) {
    BlockOfPairs block(bodies_->images, cutoff, options);
    block.run(std::span(pairs).subspan(first, found.size()), body_of, found);
  };
  out = answers_of<ScenePair>(pairs.size(), threads, find, [&](const ScenePair& pair) {
    return declined(pair.result) || pair.result.distance <= cutoff;
  });
}

void Scene::overlapping_pairs(std::vector<SceneOverlap>& out, int threads) const {
  scene::check_threads(threads);
  const std::vector<Candidate> pairs = bodies_->candidates(0);
  const auto find = [&](std::size_t first, std::span<SceneOverlap> found) {
    for (std::size_t k = 0; k < found.size(); ++k) {
      const Candidate& pair = pairs[first + k];
      const Body& i = bodies_->at(pair.i);
      const Body& j = bodies_->at(pair.j);
      const Vector3d image = bodies_->images.vector(pair.cell);
      found[k] = {i.id, j.id, image, scene::overlap(i.shape, i.X_WB, j.shape, kernel::moved(j.X_WB, image))};
    }
  };
  out = answers_of<SceneOverlap>(pairs.size(), threads, find,
                                 [](const SceneOverlap& pair) { return pair.answer != Answer::no; });
}

void Scene::candidates(double cutoff,
                       const std::function<bool(BodyId i, BodyId j, const Vector3d& image)>& visit) const {
  check_cutoff(cutoff);
  bodies_->for_each_pair(cutoff, [&](std::int32_t i, std::int32_t j, const Vector3d& cell) {
    return visit(bodies_->at(i).id, bodies_->at(j).id, bodies_->images.vector(cell));
  });
}

}  // namespace geom
