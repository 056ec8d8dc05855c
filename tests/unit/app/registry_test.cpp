/// Registry of observables: one entry puts an observable into every output, and docs/output.md lists the same.

#include "config/config.h"
#include "registry/curves.h"
#include "registry/observables.h"
#include "report/run.h"
#include "run/files/observable_files.h"
#include "run/summary.h"
#include "run/table.h"

#include <fmt/format.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <nlohmann/json.hpp>

#include <cmath>
#include <fstream>
#include <set>
#include <sstream>
#include <string>
#include <vector>

namespace hardbody {
namespace {

using testing::ElementsAre;
using testing::HasSubstr;
using testing::Not;

/// Ratio that nothing in the program knows.
ed::Estimate anisotropy(const ed::GroupResults& r) {
  if (!std::isfinite(r.D_rot.value)) return ed::Estimate::none(r.D_rot.missing);
  return {r.D_trans.value / r.D_rot.value, 0.125};
}

Observable test_observable() {
  return {.key = "anisotropy",
          .symbol = "A_test",
          .name = "Ratio of the diffusions",
          .unit = "l^2",
          .definition = "D_trans / D_rot",
          .value = anisotropy,
          .label = "anisotropy",
          .remark = [](const Part& part) { return part.whole != nullptr ? "of all" : "of a species"; },
          .in_frames = true};
}

CurveFile test_curves() {
  return {.name = "test_msd", .columns = {{"root", "l", [](const ed::Correlations& c, std::size_t row, std::size_t) {
                                             return ed::Estimate{std::sqrt(c.lags[row].msd.value), 0.5};
                                           }}}};
}

/// Record of a run of two lags with some values.
RunRecord record_of_a_run() {
  RunRecord record;
  record.config =
      parse_config("[system]\nnumber = 64\npacking_fraction = 0.2\n[shape]\naspect_ratio = 2\n", "run.toml");
  ed::Results& results = record.production.results;
  results.D_trans = {3, 0.5};
  results.D_rot = {2, 0.25};
  for (const double lag : {0.5, 1.0}) {
    ed::LagRow row{};
    row.lag = lag;
    row.msd = {4 * lag * lag, 0.1};
    results.lags.push_back(row);
  }
  return record;
}

TEST(Registry, AnEntryIsInTheSummary) {
  const RunRecord record = record_of_a_run();
  EXPECT_THAT(summary_json(record), Not(HasSubstr("anisotropy")));
  const RegisteredObservable entry(test_observable());
  const auto summary = nlohmann::json::parse(summary_json(record));
  EXPECT_EQ(summary["observables"]["anisotropy"]["value"], 1.5);
  EXPECT_EQ(summary["observables"]["anisotropy"]["error"], 0.125);
}

TEST(Registry, AnEntryWithoutAValueSaysWhy) {
  const RegisteredObservable entry(test_observable());
  RunRecord record = record_of_a_run();
  record.production.results.D_rot = ed::Estimate::none({ed::MissingReason::meaningless});
  const auto summary = nlohmann::json::parse(summary_json(record));
  EXPECT_TRUE(summary["observables"]["anisotropy"]["value"].is_null());
  EXPECT_THAT(summary["observables"]["anisotropy"]["missing"].get<std::string>(), HasSubstr("nothing turns"));
  EXPECT_THAT(results_table(record, {}), HasSubstr("  anisotropy      - (meaningless: nothing turns these bodies)\n"));
}

TEST(Registry, AnEntryIsInTheTable) {
  const RegisteredObservable entry(test_observable());
  EXPECT_THAT(results_table(record_of_a_run(), {}),
              HasSubstr("  anisotropy      1.50 +- 0.12           l^2            of all\n"));
}

TEST(Registry, AnEntryIsInReportsAndSweeps) {
  const RegisteredObservable entry(test_observable());
  const auto summary = nlohmann::json::parse(summary_json(record_of_a_run()));
  const std::vector<Headline> headlines = headlines_of(summary["observables"], true);
  EXPECT_EQ(headlines.back().name, "Ratio of the diffusions");
  EXPECT_EQ(headlines.back().value, 1.5);
  EXPECT_EQ(headline_named("anisotropy").symbol, "A_test");
}

TEST(Registry, AFileHasItsColumns) {
  const RegisteredCurves entry(test_curves());
  const CurveFile* file = find_curves("test_msd");
  ASSERT_NE(file, nullptr);
  EXPECT_EQ(file->path(), "observables/test_msd.csv");
  EXPECT_EQ(curve_csv(*file, record_of_a_run().production.results),
            "t [l sqrt(m/kT)],root [l],root_error [l]\n0.5,1,0.5\n1,2,0.5\n");
  EXPECT_THAT(required_columns(*file), ElementsAre("t", "root"));
}

TEST(Registry, AnEntryLivesAsLongAsItsObject) {
  const std::size_t before = observables().size();
  { const RegisteredObservable entry(test_observable()); }
  EXPECT_EQ(observables().size(), before);
  EXPECT_EQ(find_observable("anisotropy"), nullptr);
}

TEST(Registry, KeysAndPlacesAreUnique) {
  std::set<std::string> keys;
  for (const Observable& o : observables()) EXPECT_TRUE(keys.insert(o.key).second) << o.key;
  for (int Places::*place : {&Places::summary, &Places::units, &Places::card, &Places::map, &Places::opened}) {
    std::set<int> taken;
    for (const Observable* o : observables_by(place)) EXPECT_TRUE(taken.insert(o->places.*place).second) << o->key;
  }
  for (const Observable& o : observables()) EXPECT_EQ(o.places.units > 0, static_cast<bool>(o.convention)) << o.key;
}

TEST(Registry, PlotsDrawColumnsAndValuesThatThereAre) {
  for (const CurvePlot& plot : plots()) {
    const CurveFile* file = find_curves(plot.file);
    EXPECT_EQ(file == nullptr, plot.file.empty()) << plot.id;
    for (const CurveLine& line : plot.lines) {
      std::set<std::string> names;
      for (const Column& c : file->columns) {
        names.insert(c.name);
        // A column of each edge of the box may be drawn by itself.
        for (const char* edge : kBodyAxes) names.insert(c.split == Split::edges ? c.name + "_" + edge : c.name);
      }
      for (const BlockColumn& c : block_columns()) names.insert(c.name);
      EXPECT_TRUE(names.contains(line.column)) << plot.id << ": " << line.column;
      for (const std::string& key : line.fit.keys) EXPECT_NE(find_observable(key), nullptr) << plot.id << ": " << key;
    }
  }
}

std::string escaped(std::string text) {
  for (std::size_t at = 0; (at = text.find('|', at)) != std::string::npos; at += 2) text.replace(at, 1, "\\|");
  return text;
}

TEST(Registry, DocumentationListsAllOfIt) {
  std::stringstream text;
  text << std::ifstream(HARDBODY_DOCS "/output.md").rdbuf();
  const std::string page = text.str();
  std::string list = "| key | name | unit | definition |\n|---|---|---|---|\n";
  for (const Observable& o : observables()) {
    list += fmt::format("| `{}` | {} | {} | {} |\n", o.key, o.name, o.unit, escaped(o.definition));
  }
  list += '\n';
  EXPECT_THAT(page, HasSubstr(list));
  for (const CurveFile& file : curve_files()) EXPECT_THAT(page, HasSubstr(fmt::format("`{}`", file.path())));
}

}  // namespace
}  // namespace hardbody
