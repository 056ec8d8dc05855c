#include "observables/collective.h"

#include <numbers>

namespace ed::internal {

bool has_wave_vectors(double box, double wave_number) {
  return wave_number * box > std::numbers::pi;
}

void add_collective(const Amplitudes& origin, const Amplitudes& now, double number, double* sums) {
  const std::vector<double> later = structure_factor(origin, now, number, number);
  const std::vector<double> at_once = structure_factor(origin, origin, number, number);
  for (std::size_t k = 0; k < origin.size(); ++k) {
    sums[kCollectiveSums * k] += later[k];
    sums[kCollectiveSums * k + 1] += at_once[k];
  }
}

}  // namespace ed::internal
