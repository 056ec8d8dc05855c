/// libFuzzer: texts that claim to be LAMMPS dumps (frames.h).

#include "frames.h"
#include "lammps_dump.h"

#include <cstddef>
#include <cstdint>
#include <string>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
  fuzz::read_all([&] {
    return hardbody::LammpsReader(hardbody::stored_bytes_in_memory({reinterpret_cast<const char*>(data), size}),
                                  "fuzz");
  });
  return 0;
}
