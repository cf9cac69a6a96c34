// `penumbra report SCENE... -o DIR`: compares error against render time.
#include <fmt/format.h>

#include <array>
#include <cstdlib>
#include <fstream>
#include <memory>
#include <nlohmann/json.hpp>

#include "kernels/host/atomic_file.h"
#include "kernels/host/parallel.h"
#include "kernels/host/process.h"
#include "scheduler/cli/commands.h"
#include "scheduler/files/program_path.h"
#include "scheduler/files/stop_signal.h"
#include "scheduler/record/render_record.h"
#include "scheduler/record/version.h"
#include "scheduler/report/gnuplot.h"
#include "scheduler/report/html.h"
#include "scheduler/report/plot.h"
#include "scheduler/report/report_assembly.h"
#include "scheduler/report/report_cells.h"
#include "scheduler/report/report_json.h"
#include "scheduler/report/report_options.h"
#include "scheduler/report/report_plan.h"
#include "scheduler/report/summary_table.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

std::array<double, 3> load_averages() {
  std::array<double, 3> load{};
  if (getloadavg(load.data(), 3) != 3) load.fill(0);
  return load;
}

/// Files of an existing report may be overwritten, but not files of other programs.
Expected<void> check_own_files(const fs::path& folder) {
  const std::pair<const char*, std::string_view> files[] = {{"index.html", kReportPageMarker},
                                                            {"report.json", "\"penumbra\":"},
                                                            {"report.csv", "scene,curve,kind,"},
                                                            {"table.csv", "scene,method,slope_"},
                                                            {"table.tex", kLatexMarker}};
  for (const auto& [name, marker] : files) {
    std::error_code unknown;
    if (!fs::exists(folder / name, unknown)) continue;
    std::string begin(4096, '\0');
    if (fs::is_regular_file(folder / name, unknown)) {  // reading a pipe might block for ever
      std::ifstream file(folder / name, std::ios::binary);
      file.read(begin.data(), std::streamsize(begin.size()));
    }
    if (begin.find(marker) != std::string::npos) continue;
    return fail(
        fmt::format("{} is not of a report of this program, and would be overwritten; take another "
                    "folder, or remove it",
                    (folder / name).string()));
  }
  return {};
}

ReportData begin_report(const ReportOptions& options, const std::vector<ScenePlan>& plans,
                        const std::vector<std::string>& command_line) {
  ReportData report;
  report.version = kVersion;
  report.host = host_name();
  report.started = utc_now();
  report.command_line = command_line;
  report.cores = unsigned(core_count());
  report.workers = options.render.workers;
  report.threads = plans.front().curves.front().cells.front().front().settings.at("threads");
  report.repeats = options.repeats;
  report.seeds = options.seeds;
  report.load_start = load_averages();
  report.epsilon = options.epsilon;
  report.total_time = options.time == "total";
  return report;
}

Expected<void> write_report(const fs::path& folder, const ReportData& report) {
  const std::string json =
      report_data_json(report).dump(2, ' ', false, nlohmann::json::error_handler_t::replace) + "\n";
  const std::pair<const char*, std::string> files[] = {{"report.json", json},
                                                       {"report.csv", report_csv(report)},
                                                       {"table.csv", summary_csv(report)},
                                                       {"table.tex", summary_latex(report)},
                                                       {"index.html", report_html(report)}};
  for (const auto& [name, text] : files) {
    if (auto written = write_output(folder / name, bytes_of(text)); !written) return written;
  }
  return {};
}

void print_summary(const fs::path& folder, const ReportData& report) {
  for (const SceneReport& scene : report.scenes) {
    print_remark(scene.name + "\n");
    for (const ErrorCurve& curve : scene.curves) {
      const auto& fit = curve.mse_over_time.fit;
      print_remark(
          fmt::format("  {:<40} {}\n", curve.name.label,
                      fit ? fmt::format("MSE ~ T^{:.2f} [{:.2f}, {:.2f}]", fit->slope, fit->low, fit->high)
                          : "no slope: " + curve.mse_over_time.none_because));
    }
  }
  print_remark(fmt::format("wrote {}\n", (folder / "index.html").string()));
}

/// Assembles, draws and writes the report from the cells. Prints errors.
bool finish_report(const ReportOptions& options, const std::vector<ScenePlan>& plans, const CellStore& store,
                   const fs::path& gnuplot, std::size_t failed, ReportData& report) {
  const fs::path folder = options.out;
  bool good = true;
  std::size_t missing = 0;
  for (const ScenePlan& plan : plans) {
    auto scene = assemble_scene(options, plan, store, report, missing);
    if (!scene) {
      print_error(scene.error());
      good = false;
      continue;
    }
    if (!*scene) continue;  // its reference is missing
    report.scenes.push_back(std::move(**scene));
  }
  for (SceneReport& scene : report.scenes) {
    if (options.no_plots) break;
    auto plots = draw_plots(gnuplot, folder / "plots", report, scene);
    if (plots) {
      scene.plots = std::move(*plots);
    } else {
      print_error(plots.error());
      good = false;
    }
  }
  // Failed cells were reported already. Others that are missing must have been removed.
  if (missing > failed) {
    print_error(
        {fmt::format("images of this report have been removed or damaged in {} meanwhile; the same command "
                     "renders them again",
                     (folder / "cells").string())});
    good = false;
  }
  report.load_end = load_averages();
  report.finished = utc_now();
  if (auto written = write_report(folder, report); !written) return print_error(written.error()), false;
  if (!options.quiet) print_summary(folder, report);
  return good;
}

ExitCode report_command(ReportOptions options, const std::vector<std::string>& command_line) {
  const std::atomic<bool>& stop = install_stop_signal();
  if (options.budgets.empty()) options.budgets = *parse_budgets("1..64");
  fs::path gnuplot;
  if (!options.no_plots) {
    const auto found = find_gnuplot();
    if (!found) return print_error(found.error()), kIncomplete;
    gnuplot = *found;
  }
  const auto worker = find_program("penumbra-worker");
  if (!worker) return print_error(worker.error()), kIncomplete;
  if (const auto own = check_own_files(options.out); !own) return print_error(own.error()), kBadInput;
  const auto store = CellStore::open(fs::path(options.out) / "cells");
  if (!store) return print_error(store.error()), kBadInput;
  const auto plans = plan_report(options, *store, program_hash(*worker));
  if (!plans) return print_error(plans.error()), kBadInput;

  ReportData report = begin_report(options, *plans, command_line);
  const CellRun run = run_cells(*plans, *store, {worker->string(), options.repeats, options.quiet}, stop);
  for (const std::string& failure : run.failures) print_error({failure});
  if (run.stopped) {
    print_error({fmt::format("stopped; {} of {} images are there, and the same command goes on from them",
                             run.found + run.rendered, run.total)});
    return kIncomplete;
  }
  const bool good = finish_report(options, *plans, *store, gnuplot, run.failures.size(), report);
  return good && run.failures.empty() ? kAllDone : kIncomplete;
}

}  // namespace

void add_report_command(CommandLine& app, const std::vector<std::string>& command_line, Command& chosen) {
  CommandLine* command =
      app.add_command("report", "Plot error against run time, as one HTML page with equal-time pictures");
  const auto options = std::make_shared<ReportOptions>();
  add_report_options(*command, *options);
  command->footer(
      "Renders every scene with every method, sampler and backend at every budget, with several seeds each, "
      "and measures the errors against a reference. Writes DIR/index.html (one file, needs no network), "
      "report.json, report.csv, table.csv, table.tex (LaTeX), plots/ and cells/, which holds the images. An "
      "interrupted report continues; "
      "images are used again only if scene, settings and program are the same. Let nothing else run on the "
      "machine meanwhile.\n\n"
      "Exit code: 0 all done; 1 stopped, or something failed; 2 bad usage or bad input.\n\n"
      "Examples:\n"
      "  penumbra report scene.xml -o out --integrator path_ems --integrator path_mis\n"
      "  penumbra report scene.xml -o out --integrator path --integrator cv=path:nee=cv --spp 1..256\n"
      "  penumbra report a.xml b.xml -o out --backend native --backend opencl --threads 1\n"
      "  penumbra report scene.xml -o out --sampler independent --sampler stratified --sampler sobol\n"
      "  penumbra report scene.xml -o out --reference truth.exr --target relmse=1e-3\n"
      "  penumbra report scene.xml -o out --peer mitsuba-images      images/direct/0.35-seconds.exr, ...");
  command->callback([options, &command_line, &chosen] {
    chosen = [options, &command_line] { return report_command(*options, command_line); };
  });
}

}  // namespace penumbra
