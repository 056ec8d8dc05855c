// The paper's contact search against the certified one, on pairs of neighbours of a dense fluid with thermal motion:
// how many contacts does it step over, for which eps_d? HARDBODY_FULL=1 looks at 10^5 contacts.
//
// Two independent ways to every contact: they share the distance kernel and nothing else, and with newton8 and newton5
// not even that.

#include <common/ed/all_pairs.h>
#include <common/ed/states.h>
#include <common/finder/ensemble.h>
#include <common/full_form.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <array>
#include <cmath>
#include <cstdio>
#include <vector>

namespace {

using ed::ContactStatus;
using ed_test::Inertia;
using Eigen::Vector3d;

/// Two searches that found the same contact agree within this (time unit); a grazing one turns the rounding error 1e-15
/// of a distance into the square root of it.
constexpr double kSameTime = 1e-7;

constexpr double kHorizon = 0.5;

struct MovingPair {
  ed::Motion a, b;
};

ed::Motion motion_of(const ed::System& system, const ed::Body& body, const Vector3d& position) {
  return {geom::Pose(body.rotation, position), body.velocity, body.angular_velocity, system.species[0].inertia, 0};
}

/// All pairs whose bounding spheres are at most 0.3 apart.
std::vector<MovingPair> neighbours(const ed::System& system) {
  std::vector<MovingPair> pairs;
  const double reach = 2 * ed_test::ellipsoid_of(system).bounding_radius() + 0.3;
  ed_test::for_each_pair(system, [&](const ed::Body& a, const ed::Body& b, const Vector3d& r) {
    if (r.norm() < reach) pairs.push_back({motion_of(system, a, Vector3d::Zero()), motion_of(system, b, r)});
  });
  return pairs;
}

struct Method {
  ed::ContactOptions options;
  const char* name;
  long contacts = 0;
  long missed = 0;  ///< no contact, a later one, or bodies found in each other
  long early = 0;   ///< a contact where the certified search has none yet
  long rescues = 0;
};

Method bracketing(double eps_d, ed::DistanceMethod distance, ed::ContactRoot root, const char* name) {
  Method method{{}, name};
  method.options.finder = ed::Finder::bracketing;
  method.options.eps_d = eps_d;
  method.options.distance = distance;
  method.options.root = root;
  return method;
}

void compare(const geom::Ellipsoid& shape, const MovingPair& pair, Method& method, const ed::ContactResult& certified) {
  const ed::ContactResult r = ed::time_of_contact(shape, pair.a, shape, pair.b, kHorizon, method.options);
  method.rescues += r.rescues;
  if (certified.status == ContactStatus::hit) {
    ++method.contacts;
    if (r.status != ContactStatus::hit || r.time > certified.time + kSameTime) ++method.missed;
    if (r.status == ContactStatus::hit && r.time < certified.time - kSameTime) ++method.early;
  } else {
    ASSERT_EQ(certified.status, ContactStatus::separated);
    if (r.status != ContactStatus::separated) ++method.early;
  }
}

void run(std::array<Method, 5>& methods, double aspect_ratio, long contacts, std::uint64_t seed) {
  const ed::System start = ed_test::equilibrated({aspect_ratio, 0.40, 256, Inertia::paper, seed}, 0.5);
  ed::Simulation simulation(start);
  const long before = methods[0].contacts;
  while (methods[0].contacts - before < contacts) {
    simulation.run_until(simulation.time() + 0.3);
    const ed::System system = simulation.system();
    for (const MovingPair& pair : neighbours(system)) {
      const ed::ContactResult certified =
          ed::time_of_contact(ed_test::ellipsoid_of(system), pair.a, ed_test::ellipsoid_of(system), pair.b, kHorizon);
      for (Method& method : methods) compare(ed_test::ellipsoid_of(system), pair, method, certified);
    }
  }
}

TEST(Bracketing, ContactsMissedAtThreeResolutions) {
  using ed::ContactRoot;
  using ed::DistanceMethod;
  std::array<Method, 5> methods{
      bracketing(1e-3, DistanceMethod::dual, ContactRoot::newton, "eps_d 1e-3, dual"),
      bracketing(1e-4, DistanceMethod::dual, ContactRoot::newton, "eps_d 1e-4, dual"),
      bracketing(1e-5, DistanceMethod::dual, ContactRoot::newton, "eps_d 1e-5, dual"),
      bracketing(1e-5, DistanceMethod::dual, ContactRoot::one_dimensional, "eps_d 1e-5, dual, 1-D root"),
      bracketing(1e-5, DistanceMethod::newton5, ContactRoot::newton, "eps_d 1e-5, newton5"),
  };
  const long contacts = full_form() ? 34000 : 1500;
  std::uint64_t seed = 200;
  for (const double aspect_ratio : {1.0 / 3, 2.0, 3.0}) run(methods, aspect_ratio, contacts, ++seed);
  for (const Method& method : methods) {
    std::printf("%-28s %ld of %ld contacts missed, %ld early, %ld distances by the dual instead\n", method.name,
                method.missed, method.contacts, method.early, method.rescues);
    // A contact where the certified search has none would be one that *it* has missed.
    EXPECT_EQ(method.early, 0) << method.name;
    EXPECT_EQ(method.missed, 0) << method.name;
  }
}

/// Contacts that graze, made on purpose: bodies that touch nearly tangentially, or pass with an overlap of 1e-10 to
/// 1e-3 of their size, turning up to 20 times as fast as thermal bodies.
MovingPair grazing_pair(finder_test::Fluid& fluid) {
  ed::Random& random = fluid.random();
  const Vector3d inertia = fluid.spins() ? fluid.shape().inertia(1.0) : ed::paper_species(fluid.shape()).inertia;
  const auto motion = [&](const finder_test::BodyState& s) {
    return ed::Motion{geom::Pose(s.rotation, s.position), s.velocity, s.omega(), inertia, 0};
  };
  while (true) {
    const double boost = finder_test::log_uniform(random, 1, 20);
    const bool tangential = random.uniform() < 0.5;
    const double share = tangential ? 0 : -finder_test::log_uniform(random, 1e-4, 1e-2);
    const double gap = tangential ? -fluid.size() * finder_test::log_uniform(random, 1e-10, 1e-3) : 0;
    const auto start =
        fluid.approach(fluid.touching_pair(boost, share, gap), finder_test::log_uniform(random, 0.01, 0.3));
    if (start) return {motion(start->a), motion(start->b)};
  }
}

TEST(Bracketing, GrazingContactsMissedAtFourResolutions) {
  using ed::ContactRoot;
  using ed::DistanceMethod;
  std::array<Method, 5> methods{
      bracketing(1e-2, DistanceMethod::dual, ContactRoot::newton, "eps_d 1e-2, dual"),
      bracketing(1e-3, DistanceMethod::dual, ContactRoot::newton, "eps_d 1e-3, dual"),
      bracketing(1e-4, DistanceMethod::dual, ContactRoot::newton, "eps_d 1e-4, dual"),
      bracketing(1e-5, DistanceMethod::dual, ContactRoot::newton, "eps_d 1e-5, dual"),
      bracketing(1e-5, DistanceMethod::newton5, ContactRoot::newton, "eps_d 1e-5, newton5"),
  };
  const long contacts = full_form() ? 17000 : 250;
  std::uint64_t seed = 300;
  for (const double aspect_ratio : {1.0 / 3, 2.0, 3.0}) {
    const auto pairs = finder_test::near_neighbours(aspect_ratio, 0.40, 100, seed++);
    for (const bool spins : {false, true}) {
      finder_test::Fluid fluid(aspect_ratio, spins, pairs, seed++);
      const long before = methods[0].contacts;
      while (methods[0].contacts - before < contacts) {
        const MovingPair pair = grazing_pair(fluid);
        const ed::ContactResult certified = ed::time_of_contact(fluid.shape(), pair.a, fluid.shape(), pair.b, kHorizon);
        for (Method& method : methods) compare(fluid.shape(), pair, method, certified);
      }
    }
  }
  for (const Method& method : methods) {
    std::printf("grazing, %-20s %ld of %ld contacts missed, %ld early, %ld distances by the dual instead\n",
                method.name, method.missed, method.contacts, method.early, method.rescues);
    EXPECT_EQ(method.early, 0) << method.name;
    if (method.options.eps_d < 5e-3) {
      EXPECT_EQ(method.missed, 0) << method.name;
    }
  }
  // That the finder with a resolution does miss contacts.
  EXPECT_GT(methods[0].missed, 0);
}

TEST(Bracketing, ParabolaFindsContactsThatStepsPassOver) {
  // Parallel rods whose circles of radius 1 pass with an overlap of 1e-9 to 1e-7: in contact over a way of 4
  // sqrt(overlap), 1e-4 to 1e-3, which steps of eps_d = 1e-2 meet once in some tens of times. The rest is the
  // parabola's (step 6).
  const geom::Ellipsoid rod({1, 1, 1.5});
  ed::Random random(401);
  ed::ContactOptions options;
  options.finder = ed::Finder::bracketing;
  options.eps_d = 1e-2;
  for (int k = 0; k < 500; ++k) {
    const double offset = 2 - finder_test::log_uniform(random, 1e-9, 1e-7);
    const double start = 3 + random.uniform();
    const ed::Motion a{geom::Pose(), {1, 0, 0}, Vector3d::Zero(), rod.inertia(1), 0};
    const ed::Motion b{geom::Pose::translation({start, offset, 0}), Vector3d::Zero(), Vector3d::Zero(), rod.inertia(1),
                       0};
    const ed::ContactResult r = ed::time_of_contact(rod, a, rod, b, 10, options);
    ASSERT_EQ(r.status, ContactStatus::hit) << 2 - offset;
    // The rounding error of the distance, 1e-15, over the normal velocity, sqrt(overlap) or more.
    EXPECT_NEAR(r.time, start - std::sqrt((2 - offset) * (2 + offset)), 1e-9);
  }
}

}  // namespace
