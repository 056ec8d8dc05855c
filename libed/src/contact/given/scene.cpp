#include "contact/given/search.h"
#include "motion/given/point_bounds.h"

#include <ed/given/scene.h>

#include <geom/any_convex.h>
#include <geom/round_shapes.h>

#include <Eigen/Core>
#include <Eigen/QR>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <functional>
#include <limits>
#include <map>
#include <optional>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace ed {
namespace {

using Eigen::Matrix3d;
using Eigen::Vector3d;
using geom::AnyConvex;
using geom::BodyId;
using geom::Pose;
using geom::Scene;
using geom::kernel::moved;

/// Largest number of pairs in reach, for each body that moves, for which an interval is not made shorter.
constexpr std::size_t kManyPairs = 32;
/// Largest ratio of the number of pairs that are compared to that of pairs in reach.
constexpr std::size_t kComparisons = 8;
/// Largest number of images of all bodies in the box around what a body reaches.
constexpr double kManyImages = 1e6;
/// Longest way in an interval; a ball of this radius is a valid shape. Length.
constexpr double kLongestWay = 1e30;
/// Ratio of the numbers of pairs of an interval and of half of it, above which shorter ones would not help.
constexpr double kStill = 0.8;
/// Way of a body's points, in bounding radii, up to which an interval may be taken with any number of pairs.
constexpr double kShortWay = 4;
/// Largest number of times that an interval is made shorter for one body's way.
constexpr int kMostShortenings = 64;
/// Ratio of bodies to those that may ask for their neighbours one by one.
constexpr std::size_t kShareOfFew = 8;
/// Ratio of reaches from which on a body asks for its neighbours by itself.
constexpr double kMuchFurther = 2;

GivenMotion moved(const GivenMotion& motion, const Vector3d& by) {
  if (by.isZero(0)) return motion;
  return {[motion, by](double t) { return moved(motion.pose(t), by); },
          [motion](double from, double to) { return motion.bounds(from, to); }, motion.scales()};
}

std::int64_t number_of(BodyId body) {
  return static_cast<std::int64_t>(body);
}

/// Returns the matrix of coordinates along lattice vectors, a row each; 0 where the scene does not repeat.
Matrix3d coordinates_along(const geom::Lattice& lattice) {
  Matrix3d directions;
  Vector3d inverse_lengths;
  for (int k = 0; k < 3; ++k) {
    const Vector3d& v = lattice.vectors[static_cast<std::size_t>(k)];
    const double length = v.norm();
    directions.col(k) = length > 0 ? Vector3d(v / length) : Vector3d::Zero();
    inverse_lengths[k] = length > 0 ? 1 / length : 0;
  }
  return inverse_lengths.asDiagonal() * directions.completeOrthogonalDecomposition().pseudoInverse();
}

/// Pair of bodies that may touch within an interval, i < j.
struct PairInReach {
  BodyId i{}, j{};
  Vector3d image;

  /// Returns what pairs are ordered by.
  auto key() const { return std::tuple(i, j, image.x(), image.y(), image.z()); }
};

class SceneSearch {
 public:
  SceneSearch(Scene& scene, std::span<const MovingBody> moving, const GivenContactOptions& options)
      : scene_(scene), moving_(moving), options_(options), coordinates_(coordinates_along(scene.options().lattice)) {
    for (std::size_t k = 0; k < moving.size(); ++k) {
      const BodyId body = moving[k].body;
      poses_.push_back(scene.pose(body));  // throws for a handle that no body has
      bodies_.push_back(body);
      if (!index_of_.emplace(body, k).second) {
        throw std::invalid_argument("first_contact: body " + std::to_string(number_of(body)) +
                                    " is given twice; accepted: one motion a body");
      }
      shape_of(body);
    }
  }

  SceneContact find(double t_min, double t_max) {
    const auto before = scene_.places(bodies_);
    try {
      return search(t_min, t_max);
    } catch (...) {
      scene_.put_back(*before);
      throw;
    }
  }

 private:
  SceneContact search(double t_min, double t_max) {
    SceneContact first;
    double t = t_min, duration = t_max - t_min;
    move(t);
    for (int intervals = 0;; ++intervals) {
      if (intervals == options_.max_evaluations) {
        first.contact.status = ContactStatus::budget_exhausted;
        first.contact.time = t;
        break;
      }
      duration = std::min(duration, t_max - t);
      const std::vector<PairInReach> pairs = pairs_of_an_interval(t, duration);
      double until = t + duration < t_max ? t + duration : t_max;
      if (!(until > t)) until = std::min(t_max, std::nextafter(t, t_max));  // the clock is coarse
      search_pairs(pairs, t, until, first);
      if (first.contact.status != ContactStatus::separated || until == t_max) break;
      move_on(t, until);
      t = until;
      duration *= 2;
    }
    move_on(t, first.contact.time);
    first.contact.evaluations = static_cast<int>(std::min<std::int64_t>(evaluations_, std::numeric_limits<int>::max()));
    return first;
  }

  /// Makes the duration of an interval shorter until few pairs are in reach, and returns these. Intervals in which
  /// bodies move by no more than a few sizes are as short as half of them would not have fewer.
  std::vector<PairInReach> pairs_of_an_interval(double t, double& duration) {
    const std::size_t many = kManyPairs * moving_.size();
    if (auto few = few_pairs_in_reach(t, duration, many)) return *std::move(few);
    const double short_duration = duration_of_short_ways(t, duration);
    while (duration > short_duration) {
      duration = std::max(short_duration, 0.5 * duration);
      if (auto few = few_pairs_in_reach(t, duration, many)) return *std::move(few);
    }
    std::vector<PairInReach> pairs = pairs_in_reach(t, duration);
    while (pairs.size() > many) {
      std::vector<PairInReach> fewer = pairs_in_reach(t, 0.5 * duration);
      if (static_cast<double>(fewer.size()) > kStill * static_cast<double>(pairs.size())) break;
      pairs = std::move(fewer);
      duration *= 0.5;
    }
    return pairs;
  }

  /// Returns a duration, not longer than the given one, in which no point of a body moves further than a few sizes.
  double duration_of_short_ways(double t, double duration) {
    double shortest = duration;
    for (const MovingBody& moving : moving_) {
      const double radius = shape_of(moving.body).bounding_radius();
      for (int k = 0; k < kMostShortenings; ++k) {
        const double way = speed_of(moving, t, shortest) * shortest;
        if (way <= kShortWay * radius) break;
        // Over shorter intervals the speed may be less.
        shortest *= std::max(1.0 / 1024, kShortWay * radius / way);
      }
    }
    return shortest;
  }

  /// Returns a bound of the speed of a body's points.
  double speed_of(const MovingBody& moving, double t, double duration) {
    const internal::PointBounds bounds(moving.motion.bounds(t, t + duration), shape_of(moving.body).bounding_radius());
    if (!std::isfinite(bounds.speed)) internal::refuse_infinite_speeds({"first_contact"}, t, t + duration);
    return bounds.speed;
  }

  /// Puts bodies where they are at a time.
  void move(double t) {
    for (std::size_t k = 0; k < moving_.size(); ++k) poses_[k] = moving_[k].motion.pose(t);
    scene_.move(bodies_, poses_);
  }

  /// Puts bodies where they are at a later time, and checks that they have got no further than their bounds allow:
  /// pairs out of reach are not looked at.
  void move_on(double from, double to) {
    const std::vector<Pose> before = poses_;
    move(to);
    if (!(to > from)) return;
    for (std::size_t k = 0; k < moving_.size(); ++k) {
      const GivenMotion& motion = moving_[k].motion;
      internal::check_way("first_contact", number_of(bodies_[k]), "", motion.bounds(from, to), motion,
                          {from, before[k]}, {to, poses_[k]}, shape_of(bodies_[k]).bounding_radius());
    }
  }

  const AnyConvex& shape_of(BodyId body) {
    const auto found = shapes_.find(body);
    if (found != shapes_.end()) return found->second;
    const AnyConvex shape = std::visit([](const auto& s) { return AnyConvex(s); }, scene_.shape(body));
    return shapes_.emplace(body, shape).first->second;
  }

  GivenMotion motion_of(BodyId body, const Vector3d& image) const {
    const auto found = index_of_.find(body);
    if (found == index_of_.end()) return GivenMotion::resting(moved(scene_.pose(body), image));
    return moved(moving_[found->second].motion, image);
  }

  double reach_of(BodyId body) const {
    const auto found = index_of_.find(body);
    return found == index_of_.end() ? 0 : reach_[found->second];
  }

  /// Sets how far bodies get within a duration.
  void reach_until(double t, double duration) {
    reach_.clear();
    most_ = second_ = 0;
    for (const MovingBody& moving : moving_) {
      const double slack = options_.tolerance * shape_of(moving.body).bounding_radius();
      reach_.push_back(speed_of(moving, t, duration) * duration + slack);
      second_ = std::max(second_, std::min(most_, reach_.back()));
      most_ = std::max(most_, reach_.back());
    }
  }

  /// Returns whether a body that moves reaches over too many images of bodies to compare them with it.
  bool reaches_many_images() const {
    if (!(most_ <= kLongestWay)) return true;
    const Vector3d cells = (1 + 2 * (most_ + second_) * coordinates_.rowwise().norm().array()).matrix();
    const double images = cells.prod();
    return images > 1 && images * static_cast<double>(scene_.size()) > kManyImages;
  }

  /// Returns the pairs that may touch within a duration; nullopt if they are more than `many`, or if too many others
  /// would have to be compared.
  std::optional<std::vector<PairInReach>> few_pairs_in_reach(double t, double duration, std::size_t many) {
    reach_until(t, duration);
    if (reaches_many_images()) return std::nullopt;
    return pairs_found(many);
  }
  std::vector<PairInReach> pairs_in_reach(double t, double duration) {
    reach_until(t, duration);
    return *pairs_found(std::numeric_limits<std::size_t>::max() / kComparisons);
  }

  /// Returns the reach up to which neighbours of all bodies are looked for at once; -1: those that move are few. Few
  /// bodies, much faster than others, may get further.
  double common_reach() const {
    const std::size_t few = scene_.size() / kShareOfFew;
    if (moving_.size() <= few) return -1;
    std::vector<double> sorted = reach_;
    const auto nth = sorted.begin() + static_cast<std::ptrdiff_t>(few);
    std::nth_element(sorted.begin(), nth, sorted.end(), std::greater<>());
    return kMuchFurther * *nth;
  }

  /// Returns the pairs that may touch, in the order of handles; nullopt: many.
  std::optional<std::vector<PairInReach>> pairs_found(std::size_t many) {
    std::vector<PairInReach> found;
    std::size_t compared = 0;
    const auto go_on = [&] { return found.size() <= many && compared <= kComparisons * many; };
    const auto visit = [&](BodyId i, BodyId j, const Vector3d& image) {
      ++compared;
      if (!index_of_.contains(i) && !index_of_.contains(j)) return go_on();
      const Vector3d way = scene_.pose(j).position() + image - scene_.pose(i).position();
      const double reach = shape_of(i).bounding_radius() + shape_of(j).bounding_radius() + reach_of(i) + reach_of(j);
      if (way.norm() <= reach * (1 + 1e-12)) found.push_back({i, j, image});
      return go_on();
    };
    const double common = common_reach();
    if (common >= 0) scene_.candidates(std::min(most_ + second_, 2 * common), visit);
    for (std::size_t k = 0; k < moving_.size() && go_on(); ++k) {
      if (reach_[k] > common) visit_near(k, reach_[k] < most_ ? most_ : second_, visit);
    }
    if (!go_on()) return std::nullopt;
    std::sort(found.begin(), found.end(), [](const PairInReach& a, const PairInReach& b) { return a.key() < b.key(); });
    const auto same = [](const PairInReach& a, const PairInReach& b) { return a.key() == b.key(); };
    found.erase(std::unique(found.begin(), found.end(), same), found.end());
    return found;
  }

  /// Visits the bodies near one that moves.
  template <class Visit>
  void visit_near(std::size_t k, double reach_of_others, const Visit& visit) {
    const BodyId body = bodies_[k];
    const geom::Filter filter = scene_.filter(body);
    const double radius = (shape_of(body).bounding_radius() + reach_[k] + reach_of_others) * (1 + 1e-12);
    std::vector<geom::SceneImage> near;
    scene_.overlapping(geom::Sphere(radius), Pose::translation(poses_[k].position()), near);
    for (const geom::SceneImage& other : near) {
      if (other.body == body) continue;
      if (!geom::meet(filter, scene_.filter(other.body))) continue;
      const bool before = body < other.body;
      const Vector3d image = before ? other.image : Vector3d(Vector3d::Zero() - other.image);  // without -0
      if (!visit(before ? body : other.body, before ? other.body : body, image)) return;
    }
  }

  /// Searches pairs, each up to the earliest outcome so far.
  void search_pairs(const std::vector<PairInReach>& pairs, double from, double until, SceneContact& first) {
    first.contact.status = ContactStatus::separated;
    first.contact.time = until;
    for (const PairInReach& pair : pairs) {
      const GivenMotion a = motion_of(pair.i, Vector3d::Zero()), b = motion_of(pair.j, pair.image);
      const ContactResult found = internal::given_contact(internal::pair_of(shape_of(pair.i), shape_of(pair.j)), a, b,
                                                          {"first_contact", number_of(pair.i), number_of(pair.j)}, from,
                                                          first.contact.time, options_);
      evaluations_ += found.evaluations;
      if (found.status == ContactStatus::separated) continue;
      if (first.contact.status != ContactStatus::separated && !(found.time < first.contact.time)) continue;
      first = {pair.i, pair.j, pair.image, found};
    }
  }

  Scene& scene_;
  std::span<const MovingBody> moving_;
  const GivenContactOptions& options_;
  std::vector<BodyId> bodies_;
  Matrix3d coordinates_;
  std::vector<Pose> poses_;
  std::vector<double> reach_;     ///< largest way of the points of each moving body
  double most_ = 0, second_ = 0;  ///< the largest of them and the second largest
  std::map<BodyId, std::size_t> index_of_;
  std::map<BodyId, AnyConvex> shapes_;
  std::int64_t evaluations_ = 0;
};

}  // namespace

SceneContact first_contact(Scene& scene, std::span<const MovingBody> moving, double t_min, double t_max,
                           const GivenContactOptions& options) {
  internal::check_given("first_contact", options, t_min, t_max);
  return SceneSearch(scene, moving, options).find(t_min, t_max);
}

}  // namespace ed
