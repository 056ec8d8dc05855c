/// A fuzz target without libFuzzer: runs the files of a directory, and bytes of them changed at random. For any
/// compiler; finds what is near the surface and repeats what libFuzzer found.
///
///     geom_fuzz_replay DIR|FILE [CHANGED COPIES OF EACH, default 0]

#include <algorithm>
#include <cstddef>
#include <cstdint>
#include <cstdio>
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <iterator>
#include <random>
#include <vector>

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

using Bytes = std::vector<std::uint8_t>;

Bytes read(const std::filesystem::path& path) {
  std::ifstream file(path, std::ios::binary);
  return {std::istreambuf_iterator<char>(file), {}};
}

Bytes changed(Bytes bytes, std::mt19937_64& random) {
  for (std::uint64_t k = 1 + random() % 8; k > 0 && !bytes.empty(); --k) {
    bytes[random() % bytes.size()] = static_cast<std::uint8_t>(random());
  }
  return bytes;
}

}  // namespace

int main(int argc, char** argv) {
  if (argc < 2) return 2;
  const int copies = argc > 2 ? std::atoi(argv[2]) : 0;
  std::vector<std::filesystem::path> files;
  if (std::filesystem::is_directory(argv[1])) {
    for (const auto& entry : std::filesystem::directory_iterator(argv[1])) files.push_back(entry.path());
  } else {
    files.emplace_back(argv[1]);
  }
  std::sort(files.begin(), files.end());
  std::mt19937_64 random(1);
  for (const std::filesystem::path& file : files) {
    const Bytes bytes = read(file);
    LLVMFuzzerTestOneInput(bytes.data(), bytes.size());
    for (int k = 0; k < copies; ++k) {
      const Bytes other = changed(bytes, random);
      LLVMFuzzerTestOneInput(other.data(), other.size());
    }
  }
  std::printf("%zu inputs, %d changed copies of each\n", files.size(), copies);
  return files.empty() ? 1 : 0;
}
