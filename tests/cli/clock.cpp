// Preloaded, it sets the wall clock back by 200 days at each look.

#include <ctime>

extern "C" [[gnu::visibility("default")]] std::time_t time(std::time_t* result) noexcept {
  static std::time_t now = 2000000000;
  now -= 200 * 24 * 3600;
  if (result != nullptr) *result = now;
  return now;
}
