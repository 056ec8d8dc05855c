#include <geom/kernel/refuse.h>

#ifdef __cpp_exceptions
#include <stdexcept>
#else
#include <cstdio>
#include <cstdlib>
#endif

namespace geom::kernel {

void refuse(const std::string& message) {
#ifdef __cpp_exceptions
  throw std::invalid_argument(message);
#else
  std::fprintf(stderr, "hardbody: %s\n", message.c_str());
  std::abort();
#endif
}

}  // namespace geom::kernel
