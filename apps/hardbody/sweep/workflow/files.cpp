#include "sweep/workflow/files.h"

#include "base/errors.h"
#include "io/text_file.h"
#include "sweep/directory.h"
#include "sweep/workflow/assets.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <system_error>
#include <utility>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr const char* kMarkers = "tasks";
constexpr const char* kBegun = ".begun";
constexpr const char* kSettled = ".done";
constexpr const char* kProfileFiles[] = {"config.yaml", "config.v8+.yaml"};

Json listed_task(const Bundle& task) {
  return {{"id", task.id},
          {"after", task.after ? Json::array({*task.after}) : Json::array()},
          {"expected_seconds", task.seconds ? Json(*task.seconds) : Json(nullptr)},
          {"memory_bytes", task.memory ? Json(*task.memory) : Json(nullptr)}};
}

bool is_shipped(const std::string& name) {
  return name == "local" || name == "slurm";
}

}  // namespace

void write_workflow(const fs::path& sweep_directory, const std::vector<Bundle>& tasks,
                    const std::vector<std::string>& program) {
  const fs::path directory = sweep_directory / kWorkflowDirectory;
  fs::remove_all(directory / kMarkers);
  fs::remove_all(directory / ".snakemake");  // records of tasks of an earlier plan
  fs::create_directories(directory / kMarkers);
  write_file(directory / "Snakefile", workflow_snakefile());
  for (const auto& [name, text] :
       {std::pair{"local", workflow_local_profile()}, std::pair{"slurm", workflow_slurm_profile()}}) {
    fs::create_directories(directory / "profiles" / name);
    write_file(directory / "profiles" / name / kProfileFiles[0], text);
  }
  Json list = Json::array();
  for (const Bundle& task : tasks) list.push_back(listed_task(task));
  write_file(directory / "tasks.json", list.dump() + "\n");
  const fs::path absolute = absolute_path(sweep_directory);
  const Json config = {{"program", program},
                       {"sweep", (absolute / kSweepFile).string()},
                       {"directory", absolute.string()},
                       {"tasks", (absolute / kWorkflowDirectory / "tasks.json").string()}};
  write_file(directory / "config.json", config.dump(2) + "\n");
}

void check_profile(const std::string& name) {
  if (is_shipped(name)) return;
  for (const char* file : kProfileFiles) {
    if (!name.empty() && fs::exists(fs::path(name) / file)) return;
  }
  throw InputError(fmt::format(
      "command line: --on {}; accepted: slurm, local, or the directory of a Snakemake profile, with its config.yaml",
      one_line(name, 200)));
}

fs::path workflow_profile(const fs::path& sweep_directory, const std::string& name) {
  check_profile(name);
  if (is_shipped(name)) return absolute_path(sweep_directory / kWorkflowDirectory / "profiles" / name);
  return absolute_path(name);
}

TasksAtWork tasks_at_work(const fs::path& sweep_directory) {
  TasksAtWork tasks;
  std::error_code error;
  for (fs::directory_iterator at(sweep_directory / kWorkflowDirectory / kMarkers, error), end; !error && at != end;
       at.increment(error)) {
    const std::string name = at->path().stem().string();
    int id = 0;
    const auto [rest, wrong] = std::from_chars(name.data(), name.data() + name.size(), id);
    if (wrong != std::errc() || rest != name.data() + name.size()) continue;
    if (at->path().extension() == kBegun) tasks.begun.push_back(id);
    if (at->path().extension() == kSettled) tasks.settled.push_back(id);
  }
  return tasks;
}

}  // namespace hardbody
