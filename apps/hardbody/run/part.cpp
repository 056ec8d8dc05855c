#include "run/part.h"

namespace hardbody {

Part part_of_all(const RunRecord& record) {
  const Config& config = record.config;
  const Production& production = record.production;
  double rotation_axes = 0;
  for (const SpeciesConfig& s : config.species) rotation_axes += s.rotation_axes() * s.number;
  const bool body_axes = !config.mixture && !config.all_of_revolution();
  return {production.results, &production.results,    config.number, rotation_axes / config.number,
          body_axes,          production.wave_numbers};
}

Part part_of_species(const RunRecord& record, std::size_t species, const ed::GroupResults& results) {
  const SpeciesConfig& own = record.config.species[species];
  const int axes = own.rotation_axes();
  return {results, nullptr, own.number, static_cast<double>(axes), axes == 3, record.production.wave_numbers};
}

}  // namespace hardbody
