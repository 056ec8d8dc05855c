#include "command_line.h"

#include "base/errors.h"
#include "base/number_text.h"
#include "base/version.h"
#include "commands/commands.h"
#include "commands/sweep_tasks.h"
#include "io/text_file.h"
#include "report/assets.h"
#include "sweep/replicas.h"

#include <fmt/format.h>
#include <fmt/ranges.h>
#include <CLI/CLI.hpp>

#include <algorithm>
#include <cstddef>
#include <cstdio>
#include <exception>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

namespace hardbody {
namespace {

constexpr int kBadInput = 2;
constexpr int kFailed = 1;

/// Subcommand and arguments of the command line.
struct Request {
  RunArguments run;
  SweepArguments sweep;
  SweepTaskArguments tasks;
  std::vector<std::string> sweep_words;
  std::optional<double> task_time;
  MapArguments map;
  std::string init_file;
  std::string init_template = "ellipsoid";
  ResumeArguments resume;
  ExtendArguments extend;
  std::string check_path;
  std::string replay_file;
  AnalyzeArguments analyze;
  std::string distance_file = "-";
  ReportArguments report;
};

void add_init(CLI::App& app, Request& request) {
  CLI::App* init = app.add_subcommand("init", "Write a commented config to start from");
  init->add_option("FILE", request.init_file, "New file; default: standard output");
  init->add_option("--template", request.init_template,
                   "Template: ellipsoid (the default), superball, capsule, polyhedron, mixture, sweep");
}

void add_run(CLI::App& app, Request& request) {
  CLI::App* run = app.add_subcommand("run", "Run one state point: start, equilibration, production");
  run->add_option("CONFIG", request.run.config, "Config file, see `hardbody init`")->required();
  run->add_option("--out", request.run.out, "Run directory; default: out/<name of the config>");
  run->add_option("--set", request.run.overrides, "section.key=value: overrides the config; may be repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
  run->add_flag("--force", request.run.force, "Overwrite an existing run in the directory");
  run->add_option("--replicas", request.run.replicas, "Number of runs with different seeds, pooled as those of a sweep")
      ->check(CLI::Range(1, kMostReplicas));
}

void add_resume(CLI::App& app, Request& request) {
  CLI::App* resume = app.add_subcommand("resume", "Continue a run that was stopped or killed, bit for bit");
  resume->add_option("DIR", request.resume.path, "Run directory")->required();
  resume
      ->add_option("--set", request.resume.overrides,
                   "section.key=value: changes output.checkpoint_every; other keys are those of the run")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
}

/// Validator of positive numbers: CLI11's own names the largest double with all its digits.
CLI::Validator positive_number() {
  return {[](const std::string& text) -> std::string {
            const std::optional<double> value =
                finite_number(std::string_view(text).substr(text.starts_with('+') ? 1 : 0));
            return value && *value > 0 ? "" : fmt::format("{} is not a positive finite number", text);
          },
          "POSITIVE"};
}

void add_sweep(CLI::App& app, Request& request) {
  CLI::App* sweep = app.add_subcommand("sweep", "Run a grid of state points, several at a time");
  sweep
      ->add_option(
          "SWEEP", request.sweep_words,
          "Sweep file, see `hardbody init --template sweep`; or plan SWEEP, point SWEEP ID.., collect SWEEP: a\n"
          "sweep as tasks of a cluster")
      ->required();
  sweep->add_option("--on", request.sweep.on,
                    "Run it as tasks of a cluster: slurm, local, or the directory of a Snakemake profile");
  sweep
      ->add_option("--task-time", request.task_time,
                   "Of plan and --on: wished seconds of a task of several runs; default: 600")
      ->check(positive_number());
  sweep
      ->add_option("--time-limit", request.tasks.time_limit,
                   "Of point: seconds after which it saves its state and ends with 138")
      ->check(positive_number());
  sweep->add_option("--out", request.sweep.out, "Directory of the sweep; default: out/<name of the file>");
  sweep->add_option("--jobs", request.sweep.jobs,
                    "Number of simultaneous runs; default: one for each processor; with --on: of jobs");
  sweep
      ->add_option("--set", request.sweep.overrides,
                   "section.key=value: overrides the config of all points; grid.section.key=[..]: the grid; may be "
                   "repeated")
      ->allow_extra_args(false)
      ->type_name("KEY=VALUE");
}

void add_map(CLI::App& app, Request& request) {
  CLI::App* map = app.add_subcommand("map", "Draw contour lines of observables over two keys of a sweep");
  MapArguments& wanted = request.map;
  map->add_option("TABLE", wanted.table, "Directory of a sweep, or a table like its sweep.csv")->required();
  map->add_option("--x", wanted.x, "Column along x")->required();
  map->add_option("--y", wanted.y, "Column along y")->required();
  map->add_option("--value", wanted.values, "Column whose contour lines are drawn; may be repeated")
      ->required()
      ->allow_extra_args(false);
  map->add_option("--levels", wanted.levels,
                  "Its levels, 0.5,0.2,0.1; once for each value, or not at all: about six round ones are chosen")
      ->allow_extra_args(false);
  map->add_option("--where", wanted.where, "column=value: use only these rows; may be repeated")
      ->allow_extra_args(false);
  map->add_flag("--log-x", wanted.log_x, "Logarithmic x axis");
  map->add_flag("--log-y", wanted.log_y, "Logarithmic y axis");
  map->add_option("--out", wanted.out, "SVG file of the drawing; default: map_VALUE.svg beside the table");
  map->add_option("--csv", wanted.csv, "CSV file of the lines; default: map_VALUE.csv beside the table");
}

void add_check(CLI::App& app, Request& request) {
  CLI::App* check =
      app.add_subcommand("check",
                         "Audit a run's last state, or a trajectory: overlaps, conservation, finite values. Exit "
                         "status 0: sound, and everything was tested");
  check->add_option("PATH", request.check_path, "Run directory, GSD file or LAMMPS text dump")->required();
}

void add_replay(CLI::App& app, Request& request) {
  CLI::App* replay = app.add_subcommand("replay", "Show a pair from failures/ step by step");
  replay->add_option("FILE", request.replay_file, "failures/*.json")->required();
}

void add_extend(CLI::App& app, Request& request) {
  CLI::App* extend = app.add_subcommand("extend", "Continue a finished run to a longer production, bit for bit");
  extend->add_option("DIR", request.extend.path, "Directory of a finished run")->required();
  extend->add_option("--time", request.extend.time, "Length of the whole production, as production.time")
      ->required()
      ->check(positive_number());
}

void add_analyze(CLI::App& app, Request& request) {
  CLI::App* analyze =
      app.add_subcommand("analyze", "Compute observables of a stored trajectory, from this or another program");
  analyze
      ->add_option("PATH", request.analyze.path, "Run directory with a trajectory, or a GSD file or LAMMPS text dump")
      ->required();
  analyze->add_option("--out", request.analyze.out, "Output directory; default: analysis/ beside the trajectory");
  analyze->add_option("--time-step", request.analyze.time_step, "Time between two steps, replaces the stored times")
      ->check(positive_number());
  analyze
      ->add_option("--longest-lag", request.analyze.longest_lag,
                   "Longest lag of correlations, within the trajectory; default: a quarter of it")
      ->check(positive_number());
  analyze
      ->add_option("--fit-from", request.analyze.fit_from,
                   "First lag of the fits of C2 and F_self; default: that of the run in the directory, or the end of\n"
                   "ballistic motion")
      ->check(positive_number());
  analyze->add_flag("--collective", request.analyze.collective,
                    "Compute F(q, t) / S(q) of all bodies, too, at the wave numbers of F_self");
  analyze->add_option("--every", request.analyze.every, "Use only every N-th frame; bodies are followed through all")
      ->check(CLI::Range(1, 1000000));
}

void add_distance(CLI::App& app, Request& request) {
  for (const auto& [name, what] :
       {std::pair("distance", "Compute distances of pairs of bodies: JSON lines in, JSON lines out"),
        std::pair("query", "Answer queries about bodies, distances among them: JSON lines in, JSON lines out")}) {
    CLI::App* command = app.add_subcommand(name, what);
    command->add_option("FILE", request.distance_file, "File with one query a line; default, or -: standard input");
    command->footer(distance_help());
  }
}

void add_report(CLI::App& app, Request& request) {
  CLI::App* report = app.add_subcommand("report", "Write the results of runs as one HTML file that needs no network");
  report
      ->add_option("DIR", request.report.directories,
                   "Run directories, shown side by side; or the directory of a sweep")
      ->required();
  report->add_option("-o", request.report.out, "HTML file; default: DIR/report.html")->type_name("FILE");
}

/// Refuses options of other forms of the command with plan, point or collect.
void check_task_options(const Request& request, const std::string& action) {
  const auto refuse = [&](bool given, const char* option, const char* accepted) {
    if (!given) return;
    throw InputError(fmt::format("command line: {} with {}; accepted: {}", option, action, accepted));
  };
  refuse(request.sweep.jobs.has_value(), "--jobs", "hardbody sweep SWEEP --jobs N");
  refuse(request.sweep.on.has_value(), "--on", "hardbody sweep SWEEP --on NAME");
  refuse(request.tasks.time_limit && action != "point", "--time-limit", "with hardbody sweep point");
  refuse(request.task_time && action != "plan", "--task-time", "with hardbody sweep plan, or --on");
}

/// Runs a sweep here, or the part of one that the first word names.
int dispatch_sweep(const Request& request) {
  const std::vector<std::string>& words = request.sweep_words;
  const std::string& action = words.front();
  const bool is_task = words.size() > 1 && (action == "plan" || action == "point" || action == "collect");
  const std::size_t wanted = !is_task ? 1 : action == "point" ? std::max<std::size_t>(words.size(), 3) : 2;
  if (words.size() != wanted) {
    throw InputError(
        fmt::format("command line: hardbody sweep {}; accepted: SWEEP, plan SWEEP, point SWEEP ID.., or "
                    "collect SWEEP",
                    one_line(fmt::format("{}", fmt::join(words, " ")))));
  }
  if (!is_task) {
    SweepArguments sweep = request.sweep;
    sweep.sweep = action;
    sweep.task_time = request.task_time.value_or(sweep.task_time);
    if (request.task_time && !sweep.on)
      throw InputError("command line: --task-time; accepted: with hardbody sweep plan, or --on");
    if (request.tasks.time_limit) throw InputError("command line: --time-limit; accepted: with hardbody sweep point");
    return sweep.on ? sweep_on(sweep) : hardbody::sweep(sweep);
  }
  check_task_options(request, action);
  SweepTaskArguments tasks = request.tasks;
  tasks.task_time = request.task_time.value_or(tasks.task_time);
  tasks.sweep = words[1];
  tasks.ids.assign(words.begin() + 2, words.end());
  tasks.out = request.sweep.out;
  tasks.overrides = request.sweep.overrides;
  tasks.program = request.sweep.program;
  if (action == "plan") return sweep_plan(tasks);
  return action == "point" ? sweep_point(tasks) : sweep_collect(tasks);
}

int dispatch(const CLI::App& app, const Request& request) {
  if (app.got_subcommand("init")) return init(request.init_file, request.init_template);
  if (app.got_subcommand("run")) return run(request.run);
  if (app.got_subcommand("resume")) return resume(request.resume);
  if (app.got_subcommand("extend")) return extend(request.extend);
  if (app.got_subcommand("sweep")) return dispatch_sweep(request);
  if (app.got_subcommand("map")) return map(request.map);
  if (app.got_subcommand("check")) return check(request.check_path);
  if (app.got_subcommand("analyze")) return analyze(request.analyze);
  if (app.got_subcommand("distance") || app.got_subcommand("query")) return distance(request.distance_file);
  if (app.got_subcommand("report")) return report(request.report);
  return replay(request.replay_file);
}

/// Expands `--set a=1 b=2` to `--set a=1 --set b=2`. CLI11 would take a config path after it as a third value.
std::vector<std::string> expand_overrides(int argc, char** argv) {
  std::vector<std::string> arguments;
  bool in_set = false;
  for (int k = 1; k < argc; ++k) {
    const std::string_view argument = argv[k];
    const bool assignment = !argument.starts_with("-") && argument.find('=') != std::string_view::npos;
    if (in_set && assignment && arguments.back() != "--set") arguments.emplace_back("--set");
    in_set = argument == "--set" || (in_set && assignment);
    arguments.emplace_back(argument);
  }
  return arguments;
}

/// Returns "hardbody sweep plan" of the command that was named, as far as it was understood.
std::string command_named(const CLI::App& app) {
  std::string name = app.get_name();
  for (const CLI::App* at = &app; !at->get_subcommands().empty();) {
    at = at->get_subcommands().front();
    name += ' ' + at->get_name();
  }
  return name;
}

/// Throws InputError, which lists the commands, if the first argument is no option and none of them, or there is none.
void check_command(const CLI::App& app, const std::vector<std::string>& arguments) {
  if (!arguments.empty() && arguments.front().starts_with("-")) return;
  std::vector<std::string> names;
  for (const CLI::App* command : app.get_subcommands([](const CLI::App*) { return true; })) {
    names.push_back(command->get_name());
    if (!arguments.empty() && arguments.front() == names.back()) return;
  }
  const std::string what = arguments.empty() ? "no command" : '"' + one_line(arguments.front()) + "\" is no command";
  throw InputError(
      fmt::format("command line: {}; accepted: {}; hardbody --help explains them", what, fmt::join(names, ", ")));
}

/// Returns the line of `hardbody --version` about reports.
std::string report_text() {
  return report_script().empty() ? "reports: static, built without npm\n" : "reports: interactive\n";
}

int parsed(int argc, char** argv, std::vector<std::string> program) {
  Request request;
  request.run.program = program;
  request.sweep.program = std::move(program);
  CLI::App app("Event-driven molecular dynamics of hard convex bodies", "hardbody");
  app.set_version_flag("--version", version_text() + report_text());
  app.require_subcommand(1);
  app.footer(
      "Exit status: 0 success, 1 failure, 2 invalid input; 130, 143, 129 and 152: stopped by SIGINT, SIGTERM, SIGHUP "
      "and "
      "SIGXCPU, results saved.");
  add_init(app, request);
  add_run(app, request);
  add_resume(app, request);
  add_extend(app, request);
  add_sweep(app, request);
  add_map(app, request);
  add_check(app, request);
  add_analyze(app, request);
  add_replay(app, request);
  add_report(app, request);
  add_distance(app, request);
  std::vector<std::string> arguments = expand_overrides(argc, argv);
  check_command(app, arguments);
  // CLI11 takes arguments from the back.
  std::reverse(arguments.begin(), arguments.end());
  try {
    app.parse(std::move(arguments));
  } catch (const CLI::Success& wanted) {  // --help, --version
    return app.exit(wanted);
  } catch (const CLI::ParseError& error) {
    throw InputError(
        fmt::format("command line: {}; accepted: see {} --help", one_line(error.what()), command_named(app)));
  }
  return dispatch(app, request);
}

int fail(const std::exception& error, int status) {
  (void)std::fputs((one_line(error.what(), 2000) + '\n').c_str(), stderr);
  return status;
}

}  // namespace

int run_command_line(int argc, char** argv, std::vector<std::string> program) {
  try {
    return parsed(argc, argv, std::move(program));
  } catch (const InputError& error) {
    return fail(error, kBadInput);
  } catch (const std::exception& error) {
    return fail(error, kFailed);
  }
}

}  // namespace hardbody
