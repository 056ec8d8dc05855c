#include "base/version.h"

#include <ed/arithmetic.h>

#include <fmt/format.h>
#include <Eigen/Core>
#include <nlohmann/json.hpp>

#include <string_view>

namespace hardbody {
namespace {

// Arrays, because either may be empty.
constexpr char kArch[] = HARDBODY_ARCH_NAME;
constexpr char kBuildType[] = HARDBODY_BUILD_TYPE;

std::string compiler() {
#if defined(__clang__)
  return fmt::format("clang {}.{}.{}", __clang_major__, __clang_minor__, __clang_patchlevel__);
#elif defined(__GNUC__)
  return fmt::format("g++ {}.{}.{}", __GNUC__, __GNUC_MINOR__, __GNUC_PATCHLEVEL__);
#else
  return "an unknown compiler";
#endif
}

/// Returns the licence of this binary: that of its sources, unless a part of it requires another.
const char* licence() {
#if HARDBODY_WITH_CGAL
  return "GPL-3.0-or-later for this binary, because it contains CGAL's Polytope_distance_d; BSD-3-Clause for its "
         "sources";
#else
  return "BSD-3-Clause";
#endif
}

std::string libraries() {
  std::string list = fmt::format("Eigen {}.{}.{} (MPL-2.0), fmt {}.{}.{} (MIT), nlohmann json {}.{}.{} (MIT)",
                                 EIGEN_WORLD_VERSION, EIGEN_MAJOR_VERSION, EIGEN_MINOR_VERSION, FMT_VERSION / 10000,
                                 FMT_VERSION / 100 % 100, FMT_VERSION % 100, NLOHMANN_JSON_VERSION_MAJOR,
                                 NLOHMANN_JSON_VERSION_MINOR, NLOHMANN_JSON_VERSION_PATCH);
  list += ", toml++ (MIT), CLI11 (BSD-3-Clause), xxHash (BSD-2-Clause)";
#if HARDBODY_WITH_SEEDS
  list += ", FCL (BSD-3-Clause), libccd (BSD-3-Clause)";
#else
  list += "; FCL and libccd are not built in";
#endif
#if HARDBODY_WITH_CGAL
  list += ", CGAL Polytope_distance_d (GPL-3.0-or-later), GMP (LGPL-3.0-or-later)";
#else
  list += "; CGAL is not built in";
#endif
  return list;
}

}  // namespace

const char* version() {
  return HARDBODY_VERSION;
}

std::string version_text() {
  const std::string_view type(kBuildType);
  return fmt::format("hardbody {}\nlicence: {}\nbuilt with {}, build type {}, {}\nlibraries: {}\n", version(),
                     licence(), compiler(), type.empty() ? "none" : type, build_arch(), libraries());
}

std::string build_arch() {
  const std::string_view arch(kArch);
  return arch.empty() ? "no -march (the compiler's baseline)" : fmt::format("-march={}", arch);
}

std::string arithmetic() {
#if defined(__FMA__)
  constexpr bool fused = true;
#else
  constexpr bool fused = false;
#endif
  return fmt::format("{}{}, arithmetic {}", build_arch(), fused ? ", FMA" : "", ed::kArithmetic);
}

std::vector<std::string> cpu_features() {
  std::vector<std::string> features;
#if defined(__x86_64__) && defined(__GNUC__)
  __builtin_cpu_init();
  if (__builtin_cpu_supports("fma")) features.emplace_back("fma");
  if (__builtin_cpu_supports("avx2")) features.emplace_back("avx2");
  if (__builtin_cpu_supports("avx512f")) features.emplace_back("avx512f");
#endif
  return features;
}

std::string cpu_feature_text() {
  return fmt::format("{}", fmt::join(cpu_features(), " "));
}

}  // namespace hardbody
