#include "base/memory.h"

#include <sys/mman.h>

#include <cstdlib>
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
    for (const Block& block : blocks_) std::free(block.data);
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

KeptMemory::KeptMemory(std::size_t bytes) : size_((bytes + kPage - 1) / kPage * kPage) {
  if (const std::optional<Block> block = free_blocks().take(size_)) {
    data_ = block->data;
    size_ = block->size;
    return;
  }
  data_ = std::aligned_alloc(kPage, size_);
  if (data_ == nullptr) throw std::bad_alloc();
  madvise(data_, size_, MADV_HUGEPAGE);  // fewer page faults, where the system has such pages
}

KeptMemory::~KeptMemory() {
  if (!free_blocks().keep({data_, size_})) std::free(data_);
}

void release_kept_memory() {
  free_blocks().clear();
}

}  // namespace hardbody::python
