#include "scheduler/report/report_cells.h"
#include "kernels/host/text.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <cstdlib>

#include "kernels/host/console.h"
#include "scheduler/record/film_image.h"
#include "scheduler/record/render_statistics.h"
#include "scheduler/report/curve_builder.h"
#include "scheduler/run/progress.h"
#include "scheduler/run/render_preparation.h"

namespace penumbra {
namespace {

double load_average() {
  double load[1] = {0};
  return getloadavg(load, 1) == 1 ? load[0] : 0;
}

PhaseSeconds phases_of(const PreparedRender& prepared, const RenderOutcome& outcome) {
  PhaseSeconds seconds;
  seconds.build = prepared.scene.seconds;
  seconds.transfer = outcome.seconds_to_ready;
  seconds.render = outcome.seconds_to_last_tile - outcome.seconds_to_ready;
  seconds.total = seconds.build + outcome.seconds;
  return seconds;
}

PhaseSeconds median_phases(const std::vector<PhaseSeconds>& all) {
  const auto of = [&](double PhaseSeconds::*phase) {
    std::vector<double> values;
    for (const PhaseSeconds& seconds : all) values.push_back(seconds.*phase);
    return median(std::move(values));
  };
  return {of(&PhaseSeconds::build), of(&PhaseSeconds::transfer), of(&PhaseSeconds::render),
          of(&PhaseSeconds::total)};
}

/// Renders and stores one cell, with the given number of repeats. Returns false if the user stopped it.
Expected<bool> run_cell(const CellPlan& cell, const CellStore& store, int repeats,
                        const CellRunOptions& options, const std::atomic<bool>& stop,
                        ProgressPrinter& progress) {
  ImageResult result;
  result.seed = *cell.options.scene.seed;
  result.load_before = load_average();
  std::vector<PhaseSeconds> seconds;
  Image image;
  for (int i = 0; i < repeats; ++i) {
    auto prepared = prepare_render(cell.options);
    if (!prepared) return std::unexpected(prepared.error());
    prepared->farm.worker_executable = options.worker_executable;
    const auto outcome = run_render(prepared->job, prepared->farm, stop,
                                    [&](const RenderProgress& now) { progress.update(now); });
    progress.finish();
    if (stop) return false;
    if (!outcome) return std::unexpected(outcome.error());
    if (!outcome->complete) return fail(fmt::format("{}", fmt::join(outcome->problems, "; ")));
    const std::string hash = hash_text(outcome->film.hash());
    if (i > 0 && hash != result.film_hash) return fail("two renders of it differ");
    result.film_hash = hash;
    result.bad_samples = non_finite_count(outcome->film.flagged());
    seconds.push_back(phases_of(*prepared, *outcome));
    result.render_seconds.push_back(seconds.back().render);
    if (i > 0) continue;
    image = image_of_film(outcome->film, prepared->record.film.width, prepared->record.film.height);
    image.metadata = record_metadata(prepared->record, outcome->film.hash(), rendered_samples(*outcome));
  }
  result.seconds = median_phases(seconds);
  result.load_after = load_average();
  if (auto saved = store.save(cell.id, image, result, cell.settings); !saved)
    return std::unexpected(saved.error());
  return true;
}

struct QueuedCell {
  const CellPlan* cell;
  int repeats;
};

std::vector<QueuedCell> queue_of(const std::vector<ScenePlan>& plans, int repeats) {
  std::vector<QueuedCell> queue;
  for (const ScenePlan& plan : plans)
    for (const CellPlan& cell : plan.reference_cells) queue.push_back({&cell, 1});
  for (const ScenePlan& plan : plans) {
    if (plan.curves.empty()) continue;
    const auto& shape = plan.curves.front().cells;  // all curves have the same budgets and seeds
    for (std::size_t budget = 0; budget < shape.size(); ++budget)
      for (std::size_t seed = 0; seed < shape[budget].size(); ++seed)
        for (const CurvePlan& curve : plan.curves) queue.push_back({&curve.cells[budget][seed], repeats});
  }
  return queue;
}

}  // namespace

CellRun run_cells(const std::vector<ScenePlan>& plans, const CellStore& store, const CellRunOptions& options,
                  const std::atomic<bool>& stop) {
  CellRun run;
  const auto queue = queue_of(plans, options.repeats);
  run.total = queue.size();
  const ProgressStyle style = options.quiet ? ProgressStyle::kNone : progress_style();
  for (std::size_t i = 0; i < queue.size() && !run.stopped; ++i) {
    const CellPlan& cell = *queue[i].cell;
    std::string damage;
    if (store.find(cell.id, &damage)) {
      ++run.found;
      continue;
    }
    if (!damage.empty()) print_warning(damage + "; it is rendered again");
    if (!options.quiet) print_message(fmt::format("[{}/{}] {}", i + 1, queue.size(), cell.what));
    ProgressPrinter progress(style, terminal_columns());
    const auto done = run_cell(cell, store, queue[i].repeats, options, stop, progress);
    if (!done) {
      run.failures.push_back(fmt::format("{}: {}", cell.what, done.error().message));
    } else if (*done) {
      ++run.rendered;
    }
    run.stopped = stop;
  }
  return run;
}

}  // namespace penumbra
