#include <calendar.h>

#include <ed/random.h>

#include <gtest/gtest.h>

#include <algorithm>
#include <limits>
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
