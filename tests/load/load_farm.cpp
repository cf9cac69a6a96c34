#include "tests/load/load_farm.h"

#include <fcntl.h>
#include <fmt/format.h>
#include <stdlib.h>
#include <sys/mman.h>
#include <sys/resource.h>
#include <unistd.h>

#include <chrono>
#include <fstream>
#include <optional>
#include <utility>

#include "kernels/host/process.h"
#include "scheduler/farm/render_farm.h"
#include "scheduler/farm/render_job_check.h"
#include "tests/load/load_board.h"
#include "tests/load/load_samples.h"
#include "tests/support/fake_device.h"
#include "tests/support/temporary_folder.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

constexpr double kTimeToSettle = 1.5;  // until the memory of idle workers is read
constexpr double kTimeToConnect = 60;

double cpu_seconds() {
  rusage usage{};
  getrusage(RUSAGE_SELF, &usage);
  const auto seconds = [](const timeval& time) { return double(time.tv_sec) + 1e-6 * double(time.tv_usec); };
  return seconds(usage.ru_utime) + seconds(usage.ru_stime);
}

double resident_bytes() {
  std::ifstream file("/proc/self/statm");
  double pages = 0;
  file >> pages >> pages;
  return pages * double(sysconf(_SC_PAGESIZE));
}

/// A board in a file, which the workers' process maps, too.
class SharedBoard {
 public:
  SharedBoard() {
    const std::string path = folder_ / "board";
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0600);
    if (file < 0 || ftruncate(file, sizeof(LoadBoard)) != 0)
      throw std::runtime_error("no file for the board");
    void* memory = mmap(nullptr, sizeof(LoadBoard), PROT_READ | PROT_WRITE, MAP_SHARED, file, 0);
    close(file);
    if (memory == MAP_FAILED) throw std::runtime_error("no memory for the board");
    board_ = new (memory) LoadBoard;
    setenv(kBoardVariable, path.c_str(), 1);
  }
  SharedBoard(const SharedBoard&) = delete;
  SharedBoard& operator=(const SharedBoard&) = delete;
  ~SharedBoard() { munmap(board_, sizeof(LoadBoard)); }
  LoadBoard& operator*() { return *board_; }

 private:
  TemporaryFolder folder_;
  LoadBoard* board_ = nullptr;
};

/// The job comes when all workers are connected and idle.
class LoadSource final : public JobSource {
 public:
  LoadSource(std::shared_ptr<const RenderJob> job, const LoadBoard& board)
      : job_(std::move(job)), board_(board) {}

  std::shared_ptr<const RenderJob> next() override {
    if (!job_) return nullptr;
    if (!base_) base_ = resident_bytes();
    if (board_.connected < board_.workers) {
      connected_ = Clock::now();
      if (seconds_since(begin_) > kTimeToConnect) return std::exchange(job_, nullptr);
      return nullptr;
    }
    if (seconds_since(connected_) < kTimeToSettle) return nullptr;
    idle_ = resident_bytes();
    return std::exchange(job_, nullptr);
  }
  bool is_exhausted() override { return !job_; }
  void progress(JobId, const RenderProgress& progress) override {
    if (!first_ && progress.samples_done > 0) first_ = now(progress.samples_done);
    last_ = now(progress.samples_done);
  }
  void done(JobId, Expected<RenderOutcome> outcome) override { outcome_ = std::move(outcome); }

  struct Moment {
    Clock::time_point time;
    double cpu;
    std::uint64_t samples;
  };
  [[nodiscard]] double bytes_per_idle_worker() const { return (idle_ - base_.value_or(0)) / board_.workers; }

  std::optional<Moment> first_;
  Moment last_{};
  Expected<RenderOutcome> outcome_ = fail("the render was not begun");

 private:
  static Moment now(std::uint64_t samples) { return {Clock::now(), cpu_seconds(), samples}; }

  std::shared_ptr<const RenderJob> job_;
  const LoadBoard& board_;
  const Clock::time_point begin_ = Clock::now();
  Clock::time_point connected_ = begin_;
  std::optional<double> base_;
  double idle_ = 0;
};

template <typename Do>
void for_each_unit(const RenderJob& job, Do act) {
  for (std::uint32_t pass = 0; pass < job.spp; ++pass)
    for (int y = 0; y < job.height; y += job.request.plan.tile)
      for (int x = 0; x < job.width; x += job.request.plan.tile)
        act(RenderUnit{x, y, job.request.plan.tile, job.request.plan.tile, pass, 1});
}

std::uint64_t expected_hash(const RenderJob& job) {
  const FilmLayers layers(job.scene.header.features);
  FilmAccumulator film(0, 0, job.width, job.height, layers);
  for_each_unit(
      job, [&](const RenderUnit& unit) { film.add(unit.x, unit.y, load_samples(unit, layers.planes())); });
  return film.hash();
}

}  // namespace

Expected<LoadFigures> run_load(const LoadSettings& settings, const std::string& program) {
  const auto job = std::make_shared<RenderJob>();
  const int size = settings.side * settings.tile;
  job->scene = fake_scene(size, size, false);
  job->scene.header.features |= settings.features;
  job->width = job->height = size;
  job->request.plan.tile = settings.tile;
  job->request.plan.samples_per_pass = 1;
  const int tiles = settings.side * settings.side;
  job->spp = std::uint32_t(std::max(1, (settings.units + tiles - 1) / tiles));
  if (auto checked = check_render_job(*job); !checked) return std::unexpected(checked.error());

  SharedBoard shared;
  LoadBoard& board = *shared;
  board.workers = settings.workers;
  board.unit_seconds = settings.unit_seconds;
  board.planes = plane_count(job->scene.header.features);
  board.deaths = settings.deaths;
  board.units = std::uint64_t(tiles) * job->spp;
  LoadSource source(job, board);
  const std::atomic<bool> stop = false;
  const FarmOptions farm{.workers = 1, .worker_executable = program};
  if (auto ran = run_farm(farm, source, stop); !ran) return std::unexpected(ran.error());
  if (!source.outcome_) return std::unexpected(source.outcome_.error());
  const RenderOutcome& outcome = *source.outcome_;
  const std::uint64_t units = board.units;
  if (!outcome.complete || outcome.units_done != units)
    return fail(fmt::format("{} of {} units were done{}", outcome.units_done, units,
                            outcome.problems.empty() ? "" : ": " + outcome.problems.back()));
  if (outcome.film.hash() != expected_hash(*job)) return fail("the film has other pixels");
  if (settings.deaths == 0 && !outcome.problems.empty())
    return fail("there was a problem: " + outcome.problems.front());

  const auto& first = source.first_.value_or(source.last_);
  const double measured_units =
      double(source.last_.samples - first.samples) / double(settings.tile * settings.tile);
  const double seconds = std::chrono::duration<double>(source.last_.time - first.time).count();
  const bool is_measured = measured_units > 0;
  double ideal = 0;
  for_each_unit(*job, [&](const RenderUnit& unit) { ideal += load_seconds(unit, settings.unit_seconds); });
  ideal /= settings.workers;
  return LoadFigures{
      .units = units,
      .bytes_per_result = std::uint64_t(settings.tile * settings.tile * board.planes) * sizeof(float),
      .units_per_second = is_measured ? measured_units / seconds : 0,
      .cpu_seconds_per_unit = is_measured ? (source.last_.cpu - first.cpu) / measured_units : 0,
      .order_p50 = board.orders.quantile(0.5),
      .order_p99 = board.orders.quantile(0.99),
      .redispatch_p50 = board.redispatches.quantile(0.5),
      .redispatch_most = board.redispatches.quantile(1),
      .bytes_per_idle_worker = source.bytes_per_idle_worker(),
      .peak_bytes = peak_memory_bytes(),
      .overhead = ideal > 0 ? (outcome.seconds_to_last_tile - outcome.seconds_to_ready) / ideal - 1 : 0};
}

}  // namespace penumbra
