#include "sweep/workflow/engine.h"

#include "base/errors.h"
#include "io/text_file.h"
#include "sweep/workflow/files.h"

#include <fmt/format.h>

#include <array>
#include <charconv>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <sstream>
#include <string_view>
#include <vector>

#include <unistd.h>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

constexpr int kOldestSnakemake = 8;
constexpr const char* kInstall =
    "Snakemake 8 or newer: pip install snakemake snakemake-executor-plugin-slurm, in a virtual environment whose bin "
    "is in PATH";

bool is_in_path(const char* program) {
  const char* path = std::getenv("PATH");
  std::istringstream directories(path != nullptr ? path : "");
  for (std::string directory; std::getline(directories, directory, ':');) {
    if (::access((fs::path(directory) / program).c_str(), X_OK) == 0) return true;
  }
  return false;
}

/// Returns what `snakemake --version` prints.
std::string snakemake_version() {
  std::string text;
  std::FILE* output = ::popen("snakemake --version 2>/dev/null", "r");
  if (output == nullptr) return text;
  std::array<char, 256> buffer{};
  while (std::fgets(buffer.data(), buffer.size(), output) != nullptr) text += buffer.data();
  (void)::pclose(output);
  return text;
}

/// Returns whether Slurm keeps accounts. Without them the executor never learns from sacct how jobs have ended.
bool has_accounting() {
  return is_in_path("sacct") && std::system("sacct -n -X -j 1 >/dev/null 2>&1") == 0;
}

constexpr std::string_view kFailedAttempt = "Error in rule task";

/// Returns the words of a shell that runs the command behind it with its output in the log.
std::vector<std::string> logged(const fs::path& log) {
  return {"/bin/sh", "-c", "exec \"$@\" >>\"$0\" 2>&1", log.string(), "snakemake"};
}

}  // namespace

void check_engine(const std::string& profile) {
  if (!is_in_path("snakemake")) {
    throw InputError(fmt::format("command line: --on {}: snakemake is not installed; accepted: {}", profile, kInstall));
  }
  const std::string version = snakemake_version();
  int major = 0;
  const auto [end, error] = std::from_chars(version.data(), version.data() + version.size(), major);
  if (error != std::errc() || major < kOldestSnakemake) {
    throw InputError(fmt::format("command line: --on {}: snakemake --version prints {}; accepted: {}", profile,
                                 version.empty() ? "nothing" : one_line(version, 80), kInstall));
  }
  for (const char* program : {"sbatch", "squeue", "scancel"}) {
    if (profile != "slurm" || is_in_path(program)) continue;
    throw InputError(fmt::format(
        "command line: --on slurm: {} is not installed; accepted: a machine from which jobs are submitted to "
        "Slurm (Debian: slurm-client)",
        program));
  }
}

Engine::Engine(const fs::path& sweep_directory, const std::string& profile, const std::optional<int>& jobs)
    : log_(absolute_path(sweep_directory / kWorkflowDirectory / kWorkflowLogFile)), process_(logged(log_)) {
  const fs::path directory = absolute_path(sweep_directory / kWorkflowDirectory);
  fs::remove(log_);
  // Two of them are kept apart by the lock of the workflow's directory, which ends with the process that holds it.
  std::vector<std::string> arguments = {"--snakefile",  (directory / "Snakefile").string(),
                                        "--configfile", (directory / "config.json").string(),
                                        "--profile",    workflow_profile(sweep_directory, profile).string(),
                                        "--nolock",     "--rerun-incomplete",
                                        "--directory",  directory.string()};
  if (jobs) {
    arguments.emplace_back(profile == "local" ? "--cores" : "--jobs");
    arguments.push_back(fmt::format("{}", *jobs));
  }
  if (profile == "slurm" && !has_accounting()) {
    arguments.insert(arguments.end(), {"--slurm-status-command", "squeue"});
  }
  process_.start(0, directory, arguments);
}

std::optional<int> Engine::ended(int milliseconds) {
  const std::vector<WorkerEnd> ends = process_.ended(milliseconds);
  return ends.empty() ? std::nullopt : std::optional(ends.front().status);
}

void Engine::stop() {
  process_.signal_groups(SIGINT);
}

int Engine::failed_attempts() const {
  std::ifstream log(log_);
  int number = 0;
  for (std::string line; std::getline(log, line);) number += line.starts_with(kFailedAttempt) ? 1 : 0;
  return number;
}

std::string Engine::failure() const {
  constexpr std::string_view kJobLog = "    log: ";
  std::ifstream log(log_);
  std::string last;
  std::string job;
  for (std::string line; std::getline(log, line);) {
    const std::size_t end = line.find(" (check log file");
    if (line.starts_with(kJobLog) && end != std::string::npos) {
      job = "; a job's log is " + line.substr(kJobLog.size(), end - kJobLog.size());
    }
    if (line.find("invalid choice: 'slurm'") != std::string::npos) {
      return "Snakemake has no executor slurm: pip install snakemake-executor-plugin-slurm";
    }
    const bool names_error = line.find("rror") != std::string::npos && !line.starts_with(kFailedAttempt);
    if (!names_error || end != std::string::npos) continue;
    last = line;
    // The text of a WorkflowError is on the next line.
    if (line.ends_with(':') && std::getline(log, line)) last += ' ' + line;
  }
  return one_line(last, 300) + one_line(job, 300);
}

}  // namespace hardbody
