#include "base/memory.h"

#include <sys/mman.h>

#include <cstdint>
#include <mutex>
#include <new>
#include <optional>
#include <vector>

namespace hardbody::python {
namespace {

/// Size of a huge page, to which blocks are rounded.
constexpr std::size_t kPage = std::size_t{1} << 21;

struct Block {
  void* data;
  std::size_t size;
};

/// Returns pages of the system's, aligned to huge ones. The heap may keep what it is given back. Throws std::bad_alloc.
Block map_block(std::size_t size) {
  void* const mapped = mmap(nullptr, size + kPage, PROT_READ | PROT_WRITE, MAP_PRIVATE | MAP_ANONYMOUS, -1, 0);
  if (mapped == MAP_FAILED) throw std::bad_alloc();
  char* const begin = static_cast<char*>(mapped);
  const std::size_t before = (kPage - reinterpret_cast<std::uintptr_t>(mapped) % kPage) % kPage;
  if (before > 0) munmap(begin, before);
  munmap(begin + before + size, kPage - before);
  madvise(begin + before, size, MADV_HUGEPAGE);  // fewer page faults, where the system has such pages
  return {begin + before, size};
}

void unmap(const Block& block) {
  munmap(block.data, block.size);
}

/// Blocks that no array has.
class FreeBlocks {
 public:
  /// Returns a block of at least `size` bytes, and at most a quarter more.
  std::optional<Block> take(std::size_t size) {
    const std::scoped_lock lock(mutex_);
    for (std::size_t k = 0; k < blocks_.size(); ++k) {
      if (blocks_[k].size < size || blocks_[k].size > size + size / 4) continue;
      const Block found = blocks_[k];
      blocks_[k] = blocks_.back();
      blocks_.pop_back();
      total_ -= found.size;
      return found;
    }
    return std::nullopt;
  }

  /// Keeps a block; false if there are enough.
  bool keep(const Block& block) {
    const std::scoped_lock lock(mutex_);
    if (total_ + block.size > kMostKept || blocks_.size() == blocks_.capacity()) return false;
    blocks_.push_back(block);
    total_ += block.size;
    return true;
  }

  /// Frees all blocks.
  void clear() {
    const std::scoped_lock lock(mutex_);
    for (const Block& block : blocks_) unmap(block);
    blocks_.clear();
    total_ = 0;
  }

  FreeBlocks() { blocks_.reserve(kMostKept / kPage); }

 private:
  std::mutex mutex_;
  std::vector<Block> blocks_;
  std::size_t total_ = 0;
};

/// Returns the blocks of this process, which are never destroyed: arrays may be dropped until its very end.
FreeBlocks& free_blocks() {
  static auto* const blocks = new FreeBlocks;
  return *blocks;
}

}  // namespace

KeptMemory::KeptMemory(std::size_t bytes) {
  const std::size_t size = (bytes + kPage - 1) / kPage * kPage;
  const std::optional<Block> kept = free_blocks().take(size);
  const Block block = kept ? *kept : map_block(size);
  data_ = block.data;
  size_ = block.size;
}

KeptMemory::~KeptMemory() {
  if (!free_blocks().keep({data_, size_})) unmap({data_, size_});
}

void release_kept_memory() {
  free_blocks().clear();
}

}  // namespace hardbody::python
