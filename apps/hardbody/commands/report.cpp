#include "base/console.h"
#include "base/errors.h"
#include "commands/commands.h"
#include "io/run_directory.h"
#include "io/text_file.h"
#include "report/assets.h"
#include "report/page.h"
#include "sweep/directory.h"
#include "sweep/file.h"
#include "sweep/plan.h"
#include "sweep/state.h"
#include "sweep/tasks/plan_file.h"

#include <fmt/format.h>

#include <filesystem>
#include <map>
#include <string>
#include <vector>

namespace hardbody {
namespace {

namespace fs = std::filesystem;

fs::path output_path(const ReportArguments& arguments) {
  if (arguments.directories.empty()) {
    throw InputError("hardbody report: no directory; accepted: run directories, or that of a sweep");
  }
  if (arguments.out) return *arguments.out;
  if (arguments.directories.size() == 1) return fs::path(arguments.directories[0]) / kReportFile;
  throw InputError("hardbody report: several directories, but no output file; accepted: -o FILE.html");
}

void check_output(const fs::path& path) {
  const fs::path directory = path.has_parent_path() ? path.parent_path() : fs::path(".");
  if (!fs::is_directory(directory)) {
    throw InputError(
        fmt::format("{}: cannot be written: {} is not a directory; accepted: a file in an "
                    "existing directory",
                    path.string(), directory.string()));
  }
  check_replaceable(path, kReportBeginning);
}

std::string size_text(std::size_t bytes) {
  const auto size = static_cast<double>(bytes);
  return size < 1e6 ? fmt::format("{:.0f} kB", size / 1e3) : fmt::format("{:.1f} MB", size / 1e6);
}

/// Returns the last `parts` parts of a directory's path.
std::string last_parts(const fs::path& directory, int parts) {
  const fs::path whole = fs::weakly_canonical(directory);
  fs::path name = whole.filename();
  for (fs::path rest = whole.parent_path(); --parts > 0 && rest.has_filename(); rest = rest.parent_path()) {
    name = rest.filename() / name;
  }
  return name.string();
}

/// Renames runs of the same name by as many parts of their paths as distinguish them.
void name_apart(std::vector<RunReport>& runs) {
  constexpr int kMostParts = 64;
  for (int parts = 2; parts <= kMostParts; ++parts) {
    std::map<std::string, int> counts;
    for (const RunReport& run : runs) ++counts[run.name];
    for (RunReport& run : runs) {
      if (counts[run.name] > 1) run.name = last_parts(run.path, parts);
    }
  }
}

std::string several_title(const std::vector<RunReport>& runs) {
  std::string title;
  for (const RunReport& run : runs) title += (title.empty() ? "" : ", ") + run.name;
  return fmt::format("{} runs: {}", runs.size(), title);
}

/// Brings the tables of a sweep up to date whose runs are tasks. Nobody else does while they run; a table that
/// cannot be written is shown as it is.
void collect_tasks(const fs::path& directory) {
  if (!fs::exists(directory / kPlanFile) || !fs::exists(directory / kSweepFile)) return;
  const SweepFile sweep = read_sweep(directory / kSweepFile);
  try {
    const DirectoryLock lock = share_directory(directory, sweep);
    SweepState(directory, taken_up(directory, planned(sweep)), sweep.replicas).write_tables();
  } catch (const InputError&) {
    return;  // hardbody sweep is at work here, which writes them itself
  } catch (const WriteError& error) {
    console().say(error.what());
  }
}

Report read_report(const std::vector<std::string>& directories) {
  Report report;
  if (directories.size() == 1) collect_tasks(directories[0]);
  if (directories.size() == 1 && is_sweep(directories[0])) {
    report.sweep = read_sweep_report(directories[0]);
    report.title = report.sweep->title;
    return report;
  }
  for (const std::string& directory : directories) {
    if (is_sweep(directory)) {
      throw InputError(fmt::format("{}: holds a sweep; accepted: a single sweep, or several runs", directory));
    }
    report.runs.push_back(read_run_report(directory, WithView::yes));
  }
  name_apart(report.runs);
  report.title = report.runs.size() == 1 ? report.runs[0].title : several_title(report.runs);
  return report;
}

}  // namespace

int report(const ReportArguments& arguments) {
  const fs::path path = output_path(arguments);
  const Report report = read_report(arguments.directories);
  check_output(path);
  const std::string page = report_page(report);
  write_file(path, page);
  console().print(
      fmt::format("{}: {}{}\n", path.string(), size_text(page.size()),
                  report_script().empty() ? ", static: this program was built without the interactive front end" : ""));
  return 0;
}

}  // namespace hardbody
