#include "scheduler/farm/render_run.h"

#include <fmt/format.h>

#include <algorithm>

#include "scheduler/files/quoting.h"
#include "scheduler/protocol/token.h"

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kTickInterval{20};
constexpr Seconds kProgressInterval = 0.2, kShowInterval = 0.1;
// The error estimate goes over the whole film; on a large one it must not take up the scheduler's time.
constexpr double kProgressShare = 0.02;
// A pause of this very process (Ctrl-Z, a suspended machine) must not look like one of the workers.
constexpr Seconds kLongestTick = 1;
constexpr Seconds kTimeToDie = 2;  // from the end of a local worker's stream to the end of its process
// Viewers still receive what is queued for them at the end, as long as they keep reading.
constexpr std::chrono::milliseconds kPatienceWithWatchers{300};

}  // namespace

RenderRun::RenderRun(const RenderJob& job, const std::atomic<bool>& stop,
                     const std::function<void(const RenderProgress&)>& on_progress)
    : job_(job),
      stop_(stop),
      on_progress_(on_progress),
      planes_(plane_count(job.scene.header.features)),
      grid_(job.x, job.y, job.width, job.height, job.tile, job.spp, job.samples_per_pass),
      view_{0, view_of(job.scene.header)},
      plan_(make_plan()),
      merge_(make_merge()),
      board_(grid_.tiles()),
      feed_(board_, grid_, is_hybrid(job.scene)) {}

Plan RenderRun::make_plan() const {
  return Plan({{.tiles = grid_.tiles(), .passes = job_.interactive ? 0 : grid_.passes()}}, job_.leases);
}

Merge RenderRun::make_merge() const {
  return Merge(
      FilmAccumulator::of_features(job_.x, job_.y, job_.width, job_.height, job_.scene.header.features),
      grid_);
}

Expected<void> RenderRun::start() {
  Expected<PrivateSocket> socket = PrivateSocket::create();
  if (!socket) return std::unexpected(socket.error());
  socket_.emplace(std::move(*socket));
  Expected<std::unique_ptr<Server>> server =
      Server::listen({.address = socket_->address(),
                      .more = job_.listen,
                      .largest_result = std::size_t(job_.tile) * std::size_t(job_.tile) *
                                        std::size_t(planes_) * sizeof(float),
                      .interactive = job_.interactive},
                     board_);
  if (!server) return std::unexpected(server.error());
  server_ = std::move(*server);
  workers_here_.emplace(job_.worker_executable, socket_->address(), job_.workers);
  // They start up while the scene is being packed.
  workers_here_->start_missing(0);
  tell_start_problems();
  if (job_.tells_how_to_watch) tell_how_to_watch();
  scene_hash_ = server_->add_asset(job_.scene.serialize());
  WatchedJob watched{.title = job_.title,
                     .integrator = job_.integrator,
                     .film_width = job_.scene.header.film.width,
                     .film_height = job_.scene.header.film.height,
                     .x = job_.x,
                     .y = job_.y,
                     .width = job_.width,
                     .height = job_.height,
                     .spp = job_.spp,
                     .scene_hash = scene_hash_,
                     .interactive = job_.interactive,
                     .hybrid = is_hybrid(job_.scene)};
  std::ranges::copy(job_.center, watched.center);
  board_.show_view(view_);
  feed_.begin_view(view_);
  board_.describe(std::move(watched));
  if (!job_.tev.empty()) tev_.emplace(board_, job_.tev);
  return {};
}

void RenderRun::tell_how_to_watch() {
  notices_.push_back(fmt::format("to watch: penumbra-view --connect {}", shell_quoted(socket_->address())));
  if (server_->more_address().empty()) return;
  const Tokens& tokens = server_->tokens();
  const auto line = [&](const char* what_for, const std::string& token, const char* program) {
    return fmt::format("{}: {}{} --connect {}", what_for,
                       token.empty() ? "" : fmt::format("{}={} ", kTokenVariable, shell_quoted(token)),
                       program, shell_quoted(server_->more_address()));
  };
  notices_.push_back(line("to watch", tokens.watch, "penumbra-view"));
  if (!tokens.work.empty()) notices_.push_back(line("to help render", tokens.work, "penumbra-worker"));
}

Expected<RenderOutcome> RenderRun::run() {
  if (const Expected<void> started = start(); !started) return std::unexpected(started.error());

  while (!is_done() && !stop_ && can_go_on()) {
    std::chrono::milliseconds patience = kTickInterval;
    while (std::optional<Arrival> arrival = server_->next(patience)) {
      advance_clock();
      std::visit([this](auto& a) { on(a); }, *arrival);
      if (is_done() || stop_ || plan_.gave_up() || now_ - last_tick_ > kProgressInterval) break;
      patience = {};
    }
    advance_clock();
    tick();
    look_after_workers();
    if (tev_)
      if (std::optional<std::string> text = tev_->take_problem()) problem(std::move(*text));
    feed_.publish(merge_.film(), job_.interactive);
    report_progress();
  }
  next_progress_ = next_shown_ = 0;
  report_progress();
  workers_here_->stop_all();
  feed_.publish(merge_.film(), true);
  // An interactive render is never known to be complete: its viewers wait for another scheduler.
  show_progress(!job_.interactive);
  board_.close();
  board_.wait_for_watchers(kPatienceWithWatchers);
  if (tev_) {
    tev_->stop();
    if (std::optional<std::string> text = tev_->take_problem()) problem(std::move(*text));
  }
  server_.reset();

  const bool anyone_was_ready = std::ranges::any_of(workers_, [](const auto& w) { return w.second.ready; });
  if (!anyone_was_ready && !stop_) {
    std::string reasons;
    for (const std::string& text : problems_) reasons += "\n  " + text;
    return fail("no worker could be started:" + reasons);
  }
  return std::move(*this).outcome();
}

// --- Processes and time

void RenderRun::look_after_workers() {
  const Seconds now = since_start();
  for (const auto& [id, worker] : workers_) {
    if (worker.gone && !worker.ended && now - worker.gone_since > kTimeToDie) workers_here_->kill(worker.pid);
  }
  // By the plan's time: neither may a pause of this process look like one of a worker that starts.
  for (const WorkerEnd& end : workers_here_->look_after(plan_time_)) worker_ended(end);
  workers_here_->start_missing(plan_time_);
  tell_start_problems();
}

void RenderRun::tell_start_problems() {
  for (std::string& text : workers_here_->take_problems()) problem(std::move(text));
  for (std::string& text : workers_here_->take_notices()) notice(std::move(text));
}

void RenderRun::worker_ended(const WorkerEnd& end) {
  const auto found = std::ranges::find_if(
      workers_, [&](const auto& w) { return w.second.pid == end.exit.pid && !w.second.ended; });
  if (found == workers_.end()) {
    problem(fmt::format("a worker ended before it was connected: {}", end.exit.how));
    return;
  }
  Worker& worker = found->second;
  worker.ended = true;
  if (worker.dismissed) return;  // said already
  worker.share.ended = end.exit.how;
  // The end of its process may be known before that of its stream.
  const std::optional<UnitId> last_unit = worker.gone ? worker.last_unit : plan_.in_hand(found->first);
  const std::string where = last_unit ? " at " + unit_text(unit(*last_unit)) : "";
  problem(fmt::format("worker {} was lost{}: {}", worker.share.name, where, end.exit.how));
}

void RenderRun::advance_clock() {
  const Seconds now = since_start();
  plan_time_ += std::min(now - now_, kLongestTick);
  if (!plan_.finished()) active_ += now - now_;
  now_ = now;
}

void RenderRun::tick() {
  last_tick_ = now_;
  if (job_.time_budget && !budget_spent_ && now_ > *job_.time_budget) {
    budget_spent_ = true;
    tell_plan(NoFurtherPasses{});
  }
  tell_plan(Tick{});
}

void RenderRun::report_progress() {
  const Seconds now = since_start();
  const bool watched = board_.is_watched();
  if ((on_progress_ || watched) && now >= next_progress_) {
    relative_error_ = merge_.film().relative_error();
    const Seconds cost = since_start() - now;
    next_progress_ = now + std::max(kProgressInterval, cost / kProgressShare);
    if (on_progress_)
      on_progress_({.samples_done = samples_done_,
                    .samples_total = grid_.samples(plan_.passes(0)),
                    .elapsed_seconds = now,
                    .relative_error = relative_error_,
                    .workers = int(std::ranges::count_if(
                        workers_, [](const auto& w) { return w.second.ready && !w.second.gone; })),
                    .notices = std::exchange(notices_, {})});
  }
  if (watched && now >= next_shown_) {
    next_shown_ = now + kShowInterval;
    show_progress(false);
  }
}

void RenderRun::show_progress(bool ended) {
  WatchProgress progress{.view = view_.number,
                         .samples_done = samples_done_,
                         .samples_wanted = grid_.samples(plan_.passes(0)),
                         .spp_done = spp_of(merge_.finished_passes()),
                         .spp_wanted = spp_of(plan_.passes(0)),
                         .elapsed_seconds = active_,
                         .relative_error = relative_error_,
                         .finished = plan_.finished(),
                         .ended = ended,
                         .workers = {}};
  for (const auto& [id, worker] : workers_) {
    if (!worker.ready || worker.gone) continue;
    const std::optional<UnitId> in_hand = plan_.in_hand(id);
    const RenderUnit area = in_hand ? unit(*in_hand) : RenderUnit{};
    progress.workers.push_back({.number = id,
                                .name = worker.share.name,
                                .device = worker.share.device,
                                .units = worker.share.units,
                                .x = area.x,
                                .y = area.y,
                                .width = area.width,
                                .height = area.height});
  }
  board_.show_progress(std::move(progress));
}

void RenderRun::problem(std::string text) {
  board_.say("warning: " + text);
  problems_.push_back(std::move(text));
}

void RenderRun::notice(std::string text) {
  board_.say(text);
  notices_.push_back(std::move(text));
}

RenderOutcome RenderRun::outcome() && {
  RenderOutcome outcome;
  outcome.complete = plan_.finished() && plan_.set_aside().empty();
  outcome.problems = std::move(problems_);
  for (const auto& [id, worker] : workers_) outcome.workers.push_back(worker.share);
  outcome.units_done = plan_.units_done();
  outcome.units_duplicated = plan_.units_duplicated();
  outcome.units_requeued = plan_.units_requeued();
  outcome.units_set_aside = plan_.set_aside().size();
  outcome.passes_finished = merge_.finished_passes();
  outcome.passes_total = grid_.passes();
  outcome.film = std::move(merge_).take_film();
  outcome.seconds_to_ready = ready_;
  outcome.seconds_to_first_tile = first_tile_;
  outcome.seconds_to_last_tile = last_tile_;
  outcome.seconds = since_start();
  return outcome;
}

}  // namespace penumbra
