#pragma once

/// Isolation of code that may abort the process, in forked children.

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <new>
#include <stdexcept>
#include <type_traits>

namespace geom_test {

/// Calls work(i, record) for each i in [0, count) in forked children, and returns how many of them a signal ended (an
/// assertion, mostly). The item that caused it is lost; the next child continues after it.
///
/// `record` must be in memory that the children share with this process: they can report nothing else.
template <class Record, class Work>
int run_forked(int count, Record& record, const Work& work) {
  static_assert(std::is_trivially_copyable_v<Record>);
  struct Shared {
    int next = 0;
    Record record{};
  };
  void* memory = mmap(nullptr, sizeof(Shared), PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
  if (memory == MAP_FAILED) throw std::runtime_error("run_forked: mmap failed");
  auto* shared = new (memory) Shared;
  shared->record = record;
  int aborts = 0;
  while (shared->next < count) {
    std::fflush(nullptr);  // or the child would print buffered output again
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("run_forked: fork failed");
    if (child == 0) {
      std::fclose(stderr);  // suppresses the text of assertions
      while (shared->next < count) {
        const int i = shared->next++;
        work(i, shared->record);
      }
      _exit(0);
    }
    int status = 0;
    waitpid(child, &status, 0);
    if (WIFSIGNALED(status)) {
      ++aborts;
    } else if (!WIFEXITED(status) || WEXITSTATUS(status) != 0) {
      throw std::runtime_error("run_forked: the child failed");
    }
  }
  record = shared->record;
  munmap(memory, sizeof(Shared));
  return aborts;
}

}  // namespace geom_test
