// hardbody::ed as an outside project sees it; "answers" as in geom_consumer.cpp.
#include <ed/ed.h>

#include <cmath>
#include <cstdio>
#include <cstring>

namespace {

int known_answers() {
  const geom::Ellipsoid ball({1.0, 1.0, 1.0});
  ed::Motion a, b;
  b.pose = geom::Pose::translation({5.0, 0.0, 0.0});
  b.velocity = {-1.5, 0.0, 0.0};
  const ed::ContactResult hit = ed::time_of_contact(ball, a, ball, b, 10.0);
  std::printf("%s %g\n", to_string(hit.status), hit.time);
  // A gap of 3 at speed 1.5, to rounding.
  return hit.status == ed::ContactStatus::hit && std::abs(hit.time - 2.0) < 1e-14 ? 0 : 1;
}

template <class T>
void layout(const char* name) {
  std::printf("%s: %zu bytes, aligned to %zu\n", name, sizeof(T), alignof(T));
}

/// A short run: the consumer frees what the library allocated, and the other way round.
void answers() {
  layout<ed::Motion>("Motion");
  layout<ed::ContactBody>("ContactBody");
  layout<ed::ContactOptions>("ContactOptions");
  layout<ed::ContactResult>("ContactResult");
  layout<ed::Species>("Species");
  layout<ed::Body>("Body");
  layout<ed::System>("System");
  layout<ed::Snapshot>("Snapshot");
  layout<ed::Counters>("Counters");
  layout<ed::FailedPair>("FailedPair");
  layout<ed::SimulationOptions>("SimulationOptions");
  layout<ed::StartOptions>("StartOptions");
  layout<ed::Results>("Results");
  layout<ed::Audit>("Audit");

  const ed::Species species = ed::paper_species(geom::Ellipsoid({1.0, 1.0, 2.0}));
  const ed::System start = ed::random_start(species, {.number = 64, .packing_fraction = 0.1, .progress = {}});
  ed::Simulation simulation(start);
  ed::Observables observables({.number = start.size(), .duration = 2.0});
  simulation.record_collisions(300);
  while (observables.next_time() <= 2.0) {
    simulation.run_until(observables.next_time());
    observables.measure(simulation);
  }
  for (const ed::Collision& c : simulation.collisions()) std::printf("%a %d %d\n", c.time, c.i, c.j);
  const ed::System end = simulation.system();
  for (const ed::Body& body : end.bodies) {
    std::printf("%a %a %a\n", body.position.x(), body.velocity.y(), body.rotation(2, 2));
  }
  const ed::Results results = observables.results(simulation);
  std::printf("%a %a %zu lags, overlaps %d\n", results.collision_rate.value, results.Z.value, results.lags.size(),
              ed::audit(end).overlaps);
}

}  // namespace

int main(int argc, char** argv) {
  if (argc == 2 && std::strcmp(argv[1], "answers") == 0) {
    answers();
    return 0;
  }
  return known_answers();
}
