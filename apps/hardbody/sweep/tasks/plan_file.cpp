#include "sweep/tasks/plan_file.h"

#include "base/errors.h"
#include "base/find.h"
#include "base/version.h"
#include "io/json_values.h"
#include "io/text_file.h"
#include "sweep/plan.h"
#include "sweep/tasks/cost.h"
#include "sweep/tasks/task_lock.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <charconv>
#include <optional>
#include <system_error>
#include <utility>

namespace hardbody {
namespace {

namespace fs = std::filesystem;
using Json = nlohmann::ordered_json;

constexpr std::size_t kLongestPlan = std::size_t{1} << 28;

Json run_json(const PointRecord& record, const std::vector<PointRecord>& records, const std::optional<Cost>& cost) {
  return {{"id", record.directory},
          {"point", record.point.name},
          {"replica", record.replica},
          {"seed", record.seed},
          {"status", to_string(record.status)},
          {"starts_from", record.starts_from ? Json(records[*record.starts_from].directory) : Json(nullptr)},
          {"expected_seconds", cost && !is_over(record) ? number_json(cost->seconds) : Json(nullptr)},
          {"memory_bytes", cost ? number_json(cost->memory) : Json(nullptr)}};
}

Json task_json(const Bundle& bundle, const std::vector<PointRecord>& records) {
  Json ids = Json::array();
  for (const std::size_t k : bundle.runs) ids.push_back(records[k].directory);
  return {{"id", bundle.id},
          {"runs", std::move(ids)},
          {"after", bundle.after ? Json::array({*bundle.after}) : Json::array()},
          {"expected_seconds", bundle.seconds ? number_json(*bundle.seconds) : Json(nullptr)},
          {"memory_bytes", bundle.memory ? number_json(*bundle.memory) : Json(nullptr)}};
}

/// Finds one task in the text of a plan, and reads no further: plans of 10^5 runs have tens of megabytes.
class TaskFinder : public nlohmann::json_sax<Json> {
 public:
  explicit TaskFinder(int number) : number_(number) {}

  const std::optional<std::vector<std::string>>& found() const { return found_; }

  bool null() override { return true; }
  bool boolean(bool) override { return true; }
  bool number_integer(number_integer_t value) override { return id(static_cast<int>(value)); }
  bool number_unsigned(number_unsigned_t value) override { return id(static_cast<int>(value)); }
  bool number_float(number_float_t, const string_t&) override { return true; }
  bool binary(binary_t&) override { return true; }
  bool string(string_t& value) override {
    if (in_runs_) runs_.push_back(value);
    return true;
  }
  bool key(string_t& name) override {
    if (depth_ == 1) in_tasks_ = name == "tasks";
    key_ = name;
    return true;
  }
  bool start_object(std::size_t) override {
    if (++depth_ == 2) runs_.clear();
    return true;
  }
  bool end_object() override {
    if (depth_-- != 2 || !matches_) return true;
    found_ = runs_;
    return false;
  }
  bool start_array(std::size_t) override {
    in_runs_ = in_tasks_ && depth_ == 2 && key_ == "runs";
    return true;
  }
  bool end_array() override {
    in_runs_ = false;
    return true;
  }
  bool parse_error(std::size_t, const std::string&, const nlohmann::detail::exception&) override { return false; }

 private:
  bool id(int value) {
    if (in_tasks_ && depth_ == 2 && key_ == "id") matches_ = value == number_;
    return true;
  }

  int number_;
  int depth_ = 0;  ///< number of open objects
  std::string key_;
  bool in_tasks_ = false;
  bool in_runs_ = false;
  bool matches_ = false;
  std::vector<std::string> runs_;
  std::optional<std::vector<std::string>> found_;
};

/// Returns the runs of a task of a plan; nullopt if the text has no such task.
std::optional<std::vector<std::string>> task_runs(const std::string& plan, int number) {
  TaskFinder finder(number);
  (void)Json::sax_parse(plan, &finder);
  return finder.found();
}

}  // namespace

std::vector<PointRecord> taken_up(const fs::path& directory, std::vector<PointRecord> records) {
  for (PointRecord& record : records) {
    take_up(record, directory);
    if (record.status == PointStatus::pending) take_up_state(record, directory);
    const bool cut = record.status == PointStatus::running && !has_task(directory / record.directory);
    if (cut) record.status = PointStatus::stopped;
  }
  return records;
}

Plan plan_of(const std::vector<PointRecord>& records, const fs::path& directory, const std::string& sweep,
             double task_seconds, const std::optional<int>& jobs) {
  const Costs costs(records);
  std::vector<std::optional<Cost>> expected;
  for (std::size_t k = 0; k < records.size(); ++k) expected.push_back(costs.of(k));
  Plan plan{bundles_of(records, expected, task_seconds, jobs), ""};
  Json tasks = Json::array();
  for (const Bundle& bundle : plan.tasks) tasks.push_back(task_json(bundle, records));
  Json runs = Json::array();
  for (std::size_t k = 0; k < records.size(); ++k) runs.push_back(run_json(records[k], records, expected[k]));
  const Json json = {{"version", version()},
                     {"sweep", absolute_path(sweep).string()},
                     {"directory", absolute_path(directory).string()},
                     {"task_seconds", task_seconds},
                     {"jobs", jobs ? Json(*jobs) : Json(nullptr)},
                     {"expected_within_factor", number_json(costs.error())},
                     {"tasks", std::move(tasks)},
                     {"runs", std::move(runs)}};
  plan.json = json.dump(2) + "\n";
  return plan;
}

std::vector<std::size_t> runs_of(const std::string& id, const std::vector<PointRecord>& records,
                                 const fs::path& directory) {
  const auto index_of = [&](const std::string& name) {
    const PointRecord* record = find_by(records, &PointRecord::directory, name);
    return record == nullptr ? std::nullopt : std::optional(static_cast<std::size_t>(record - records.data()));
  };
  if (const auto k = index_of(id)) return {*k};
  const auto refuse = [&](const std::string& accepted) {
    return InputError(
        fmt::format("{}: no run or task of this sweep has this id; accepted: {}", one_line(id, 120), accepted));
  };
  int number = 0;
  const auto [end, error] = std::from_chars(id.data(), id.data() + id.size(), number);
  const fs::path plan = directory / kPlanFile;
  if (error != std::errc() || end != id.data() + id.size()) throw refuse(fmt::format("an id in {}", plan.string()));
  const std::optional<std::vector<std::string>> names = task_runs(read_file(plan, kLongestPlan), number);
  if (!names) throw refuse(fmt::format("the number of a task in {}", plan.string()));
  std::vector<std::size_t> runs;
  for (const std::string& name : *names) {
    const auto k = index_of(name);
    if (!k) throw refuse("a plan of this sweep: hardbody sweep plan writes it again");
    runs.push_back(*k);
  }
  return runs;
}

}  // namespace hardbody
