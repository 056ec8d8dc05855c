// Nothing allocates in the event loop in steady state: every form of operator new of this program counts its calls.

#include <common/ed_families.h>
#include <common/ed_states.h>

#include <ed/ed.h>

#include <gtest/gtest.h>

#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <new>
#include <string>

namespace {

std::uint64_t allocations = 0;

void* allocate(std::size_t size) {
  ++allocations;
  void* const memory = std::malloc(size > 0 ? size : 1);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

void* allocate_aligned(std::size_t size, std::align_val_t alignment) {
  ++allocations;
  const auto step = static_cast<std::size_t>(alignment);
  void* const memory = std::aligned_alloc(step, (size + step) / step * step);
  if (memory == nullptr) throw std::bad_alloc();
  return memory;
}

}  // namespace

// The other forms (nothrow, array) call these.
void* operator new(std::size_t size) {
  return allocate(size);
}
void* operator new[](std::size_t size) {
  return allocate(size);
}
void* operator new(std::size_t size, std::align_val_t alignment) {
  return allocate_aligned(size, alignment);
}
void* operator new[](std::size_t size, std::align_val_t alignment) {
  return allocate_aligned(size, alignment);
}
void operator delete(void* memory) noexcept {
  std::free(memory);
}
void operator delete[](void* memory) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete(void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}
void operator delete[](void* memory, std::size_t, std::align_val_t) noexcept {
  std::free(memory);
}

namespace {

using ed_test::Inertia;
using ed_test::State;

TEST(Allocations, AreCounted) {
  const std::uint64_t before = allocations;
  ::operator delete(::operator new(16));
  EXPECT_EQ(allocations, before + 1);
}

struct Length {
  std::uint64_t warm_up = 100000;  ///< lists, cells and buffers grow until each has met its largest size
  std::uint64_t collisions = 10000;
};

void expect_no_allocation(const std::string& what, const ed::System& start, const ed::SimulationOptions& options,
                          const Length& length) {
  ed::Simulation simulation(start, options);
  simulation.run_collisions(length.warm_up);
  const std::uint64_t before = allocations;
  const std::uint64_t rebuilds = simulation.counters().neighbour_rebuilds;
  simulation.run_collisions(length.collisions);
  const std::uint64_t count = allocations - before;
  std::printf("%s: %llu allocations in %llu collisions\n", what.c_str(), static_cast<unsigned long long>(count),
              static_cast<unsigned long long>(length.collisions));
  EXPECT_EQ(count, 0U);
  EXPECT_GT(simulation.counters().neighbour_rebuilds, rebuilds + length.collisions / 100);
}

void expect_no_allocation(const State& state, const ed::SimulationOptions& options = {}, const Length& length = {}) {
  expect_no_allocation(ed_test::describe(state), ed_test::start(state), options, length);
}

TEST(Allocations, NoneInSteadyStateOfGeneralBodies) {
  for (const ed_test::Family& family : ed_test::families(216)) {
    expect_no_allocation(family.name, ed_test::start(family, 0.40), {}, {5000, 3000});
  }
}

TEST(Allocations, NoneInSteadyStateOfRods) {
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 51});
}

TEST(Allocations, NoneInSteadyStateWithOrientedBoxes) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 53}, options);
}

TEST(Allocations, NoneInSteadyStateWithCells) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::cells;
  expect_no_allocation({2, 0.20, 256, Inertia::paper, 54}, options);
}

TEST(Allocations, NoneInSteadyStateOfThePapersFinder) {
  ed::SimulationOptions options;
  options.neighbours = ed::Neighbours::obp;
  options.contact.finder = ed::Finder::bracketing;
  options.contact.distance = ed::DistanceMethod::newton5;
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 55}, options, {8000, 2000});
}

TEST(Allocations, NoneByDistancesThatNewtonsMethodDeclines) {
  // Seeds in the middle of the bodies: a failure with each search, the first ones recorded.
  ed::SimulationOptions options;
  options.contact.finder = ed::Finder::bracketing;
  options.contact.distance = ed::DistanceMethod::newton5;
  options.contact.seed = [](const geom::Shape&, const geom::Pose& X_WA, const geom::Shape&, const geom::Pose& X_WB) {
    return geom::WitnessPair{X_WA.position(), X_WB.position(), geom::SeedStatus::usable};
  };
  expect_no_allocation({3, 0.40, 256, Inertia::paper, 56}, options, {4000, 1000});
}

TEST(Allocations, NoneInSteadyStateOfSpinningDiscs) {
  expect_no_allocation({0.5, 0.40, 256, Inertia::uniform, 52});
}

}  // namespace
