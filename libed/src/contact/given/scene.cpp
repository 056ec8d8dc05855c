#include "contact/given/search.h"
#include "motion/given/promises.h"

#include <ed/given/scene.h>

#include <geom/any_convex.h>
#include <geom/round_shapes.h>

#include <Eigen/Core>

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <stdexcept>
#include <string>
#include <tuple>
#include <utility>
#include <variant>
#include <vector>

namespace ed {
namespace {

using Eigen::Vector3d;
using geom::AnyConvex;
using geom::BodyId;
using geom::Pose;
using geom::Scene;

/// Largest number of candidates, for each body that moves, for which an interval is not made shorter.
constexpr std::size_t kManyCandidates = 32;
/// Ratio of the numbers of candidates of an interval and of half of it, above which shorter ones would not help.
constexpr double kStill = 0.8;
/// Longest way of a body's points in an interval, in bounding radii.
constexpr double kFarthest = 4;
/// Largest number of times that an interval is made shorter for a body.
constexpr int kMostIntervals = 64;
/// Ratio of bodies to bodies in motion from which on those in motion ask for their neighbours one by one.
constexpr std::size_t kFewMove = 8;

internal::GivenPair pair_of(const AnyConvex& a, const AnyConvex& b) {
  return {[&](const Pose& X_WA, const Pose& X_WB, const geom::DistanceOptions& options) {
            return geom::distance(a, X_WA, b, X_WB, options);
          },
          [&](const Vector3d& n) { return a.support(n).height; },
          [&](const Vector3d& n) { return b.support(n).height; }, a.bounding_radius(), b.bounding_radius()};
}

Pose shifted(const Pose& X, const Vector3d& by) {
  return geom::kernel::unchecked_pose(X.rotation(), X.position() + by);
}

GivenMotion shifted(const GivenMotion& motion, const Vector3d& by) {
  if (by.isZero(0)) return motion;
  return {[motion, by](double t) { return shifted(motion.pose(t), by); },
          [motion](double from, double to) { return motion.bounds(from, to); }, motion.scales()};
}

std::int64_t number_of(BodyId body) {
  return static_cast<std::int64_t>(body);
}

/// Pair of bodies that may touch, i < j.
struct Candidate {
  BodyId i{}, j{};
  Vector3d image;

  /// Returns what candidates are ordered by.
  auto key() const { return std::tuple(i, j, image.x(), image.y(), image.z()); }
};

class SceneSearch {
 public:
  SceneSearch(Scene& scene, std::span<const MovingBody> moving, const GivenContactOptions& options)
      : scene_(scene), moving_(moving), options_(options) {
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
    before_ = poses_;
  }

  SceneContact find(double t_min, double t_max) {
    try {
      return search(t_min, t_max);
    } catch (...) {
      scene_.move(bodies_, before_);
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
      duration = short_enough(t, std::min(duration, t_max - t));
      std::vector<Candidate> candidates = candidates_until(t, duration);
      while (candidates.size() > kManyCandidates * moving_.size()) {
        std::vector<Candidate> fewer = candidates_until(t, 0.5 * duration);
        if (static_cast<double>(fewer.size()) > kStill * static_cast<double>(candidates.size())) break;
        candidates = std::move(fewer);
        duration *= 0.5;
      }
      double until = t + duration < t_max ? t + duration : t_max;
      if (!(until > t)) until = std::min(t_max, std::nextafter(t, t_max));  // the clock is coarse
      search_pairs(candidates, t, until, first);
      if (first.contact.status != ContactStatus::separated || until == t_max) break;
      t = until;
      duration *= 2;
      move(t);
    }
    move(first.contact.time);
    first.contact.evaluations = static_cast<int>(std::min<std::int64_t>(evaluations_, std::numeric_limits<int>::max()));
    return first;
  }

  /// Returns an interval, at most `duration`, in which no point of a body moves further than a few sizes: others would
  /// have too many candidates, and reach over too many images of a lattice.
  double short_enough(double t, double duration) {
    double shortest = duration;
    for (const MovingBody& moving : moving_) {
      const double radius = shape_of(moving.body).bounding_radius();
      for (int k = 0; k < kMostIntervals; ++k) {
        const double way = speed_of(moving, t, shortest) * shortest;
        if (way <= kFarthest * radius) break;
        // Over shorter intervals the speed may be less.
        shortest *= std::max(1.0 / 1024, kFarthest * radius / way);
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

  const AnyConvex& shape_of(BodyId body) {
    const auto found = shapes_.find(body);
    if (found != shapes_.end()) return found->second;
    const AnyConvex shape = std::visit([](const auto& s) { return AnyConvex(s); }, scene_.shape(body));
    return shapes_.emplace(body, shape).first->second;
  }

  GivenMotion motion_of(BodyId body, const Vector3d& image) const {
    const auto found = index_of_.find(body);
    if (found == index_of_.end()) return GivenMotion::resting(shifted(scene_.pose(body), image));
    return shifted(moving_[found->second].motion, image);
  }

  double reach_of(BodyId body) const {
    const auto found = index_of_.find(body);
    return found == index_of_.end() ? 0 : reach_[found->second];
  }

  /// Returns the pairs that may touch within a duration, in the order of handles.
  std::vector<Candidate> candidates_until(double t, double duration) {
    reach_.clear();
    double most = 0, second = 0;  // the largest and the second largest
    for (const MovingBody& moving : moving_) {
      const double slack = options_.tolerance * shape_of(moving.body).bounding_radius();
      reach_.push_back(speed_of(moving, t, duration) * duration + slack);
      second = std::max(second, std::min(most, reach_.back()));
      most = std::max(most, reach_.back());
    }
    std::vector<Candidate> found;
    const auto visit = [&](BodyId i, BodyId j, const Vector3d& image) {
      if (!index_of_.contains(i) && !index_of_.contains(j)) return true;
      const Vector3d way = scene_.pose(j).position() + image - scene_.pose(i).position();
      const double reach = shape_of(i).bounding_radius() + shape_of(j).bounding_radius() + reach_of(i) + reach_of(j);
      if (way.norm() <= reach * (1 + 1e-12)) found.push_back({i, j, image});
      return true;
    };
    if (kFewMove * moving_.size() > scene_.size()) {
      scene_.candidates(most + second, visit);
    } else {
      for (std::size_t k = 0; k < moving_.size(); ++k) visit_near(k, reach_[k] < most ? most : second, visit);
    }
    std::sort(found.begin(), found.end(), [](const Candidate& a, const Candidate& b) { return a.key() < b.key(); });
    const auto same = [](const Candidate& a, const Candidate& b) { return a.key() == b.key(); };
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
      if (body < other.body) {
        visit(body, other.body, other.image);
      } else {
        visit(other.body, body, Vector3d(Vector3d::Zero() - other.image));  // without -0
      }
    }
  }

  /// Searches pairs, each up to the earliest outcome so far.
  void search_pairs(const std::vector<Candidate>& candidates, double from, double until, SceneContact& first) {
    first.contact.status = ContactStatus::separated;
    first.contact.time = until;
    for (const Candidate& pair : candidates) {
      const GivenMotion a = motion_of(pair.i, Vector3d::Zero()), b = motion_of(pair.j, pair.image);
      const ContactResult found = internal::given_contact(pair_of(shape_of(pair.i), shape_of(pair.j)), a, b,
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
  std::vector<Pose> poses_, before_;
  std::vector<double> reach_;  ///< largest way of the points of each moving body
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
