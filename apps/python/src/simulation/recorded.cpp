#include "simulation/recorded.h"

#include "base/arrays.h"

#include <ed/simulation.h>

#include <nanobind/nanobind.h>

#include <cstdint>
#include <cstring>
#include <vector>

namespace hardbody::python {

nb::object recorded(const PythonSimulation& simulation) {
  const std::vector<ed::Collision>& list = simulation.whole().collisions();
  static_assert(sizeof(ed::Collision) == 16);
  const NewArray<std::uint8_t> bytes = new_array<std::uint8_t>({sizeof(ed::Collision) * list.size()});
  if (!list.empty()) std::memcpy(bytes.data, list.data(), sizeof(ed::Collision) * list.size());
  nb::list fields;
  fields.append(nb::make_tuple("time", "f8"));
  fields.append(nb::make_tuple("i", "i4"));
  fields.append(nb::make_tuple("j", "i4"));
  return bytes.array.attr("view")(nb::module_::import_("numpy").attr("dtype")(fields));
}

}  // namespace hardbody::python
