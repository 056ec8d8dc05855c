/// Other libraries' closest points, and bad ones, as the seed of the paper's contact search: the same contacts.

#include "common/ed/states.h"
#include "common/finder/ensemble.h"

#include <ed/ed.h>
#include <geom/seeds.h>
#if HARDBODY_WITH_CGAL
#include <geom/cgal.h>
#endif

#include <gtest/gtest.h>

#include <limits>
#include <string>
#include <vector>

namespace {

using ed_test::Inertia;
using geom::Ellipsoid;
using geom::Pose;
using geom::SeedStatus;
using geom::Shape;
using geom::WitnessPair;

struct Source {
  std::string name;
  ed::SeedFunction function;
  int searches;    ///< number of searches, a pair each: CGAL takes a millisecond
  int collisions;  ///< collisions of the short run
  bool good;       ///< Newton's method solves (nearly) all from there
};

std::vector<Source> sources() {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  std::vector<Source> all{
      {"fcl",
       [](const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
         return geom::fcl_seed(std::get<Ellipsoid>(a), X_WA, std::get<Ellipsoid>(b), X_WB);
       },
       300, 300, true},
      {"declining", [](auto&&...) { return WitnessPair{}; }, 300, 300, true},
      {"inside",
       [](const Shape&, const Pose& X_WA, const Shape&, const Pose& X_WB) {
         return WitnessPair{X_WA.position(), X_WB.position(), SeedStatus::usable};
       },
       300, 300, false},
      {"not a number",
       [nan](auto&&...) {
         const Eigen::Vector3d p = Eigen::Vector3d::Constant(nan);
         return WitnessPair{p, p, SeedStatus::usable};
       },
       300, 300, false},
  };
#if HARDBODY_WITH_CGAL
  all.push_back({"cgal",
                 [](const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
                   return geom::cgal_seed(std::get<Ellipsoid>(a), X_WA, std::get<Ellipsoid>(b), X_WB);
                 },
                 100, 20, true});
#endif
  return all;
}

ed::ContactOptions options_with(const Source& source, ed::DistanceMethod method, long& calls) {
  ed::ContactOptions options;
  options.finder = ed::Finder::bracketing;
  options.distance = method;
  options.seed = [&source, &calls](const Shape& a, const Pose& X_WA, const Shape& b, const Pose& X_WB) {
    ++calls;
    return source.function(a, X_WA, b, X_WB);
  };
  return options;
}

TEST(ContactSeeds, TimeOfContactIsTheSameFromEverySeed) {
  const auto neighbours = finder_test::near_neighbours(3, 0.3, 60, 1);
  for (const Source& source : sources()) {
    for (const auto method : {ed::DistanceMethod::newton8, ed::DistanceMethod::newton5}) {
      finder_test::Fluid fluid(3, false, neighbours, 2);
      const Eigen::Vector3d inertia = ed::paper_species(fluid.shape()).inertia;
      const auto motion = [&](const finder_test::BodyState& s) {
        return ed::Motion{Pose(s.rotation, s.position), s.velocity, s.omega(), inertia, 0};
      };
      long calls = 0;
      int hits = 0;
      int rescues = 0;
      const ed::ContactOptions options = options_with(source, method, calls);
      for (int k = 0; k < source.searches; ++k) {
        const finder_test::MovingPair pair = fluid.thermal_pair();
        const auto find = [&](const ed::ContactOptions& how) {
          return ed::time_of_contact(fluid.shape(), motion(pair.a), fluid.shape(), motion(pair.b), 1, how);
        };
        const ed::ContactResult wanted = find({});
        const ed::ContactResult r = find(options);
        ASSERT_EQ(r.status, wanted.status) << source.name;
        ASSERT_NEAR(r.time, wanted.time, 1e-9) << source.name;
        hits += r.status == ed::ContactStatus::hit;
        rescues += r.rescues;
      }
      EXPECT_GT(hits, source.searches / 5) << source.name;
      // Once a search, if the bounding spheres meet at all.
      EXPECT_GT(calls, source.searches / 2) << source.name;
      EXPECT_LE(calls, source.searches) << source.name;
      if (source.good) {
        EXPECT_LE(rescues, source.searches / 20) << source.name;
      } else {
        EXPECT_GT(rescues, 0) << source.name;
      }
    }
  }
}

TEST(ContactSeeds, CollisionsAreTheSameFromEverySeed) {
  const ed::System system = ed_test::start({2, 0.3, 64, Inertia::paper, 71});
  const auto collisions = [&](const ed::ContactOptions& contact, int number, std::uint64_t& rescues) {
    ed::SimulationOptions options;
    options.contact = contact;
    ed::Simulation simulation(system, options);
    simulation.record_collisions(static_cast<std::size_t>(number));
    simulation.run_collisions(static_cast<std::uint64_t>(number));
    EXPECT_EQ(simulation.counters().overlaps, 0U);
    rescues = simulation.counters().rescues;
    return simulation.collisions();
  };
  for (const Source& source : sources()) {
    for (const auto method : {ed::DistanceMethod::newton8, ed::DistanceMethod::newton5}) {
      long calls = 0;
      std::uint64_t rescues = 0;
      const auto wanted = collisions({}, source.collisions, rescues);
      const auto found = collisions(options_with(source, method, calls), source.collisions, rescues);
      ASSERT_EQ(found.size(), wanted.size());
      for (std::size_t k = 0; k < wanted.size(); ++k) {
        ASSERT_EQ(found[k].i, wanted[k].i) << source.name << ", collision " << k;
        ASSERT_EQ(found[k].j, wanted[k].j) << source.name << ", collision " << k;
        ASSERT_NEAR(found[k].time, wanted[k].time, 1e-9) << source.name;
      }
      EXPECT_GT(calls, source.collisions) << source.name;
      if (!source.good) {
        EXPECT_GT(rescues, 0U) << source.name;
      }
    }
  }
}

}  // namespace
