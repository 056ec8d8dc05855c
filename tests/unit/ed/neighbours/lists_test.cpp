#include <neighbours/lists.h>

#include <ed/archive.h>
#include <ed/random.h>

#include <Eigen/Core>

#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <map>
#include <set>
#include <stdexcept>
#include <string>
#include <utility>
#include <vector>

namespace {

using ed::internal::kNever;
using ed::internal::NeighbourLists;
using ed::internal::Pair;
using ed::internal::PairEvent;
using Eigen::Vector3d;

/// Lists, slots and pairs tell the same story, and it is that of the model: index -> (i, j).
void expect_consistent(const NeighbourLists& lists, const std::map<std::int32_t, std::pair<int, int>>& model) {
  std::size_t entries = 0;
  for (int body = 0; body < lists.number(); ++body) {
    std::set<std::int32_t> wanted;
    for (const auto& [index, bodies] : model) {
      if (bodies.first == body || bodies.second == body) wanted.insert(index);
    }
    const auto list = lists.of(body);
    ASSERT_EQ(std::set<std::int32_t>(list.begin(), list.end()), wanted) << "body " << body;
    ASSERT_EQ(list.size(), wanted.size()) << "body " << body << " lists a pair twice";
    for (std::size_t slot = 0; slot < list.size(); ++slot) {
      const Pair& pair = lists.pair(list[slot]);
      ASSERT_TRUE(pair.i == body || pair.j == body);
      ASSERT_EQ(static_cast<std::size_t>(pair.i == body ? pair.slot_i : pair.slot_j), slot);
    }
    entries += list.size();
  }
  ASSERT_EQ(entries, 2 * model.size());
  for (const auto& [index, bodies] : model) {
    const Pair& pair = lists.pair(index);
    ASSERT_EQ(pair.i, bodies.first);
    ASSERT_EQ(pair.j, bodies.second);
    ASSERT_EQ(pair.partner(pair.i), pair.j);
    ASSERT_EQ(pair.partner(pair.j), pair.i);
  }
}

/// Drops the list of a body from both, and tests what it says to the callback.
void drop(NeighbourLists& lists, int body, std::map<std::int32_t, std::pair<int, int>>& model) {
  const std::vector<std::int32_t> list(lists.of(body).begin(), lists.of(body).end());
  std::vector<std::int32_t> removed;
  lists.drop(body, [&](std::int32_t index, std::int32_t partner) {
    const auto [i, j] = model.at(index);
    EXPECT_EQ(partner, i == body ? j : i);
    EXPECT_EQ(lists.pair(index).partner(body), partner) << "the pair is removed afterwards";
    removed.push_back(index);
    model.erase(index);
  });
  EXPECT_EQ(removed, list) << "in the order of the list";
}

TEST(NeighbourLists, AgreesWithASetOfPairsThroughRandomChanges) {
  constexpr int kNumber = 12;
  ed::Random random(21);
  NeighbourLists lists(kNumber);
  std::map<std::int32_t, std::pair<int, int>> model;
  std::set<std::pair<int, int>> present;
  for (int change = 0; change < 3000; ++change) {
    // Between nearly empty and nearly full.
    const bool adding = random.uniform() < (change / 500 % 2 == 0 ? 0.95 : 0.7);
    if (adding) {
      const int i = static_cast<int>(random.uniform() * kNumber);
      const int j = static_cast<int>(random.uniform() * kNumber);
      if (i == j || present.count(std::minmax(i, j)) != 0) continue;
      const Vector3d normal = random.direction();
      const std::int32_t index = lists.add(i, j, normal);
      ASSERT_EQ(model.count(index), 0u) << "an index in use was handed out again";
      EXPECT_EQ(lists.pair(index).normal, normal);
      model[index] = {i, j};
      present.insert(std::minmax(i, j));
    } else {
      const int body = static_cast<int>(random.uniform() * kNumber);
      drop(lists, body, model);
      std::erase_if(present, [body](const auto& pair) { return pair.first == body || pair.second == body; });
    }
    ASSERT_NO_FATAL_FAILURE(expect_consistent(lists, model));
  }
}

TEST(NeighbourLists, ANewPairKnowsNothingEvenWhereAnOldOneStood) {
  NeighbourLists lists(3);
  const std::int32_t first = lists.add(0, 1, Vector3d::UnitX());
  lists.pair(first).time = 3;
  lists.pair(first).event = PairEvent::contact;
  lists.pair(first).owner = 1;
  lists.drop(0, [](std::int32_t, std::int32_t) {});
  const std::int32_t second = lists.add(2, 1, Vector3d::UnitY());
  EXPECT_EQ(second, first) << "the place of a removed pair is used again: the pool does not grow for ever";
  EXPECT_EQ(lists.pair(second).time, kNever);
  EXPECT_EQ(lists.pair(second).event, PairEvent::clear);
  EXPECT_EQ(lists.pair(second).owner, 2);
}

/// A large body among small ones: hundreds of pairs, the others a few.
TEST(NeighbourLists, HoldOneThatIsMuchLongerThanTheOthers) {
  constexpr int kNumber = 400;
  ed::Random random(22);
  NeighbourLists lists(kNumber);
  std::map<std::int32_t, std::pair<int, int>> model;
  const auto add = [&](int i, int j) { model[lists.add(i, j, Vector3d::UnitX())] = {i, j}; };
  for (int j = 2; j < kNumber; ++j) add(j - 1, j);
  for (int j = 1; j < kNumber; ++j) add(0, j);
  ASSERT_NO_FATAL_FAILURE(expect_consistent(lists, model));
  EXPECT_EQ(lists.reserve(), 2U * (kNumber - 1));
  ASSERT_NO_FATAL_FAILURE(expect_consistent(lists, model));
  const std::string bytes = ed::archive::bytes_of(lists);
  ed::archive::Reader reader(bytes);
  NeighbourLists read(kNumber);
  reader(read);
  ASSERT_NO_FATAL_FAILURE(expect_consistent(read, model));
  // Down to few, and up again.
  for (const int few : {300, 70, 20, 350}) {
    while (static_cast<int>(read.of(0).size()) > few) {
      const auto list = read.of(0);
      const std::int32_t index = list[random.bits() % list.size()];
      drop(read, read.pair(index).partner(0), model);
      if (read.of(0).size() % 16 == 0) {
        ASSERT_NO_FATAL_FAILURE(expect_consistent(read, model));
      }
    }
    for (int j = 1; static_cast<int>(read.of(0).size()) < few; ++j) {
      const auto list = read.of(0);
      const bool is_there = std::any_of(list.begin(), list.end(), [&](auto k) { return read.pair(k).partner(0) == j; });
      if (!is_there) model[read.add(0, j, Vector3d::UnitX())] = {0, j};
    }
    ASSERT_NO_FATAL_FAILURE(expect_consistent(read, model));
  }
  drop(read, 0, model);
  ASSERT_NO_FATAL_FAILURE(expect_consistent(read, model));
  for (int j = 1; j < kNumber; ++j) model[read.add(0, j, Vector3d::UnitX())] = {0, j};
  ASSERT_NO_FATAL_FAILURE(expect_consistent(read, model));
}

/// A list that claims more than there are pairs costs no memory before it is refused.
TEST(NeighbourLists, RefuseListsThatDoNotFitThePairs) {
  ed::archive::Writer writer;
  constexpr int kNumber = 20000;
  std::vector<std::vector<std::int32_t>> lists(kNumber);
  lists[3].assign(kNumber - 1, 0);
  writer(std::vector<Pair>(), std::vector<std::int32_t>{0, 1, 2}, lists);
  const std::string bytes = writer.take();
  ed::archive::Reader reader(bytes);
  NeighbourLists read(kNumber);
  EXPECT_THROW(reader(read), std::invalid_argument);
}

}  // namespace
