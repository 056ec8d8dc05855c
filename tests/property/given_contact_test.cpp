/// Contacts on given motions, judged by distances at many times, which share nothing with the search but libgeom.
/// HARDBODY_FULL=1: 10,000 pairs of each kind of motion.

#include <common/full_form.h>
#include <common/geom/random.h>

#include <ed/ed.h>

#include <geom/geom.h>

#include <gtest/gtest.h>

#include <Eigen/Core>
#include <Eigen/Geometry>

#include <algorithm>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

using ed::BodyShape;
using ed::ContactResult;
using ed::ContactStatus;
using ed::GivenMotion;
using Eigen::Vector3d;
using geom::Pose;
using geom_test::Random;

constexpr double kEnd = 4;

struct Trial {
  BodyShape a, b;
  GivenMotion motion_a, motion_b;

  geom::DistanceResult at(double t) const { return ed::distance(a, motion_a.pose(t), b, motion_b.pose(t)); }
  double distance(double t) const { return at(t).distance; }
  double size() const { return ed::bounding_radius(a) + ed::bounding_radius(b); }
};

BodyShape random_shape(Random& random) {
  switch (static_cast<int>(7 * random.uniform())) {
    case 0:
      return random.biaxial(3);
    case 1:
      return geom::Superellipsoid({1, random.uniform(0.5, 1.5), 0.7}, random.uniform(0.3, 1), random.uniform(0.3, 1));
    case 2:
      return geom::Box({random.uniform(0.3, 1.2), random.uniform(0.3, 1.2), 0.8});
    case 3:
      return geom::Capsule(random.uniform(0.3, 1.5), 0.5);
    case 4:
      return geom::Cylinder(random.uniform(0.3, 1), 0.7);
    case 5:
      return geom::Sphere(random.uniform(0.3, 1));
    default:
      return geom::Cone(1.5, 0.8);
  }
}

GivenMotion random_screw(Random& random, const Vector3d& position) {
  ed::Screw screw;
  screw.pose = random.pose(position);
  screw.point = position + random.uniform(0, 2) * random.direction();
  screw.axis = random.direction();
  screw.angular_speed = random.uniform(-2, 2);
  screw.speed = random.uniform(-1, 1);
  return GivenMotion::screw(screw);
}

GivenMotion random_spline(Random& random, const Vector3d& position) {
  std::vector<double> times;
  std::vector<Pose> poses;
  Eigen::Quaterniond q(random.pose(Vector3d(0, 0, 0)).rotation());
  Vector3d p = position;
  for (int k = 0; k < 6; ++k) {
    times.push_back(k + (k == 0 || k == 5 ? 0 : random.uniform(-0.3, 0.3)));
    poses.push_back(Pose::normalized_quaternion(q, p));
    p += random.uniform(0, 1.5) * random.direction();
    q = Eigen::Quaterniond(Eigen::AngleAxisd(random.uniform(0, 1.2), random.direction())) * q;
  }
  return GivenMotion::spline(times, poses);
}

/// Time at which the distance, in [low, high], is least: among equal steps, then by golden section around the best.
double time_of_least(const Trial& trial, double low, double high, int steps) {
  double best = low, least = trial.distance(low);
  for (int k = 1; k <= steps; ++k) {
    const double t = low + (high - low) * k / steps, d = trial.distance(t);
    if (d < least) {
      least = d;
      best = t;
    }
  }
  constexpr double kGolden = 0.6180339887498949;
  double from = std::max(low, best - (high - low) / steps), to = std::min(high, best + (high - low) / steps);
  double s = to - kGolden * (to - from), t = from + kGolden * (to - from);
  double ds = trial.distance(s), dt = trial.distance(t);
  for (int k = 0; k < 45; ++k) {
    if (ds < dt) {
      to = t;
      t = s;
      dt = ds;
      ds = trial.distance(s = to - kGolden * (to - from));
    } else {
      from = s;
      s = t;
      ds = dt;
      dt = trial.distance(t = from + kGolden * (to - from));
    }
  }
  return ds < dt ? s : t;
}

/// Moves B so that the bodies graze: the least distance becomes about the given one.
void let_graze(Trial& trial, double least) {
  for (int k = 0; k < 4; ++k) {
    const double t = time_of_least(trial, 0, kEnd, 60);
    const geom::DistanceResult at = ed::distance(trial.a, trial.motion_a.pose(t), trial.b, trial.motion_b.pose(t));
    if (at.status == geom::DistanceStatus::not_converged) return;
    const Vector3d by = (least - at.distance) * at.normal;
    const GivenMotion motion = trial.motion_b;
    trial.motion_b = GivenMotion(
        [motion, by](double time) {
          const Pose X = motion.pose(time);
          return Pose(X.rotation(), X.position() + by);
        },
        [motion](double from, double to) { return motion.bounds(from, to); });
  }
}

struct Counts {
  int hits = 0, separated = 0, overlapping = 0, others = 0, grazing = 0;
  long evaluations = 0;
};

void judge(const Trial& trial, const ContactResult& found, int number, Counts& counts) {
  const double seen = 1e-11 * trial.size();
  counts.evaluations += found.evaluations;
  switch (found.status) {
    case ContactStatus::overlapping:
      ++counts.overlapping;
      EXPECT_EQ(found.time, 0) << number;
      EXPECT_LT(trial.distance(0), 0) << number;
      return;
    case ContactStatus::hit:
      ++counts.hits;
      {
        // Distances of bodies that touch are between two bounds.
        const geom::DistanceResult at = trial.at(found.time);
        EXPECT_LE(at.distance, (geom::kBoundGap + 2e-13) * trial.size()) << number;
        EXPECT_GE(at.distance + at.error_bound, -1e-12 * trial.size()) << number;
      }
      if (found.time > 0) {
        EXPECT_GE(trial.distance(time_of_least(trial, 0, found.time, 100)), -seen) << number;
      }
      return;
    case ContactStatus::separated:
      ++counts.separated;
      EXPECT_EQ(found.time, kEnd) << number;
      EXPECT_GE(trial.distance(time_of_least(trial, 0, kEnd, 100)), -seen) << number;
      return;
    default:
      ++counts.others;
      ADD_FAILURE() << number << ": " << to_string(found.status);
  }
}

template <class MakeMotion>
Counts run(std::uint64_t seed, const MakeMotion& make) {
  Random random(seed);
  Counts counts;
  const int trials = full_form() ? 10000 : repetitions(1000);
  for (int i = 0; i < trials; ++i) {
    const BodyShape a = random_shape(random), b = random_shape(random);
    const Vector3d apart = random.uniform(1.5, 4) * random.direction();
    const GivenMotion motion_a = make(random, Vector3d::Zero());
    Trial trial{a, b, motion_a, make(random, apart)};
    if (i % 10 == 0) {
      const double least = (random.coin() ? 1 : -1) * random.log_uniform(1e-9, 1e-4);
      let_graze(trial, least);
      ++counts.grazing;
    }
    judge(trial, time_of_contact(trial.a, trial.motion_a, trial.b, trial.motion_b, 0, kEnd), i, counts);
  }
  std::printf(
      "%d trials, %d of them grazing: %d hits, %d separated, %d overlapping, %d others; %.1f evaluations each\n",
      trials, counts.grazing, counts.hits, counts.separated, counts.overlapping, counts.others,
      static_cast<double>(counts.evaluations) / trials);
  EXPECT_GT(counts.hits, trials / 10);
  EXPECT_GT(counts.separated, trials / 10);
  return counts;
}

TEST(GivenContact, OfScrewsMissesNone) {
  run(1, random_screw);
}

TEST(GivenContact, OfSplinesMissesNone) {
  run(2, random_spline);
}

TEST(GivenContact, OfJointsMissesNone) {
  run(3, [](Random& random, const Vector3d& position) {
    const GivenMotion link = random_screw(random, position);
    return random_screw(random, random.direction()).on(link);
  });
}

TEST(GivenContact, FindsMissesWithTooSmallBounds) {
  // The judge sees it when accelerations are promised that are not kept. Debug builds refuse most of these motions.
  Random random(4);
  int missed = 0, refused = 0;
  const int trials = repetitions(1000);
  for (int i = 0; i < trials; ++i) {
    const BodyShape a = random_shape(random), b = random_shape(random);
    const Trial trial{a, b, random_screw(random, Vector3d::Zero()), random_screw(random, 3 * random.direction())};
    const auto straight = [](const GivenMotion& motion) {
      return GivenMotion([motion](double t) { return motion.pose(t); },
                         [motion](double from, double to) {
                           ed::MotionBounds bounds = motion.bounds(from, to);
                           bounds.acceleration = 0;
                           return bounds;
                         },
                         motion.scales());
    };
    try {
      const ContactResult found =
          time_of_contact(trial.a, straight(trial.motion_a), trial.b, straight(trial.motion_b), 0, kEnd);
      const double until = found.status == ContactStatus::hit ? found.time : kEnd;
      if (until > 0 && trial.distance(time_of_least(trial, 0, until, 100)) < -1e-9) ++missed;
    } catch (const std::invalid_argument&) {
      ++refused;
    }
  }
  std::printf("of %d: %d misses, %d motions refused for their bounds\n", trials, missed, refused);
  EXPECT_GT(missed + refused, 0);
#ifdef NDEBUG
  EXPECT_GT(missed, 0);
#endif
}

TEST(GivenContact, AgreesWithFreeFlight) {
  Random random(5);
  int hits = 0;
  for (int i = 0; i < repetitions(300); ++i) {
    const BodyShape a = random_shape(random), b = random_shape(random);
    const auto motion = [&](const Vector3d& position, const Vector3d& velocity) {
      ed::Motion m;
      m.pose = random.pose(position);
      m.velocity = velocity;
      m.angular_velocity = random.uniform(0, 2) * random.direction();
      const double I = random.uniform(0.5, 1);
      m.inertia = random.coin() ? Vector3d(I, I, 0.7) : Vector3d(I, 0.8, 0.6);
      return m;
    };
    const Vector3d apart = 4 * random.direction();
    const ed::Motion motion_a = motion(Vector3d::Zero(), random.uniform(0, 0.3) * random.direction());
    const ed::Motion motion_b = motion(apart, -apart / 3 + random.uniform(0, 0.3) * random.direction());
    const ContactResult flight = time_of_contact(a, motion_a, b, motion_b, kEnd);
    const ContactResult given =
        time_of_contact(a, GivenMotion::flight(motion_a), b, GivenMotion::flight(motion_b), 0, kEnd);
    ASSERT_EQ(given.status, flight.status) << i;
    if (flight.status != ContactStatus::hit) continue;
    ++hits;
    // Grazing contacts' times are as uncertain as the root of the tolerance.
    EXPECT_NEAR(given.time, flight.time, 1e-6) << i;
    EXPECT_LE(given.time, flight.time + 1e-12) << i;
  }
  EXPECT_GT(hits, 100);
}

}  // namespace
