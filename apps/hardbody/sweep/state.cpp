#include "sweep/state.h"

#include "io/run_directory.h"
#include "io/text_file.h"
#include "sweep/plan.h"
#include "sweep/table.h"

#include <fmt/format.h>

#include <algorithm>
#include <exception>
#include <span>
#include <utility>

namespace hardbody {

SweepState::SweepState(std::filesystem::path directory, std::vector<PointRecord> records, int replicas)
    : directory_(std::move(directory)),
      records_(std::move(records)),
      replicas_(replicas),
      points_(records_.size() / static_cast<std::size_t>(replicas)),
      changed_(points_.size(), true) {}

void SweepState::take_up(std::size_t k) {
  hardbody::take_up(records_[k], directory_);
  changed_[k / static_cast<std::size_t>(replicas_)] = true;
}

void SweepState::settle(std::size_t k, PointStatus status, const std::string& message) {
  records_[k].status = status;
  records_[k].for_good = false;
  records_[k].message = message;
  changed_[k / static_cast<std::size_t>(replicas_)] = true;
}

void SweepState::fail_for_good(std::size_t k, const std::string& message) {
  settle(k, PointStatus::failed, message);
  records_[k].for_good = true;
}

void SweepState::end(std::size_t k, const WorkerEnd& end) {
  PointRecord& record = records_[k];
  std::string message = end.last_line;
  try {
    record.results = finished_results(directory_ / record.directory);
  } catch (const std::exception& error) {
    message = error.what();
  }
  if (end.status == 0 && record.results && record.results->sound) {
    settle(k, PointStatus::done, "");
    return;
  }
  if (end.status == Workers::kNotStarted) message = "its process could not be started";
  if (message.empty() && end.killed) message = fmt::format("ended by signal {}", end.status - 128);
  if (message.empty()) message = fmt::format("ended with exit status {}", end.status);
  settle(k, PointStatus::failed, message);
}

void SweepState::write_state(std::size_t k) const {
  const std::filesystem::path directory = directory_ / records_[k].directory;
  std::filesystem::create_directories(directory);
  write_file(directory / kPointStateFile, state_json(records_[k], replicas_));
}

void SweepState::write_tables() {
  write_file(directory_ / kSweepTableFile, sweep_csv(points(), replicas_));
  if (replicas_ == 1) return;
  write_file(directory_ / kReplicasTableFile, replicas_csv(records_));
  write_file(directory_ / kAgreementTableFile, agreement_csv(points_));
}

const std::vector<PooledPoint>& SweepState::points() {
  const auto each = static_cast<std::size_t>(replicas_);
  for (std::size_t k = 0; k < points_.size(); ++k) {
    if (changed_[k]) points_[k] = pooled_point(std::span<const PointRecord>(records_).subspan(k * each, each));
    changed_[k] = false;
  }
  return points_;
}

std::size_t SweepState::count(PointStatus status) {
  const std::vector<PooledPoint>& list = points();
  return static_cast<std::size_t>(
      std::count_if(list.begin(), list.end(), [&](const PooledPoint& p) { return p.record.status == status; }));
}

bool SweepState::is_over() const {
  return std::all_of(records_.begin(), records_.end(),
                     [](const PointRecord& record) { return hardbody::is_over(record); });
}

std::string SweepState::account() {
  const std::size_t failed = count(PointStatus::failed);
  const std::size_t done = count(PointStatus::done);
  const std::size_t all = points_.size();
  std::string text = fmt::format("{}: {} points{}: {} done, {} failed{}\n", directory_.string(), all,
                                 replicas_ > 1 ? fmt::format(" of {} replicas", replicas_) : "", done, failed,
                                 done + failed < all ? fmt::format(", {} to do", all - done - failed) : "");
  for (const PooledPoint& point : points_) {
    if (point.record.status != PointStatus::failed) continue;
    const std::string& name = point.record.point.name;
    text += fmt::format("failed: {}{}{}\n", name, name.empty() ? "" : ": ", point.record.message);
  }
  return text;
}

}  // namespace hardbody
