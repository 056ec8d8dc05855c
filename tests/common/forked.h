#pragma once

/// Runs code that may end the process in a child of its own.

#include <sys/mman.h>
#include <sys/wait.h>
#include <unistd.h>

#include <cstdio>
#include <new>
#include <stdexcept>
#include <type_traits>

namespace geom_test {

/// Calls work(i, record) for each i in [0, count) in forked children, and returns how many of them a signal ended (an
/// assertion, mostly). The item that did it is lost; the next child goes on behind it.
///
/// `record` lies in memory that the children share with this process: all they can report.
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
    std::fflush(nullptr);  // or the child prints what waits in the buffers once more
    const pid_t child = fork();
    if (child < 0) throw std::runtime_error("run_forked: fork failed");
    if (child == 0) {
      std::fclose(stderr);  // the text of the assertions
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
