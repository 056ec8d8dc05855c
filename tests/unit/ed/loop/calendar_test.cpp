#include <loop/parts/calendar.h>

#include <ed/archive.h>
#include <ed/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
#include <stdexcept>
#include <string>
#include <vector>

namespace {

using ed::internal::Calendar;

constexpr double kNever = std::numeric_limits<double>::infinity();

class CalendarOfSize : public testing::TestWithParam<int> {};

TEST_P(CalendarOfSize, AgreesWithTheSmallestOfAList) {
  const int number = GetParam();
  Calendar calendar(number);
  std::vector<double> times(static_cast<std::size_t>(number), kNever);
  ed::Random random(7);
  for (int update = 0; update < 20'000; ++update) {
    const auto i = static_cast<std::size_t>(random.uniform() * number);
    // Few different times, so that ties are common; now and then never.
    const double t = random.uniform() < 0.1 ? kNever : std::floor(50 * random.uniform()) - 10;
    times[i] = t;
    calendar.set(static_cast<int>(i), t);
    // std::min_element takes the first of equals: ties go to the lower number.
    const auto first = std::min_element(times.begin(), times.end());
    ASSERT_EQ(calendar.earliest_time(), *first);
    ASSERT_EQ(calendar.earliest(), first - times.begin());
    ASSERT_EQ(calendar.time(static_cast<int>(i)), t);
  }
  for (int i = 0; i < number; ++i) EXPECT_EQ(calendar.time(i), times[static_cast<std::size_t>(i)]);
}

TEST_P(CalendarOfSize, IsTheSameAfterItWasReadBack) {
  const int number = GetParam();
  Calendar calendar(number);
  ed::Random random(9);
  for (int i = 0; i < number; ++i) calendar.set(i, random.uniform() < 0.2 ? kNever : random.uniform());
  const std::string bytes = ed::archive::bytes_of(calendar);
  ed::archive::Reader reader(bytes);
  Calendar read(number);
  reader(read);
  for (int event = 0; event < 2 * number; ++event) {
    ASSERT_EQ(read.earliest(), calendar.earliest());
    const double next = read.earliest_time() + random.uniform();
    for (Calendar* c : {&calendar, &read}) c->set(c->earliest(), next);
  }
  ed::archive::Reader again(bytes);
  Calendar other(number + 1);
  EXPECT_THROW(again(other), std::invalid_argument);
}

TEST_P(CalendarOfSize, LeadsFromItsPartsToTheirEarliestBodies) {
  const int number = GetParam();
  Calendar calendar(number);
  ed::Random random(11);
  for (int i = 0; i < number; ++i) calendar.set(i, random.uniform() < 0.2 ? kNever : random.uniform());
  ASSERT_LT(calendar.parts(), 64U);
  ASSERT_GE(calendar.parts(), std::min<std::size_t>(8, static_cast<std::size_t>(number)));
  double earliest = kNever;
  int end_of_last = 0;  // of the part before
  for (std::size_t k = 0; k < calendar.parts(); ++k) {
    Calendar::Entry entry = calendar.part(k);
    const double time = calendar.time(entry);
    int size = 1;
    for (; entry.level > 0; size *= 8) entry = calendar.earliest_below(entry);
    const int end = std::min(number, end_of_last + size);
    double least = kNever;
    for (int i = end_of_last; i < end; ++i) least = std::min(least, calendar.time(i));
    EXPECT_EQ(time, least);
    EXPECT_EQ(calendar.time(entry), least);
    if (least < kNever) {
      EXPECT_GE(static_cast<int>(entry.index), end_of_last);
      EXPECT_LT(static_cast<int>(entry.index), end);
    }
    earliest = std::min(earliest, time);
    end_of_last = end;
  }
  EXPECT_EQ(end_of_last, number);
  EXPECT_EQ(earliest, calendar.earliest_time());
}

INSTANTIATE_TEST_SUITE_P(Sizes, CalendarOfSize, testing::Values(1, 2, 7, 8, 9, 63, 64, 65, 512, 513, 4097));

TEST(Calendar, NothingIsDueInANewOne) {
  const Calendar calendar(5);
  EXPECT_EQ(calendar.earliest_time(), kNever);
  EXPECT_EQ(calendar.time(4), kNever);
}

TEST(Calendar, HandsOutEventsInTheOrderOfTime) {
  constexpr int kNumber = 37;
  Calendar calendar(kNumber);
  ed::Random random(8);
  for (int i = 0; i < kNumber; ++i) calendar.set(i, random.uniform());
  double last = 0;
  for (int event = 0; event < 5000; ++event) {
    const double now = calendar.earliest_time();
    EXPECT_GE(now, last);
    last = now;
    calendar.set(calendar.earliest(), now + random.uniform());
  }
}

}  // namespace
