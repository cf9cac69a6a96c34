#include "scheduler/farm/farm_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <ctime>
#include <utility>

#include "scheduler/farm/render_job_check.h"
#include "scheduler/files/quoting.h"
#include "worker/keys/address_file.h"
#include "worker/keys/client_access.h"
#include "worker/protocol/wire.h"

namespace penumbra {
namespace {

constexpr std::chrono::milliseconds kTickInterval{20};
// Limits the plan's time step, so that a pause of this process (Ctrl-Z, a suspended machine) does not look
// like silence of the workers.
constexpr Seconds kLongestTick = 1;
constexpr Seconds kWorkersInterval = 0.5, kWaitingInterval = 1;
constexpr std::size_t kMostProblems = 100;  // of the farm, which may run for months
constexpr std::size_t kMostSaid = 10'000;
// How long a job waits for a worker that can render it when the present ones cannot.
constexpr Seconds kTimeForAnotherToJoin = 30;
constexpr std::uint64_t kLeastRoomForResults = std::uint64_t(1) << 30;  // bytes
constexpr Seconds kTimeToEnd = 2;  // from the end of a local worker's stream to the end of its process

}  // namespace

FarmRun::FarmRun(const FarmOptions& options, JobSource& source, const std::atomic<bool>& stop)
    : options_(options), source_(source), stop_(stop), plan_(options.leases) {}

Expected<void> FarmRun::start() {
  Expected<PrivateSocket> socket = PrivateSocket::create();
  if (!socket) return std::unexpected(socket.error());
  socket_.emplace(std::move(*socket));
  Expected<std::unique_ptr<Server>> server =
      Server::listen({.address = socket_->address(),
                      .more = options_.listen,
                      .keys = options_.keys,
                      .watch_token = options_.watch_token,
                      .comes_back = options_.comes_back,
                      .room_for_results = std::max(kLeastRoomForResults, memory_here() / 4),
                      .service = options_.service});
  if (!server) return std::unexpected(server.error());
  server_ = std::move(*server);
  if (!options_.address_file.empty()) {
    const std::string address = reachable_address(server_->more_address(), options_.keys.get());
    if (const auto written = write_address_file(options_.address_file, address); !written)
      return fail("--address-file: " + written.error().message);
  }
  const bool far = !options_.launch.empty() && !options_.listen.empty();
  workers_here_.emplace(worker_command(options_,
                                       far ? reachable_address(server_->more_address(), options_.keys.get())
                                           : socket_->address(),
                                       far && !options_.keys ? server_->tokens().work : ""),
                        options_.workers);
  // Workers start up while the first scene is being packed.
  workers_here_->start_missing(0);
  tell_start_problems();
  if (options_.tells_how_to_watch) tell_how_to_watch();
  source_.job_signal().connect([this] {
    if (!notified_.exchange(true)) server_->wake();
  });
  take_jobs();
  return {};
}

void FarmRun::tell_how_to_watch() {
  if (server_->more_address().empty() || options_.keys)
    source_.notice(fmt::format("to watch: penumbra-view --connect {}", shell_quoted(socket_->address())));
  if (server_->more_address().empty()) return;
  if (options_.keys) {
    // Tokens from keys must not be printed.
    const std::string address = shell_quoted(reachable_address(server_->more_address(), options_.keys.get()));
    const auto line = [&](KeyRole role, const char* command) {
      source_.notice(
          fmt::format("from other hosts: penumbra {} {} --keys FOLDER, a copy of the keys for {} ('{}')",
                      command, address, info(role).who, info(role).folder));
    };
    line(KeyRole::kViewer, "view --connect");
    line(KeyRole::kWorker, "worker --connect");
    if (options_.service) line(KeyRole::kUser, "submit SCENE --to");
    return;
  }
  const Tokens& tokens = server_->tokens();
  const auto line = [&](const char* what_for, const std::string& token, const char* command) {
    return fmt::format("{}: {}{} {}", what_for,
                       token.empty() ? "" : fmt::format("{}={} ", kTokenVariable, shell_quoted(token)),
                       command, shell_quoted(server_->more_address()));
  };
  source_.notice(line("to watch", tokens.watch, "penumbra-view --connect"));
  if (!tokens.work.empty() || options_.service)
    source_.notice(line("to help render", tokens.work, "penumbra-worker --connect"));
  if (options_.service) source_.notice(line("to submit", tokens.submit, "penumbra submit SCENE --to"));
}

Expected<void> FarmRun::run() {
  if (const Expected<void> started = start(); !started) return std::unexpected(started.error());

  while (!is_done() && !stop_ && can_go_on()) {
    take_arrivals();
    advance_clock();
    tick();
    check_leases();
    fail_hopeless_jobs();
    make_changes();
    finish_jobs();
    take_jobs();
    publish();
    for (const auto& [id, job] : jobs_) job->keep_checkpoint();
    report_progress();
  }
  const bool could_go_on = can_go_on();
  report_progress();
  server_->stop_taking();
  source_.job_signal().connect({});
  if (workers_here_->launches()) dismiss_all();
  workers_here_->stop_all();
  std::string reasons;
  for (const std::string& text : problems_) reasons += "\n  " + text;
  const bool never_began = !anyone_was_ready_ && !stop_ && !is_done();
  if (never_began) {
    while (!jobs_.empty()) {
      const JobId id = jobs_.begin()->first;
      take_out(id);
      source_.done(id, fail("no worker could be started:" + reasons));
    }
  }
  end_all_jobs();
  for (const auto& board : closed_boards_) board->wait_for_watchers(kPatienceWithWatchers);
  if (stop_ && !options_.address_file.empty()) server_->will_come_back();
  server_.reset();
  if (never_began) return fail("no worker could be started:" + reasons);
  if (!stop_ && !could_go_on && !source_.is_exhausted()) return fail("no worker is left:" + reasons);
  return {};
}

/// Handles events until the next tick is due, a job is over, or the source has news. Reacting to those takes
/// longer than an event.
void FarmRun::take_arrivals() {
  const Clock::time_point next_tick = Clock::now() + kTickInterval;
  const std::size_t open_jobs = jobs_.size();
  while (jobs_.size() == open_jobs && !stop_ && !plan_.gave_up()) {
    std::optional<Arrival> arrival = server_->next(std::chrono::milliseconds(0));
    if (!arrival) {
      publish();  // at once, for viewers that steer the camera
      arrival =
          server_->next(std::max(std::chrono::milliseconds(0),
                                 std::chrono::ceil<std::chrono::milliseconds>(next_tick - Clock::now())));
    }
    if (arrival) {
      advance_clock();
      std::visit([this](auto& a) { on(a); }, *arrival);
      if (std::holds_alternative<arrivals::JobsNotified>(*arrival)) return;
      finish_jobs();
    }
    if (Clock::now() >= next_tick) return;
  }
}

// --- Jobs

JobRun* FarmRun::job(JobId id) {
  const auto found = jobs_.find(id);
  return found == jobs_.end() ? nullptr : found->second.get();
}

RenderUnit FarmRun::unit(const UnitId& id) {
  const JobRun* of = job(id.job);
  return of == nullptr ? RenderUnit{} : of->unit(id);
}

std::string FarmRun::detail(const UnitId& id) {
  JobRun* of = job(id.job);
  return of == nullptr ? "" : of->detail(id);
}

void FarmRun::take_jobs() {
  while (int(jobs_.size()) < options_.open_jobs) {
    std::shared_ptr<const RenderJob> next = source_.next();
    if (!next) return;
    const JobId id = next->number.value_or(next_job_);
    next_job_ = std::max(next_job_, id + 1);
    source_.took(id);
    JobRun& taken = *jobs_
                         .emplace(id, std::make_unique<JobRun>(id, std::move(next), since_start(),
                                                               jobs_.empty() && !options_.service))
                         .first->second;
    for (std::string& text : std::exchange(unsaid_problems_, {})) taken.problem(std::move(text));
    taken.open(*server_);
    source_.shown(id, taken.board());
    tell_plan(JobAdded{id, taken.job().priority, taken.phases(), taken.job().request.verify,
                       taken.job().submitter});
    for (const PassesOfTile& passes : taken.passes_of_tiles()) tell_plan(passes);
  }
}

void FarmRun::make_changes() {
  for (const JobChange& change : source_.changes()) {
    if (const auto* cancelled = std::get_if<CancelJob>(&change); cancelled && job(cancelled->job))
      end_job(cancelled->job);
    if (const auto* priority = std::get_if<PriorityChanged>(&change); priority && job(priority->job))
      tell_plan(*priority);
  }
}

/// Finishes jobs of which every unit is merged or set aside. An interactive job waits for its viewers' next
/// request.
void FarmRun::finish_jobs() {
  std::vector<JobId> finished;
  for (const auto& [id, job] : jobs_)
    if (!job->job().interactive && plan_.finished(id)) finished.push_back(id);
  for (const JobId id : finished) end_job(id);
}

/// Removes a job; its viewers see its end.
std::unique_ptr<JobRun> FarmRun::take_out(JobId id) {
  const std::vector<WatchedWorker> workers = watched_workers();
  std::unique_ptr<JobRun> ended = std::move(jobs_.extract(id).mapped());
  source_.progress(id, ended->progress(plan_, ready_workers(), since_start()));
  ended->close(*server_, plan_, workers);
  std::erase_if(closed_boards_, [](const auto& board) { return !board->is_watched(); });
  if (ended->board()->is_watched()) closed_boards_.push_back(ended->board());
  return ended;
}

void FarmRun::end_job(JobId id) {
  const std::unique_ptr<JobRun> ended = take_out(id);
  // Either of the disagreeing workers may have contributed wrong results to it.
  if (plan_.gave_up())
    ended->discard_checkpoint();
  else if (!plan_.finished(id) || !plan_.set_aside(id).empty())
    ended->keep_last_checkpoint();
  RenderOutcome outcome = std::move(*ended).outcome(plan_, since_start());
  unrenderable_jobs_.erase(id);
  crashing_jobs_.erase(id);
  job_failures_.erase(id);
  tell_plan(JobRemoved{id});
  source_.done(id, std::move(outcome));
}

void FarmRun::end_all_jobs() {
  while (!jobs_.empty()) end_job(jobs_.begin()->first);
}

/// Fails jobs that no worker can render, unless workers that are still starting may be able to.
void FarmRun::fail_hopeless_jobs() {
  if (crashing_jobs_.empty() && unrenderable_jobs_.empty()) return;
  const auto connected = std::ranges::count_if(here_, [&](WorkerId id) {
    const Worker& worker = workers_.at(id);
    return !worker.gone && !worker.ended;
  });
  std::set<JobId> failed;
  // The counts of failures restart only when the ends of all those processes are known.
  if (!crashing_jobs_.empty() && !is_an_end_half_known()) {
    failed = std::exchange(crashing_jobs_, {});
    workers_here_->has_worked();
    workers_here_->start_missing(plan_time_);
  }
  // It is unknown how many workers a launcher starts, or will join a service, and when.
  const bool others_may_join = workers_here_->launches() || options_.service;
  const bool are_all_here = others_may_join
                                ? now_ - std::max(last_joined_, hopeless_since_) > kTimeForAnotherToJoin
                                : connected >= std::ptrdiff_t(workers_here_->running());
  if (are_all_here) failed.merge(unrenderable_jobs_);
  for (const JobId id : failed) fail_job(id);
}

/// No worker can render the job or continue it. Its results are kept in the checkpoint, from which native
/// code may resume.
void FarmRun::fail_job(JobId id) {
  std::string reasons = "no worker can do this job:";
  for (const std::string& text : job_failures_[id]) reasons += "\n  " + text;
  const JobRun& failed = *jobs_.at(id);
  if (failed.samples_done() > 0 && failed.job().device.backend != Backend::kAuto) {
    jobs_.at(id)->problem(reasons);
    return end_job(id);
  }
  unrenderable_jobs_.erase(id);
  crashing_jobs_.erase(id);
  job_failures_.erase(id);
  take_out(id)->keep_last_checkpoint();
  tell_plan(JobRemoved{id});
  source_.done(id, fail(reasons));
}

// --- Processes and time

bool FarmRun::is_an_end_half_known() const {
  return std::ranges::any_of(here_, [&](WorkerId id) {
    const Worker& worker = workers_.at(id);
    if (worker.gone == worker.ended) return false;
    return now_ - (worker.gone ? worker.gone_since : worker.ended_since) < 2 * kTimeToEnd;
  });
}

void FarmRun::check_leases() {
  const Seconds now = since_start();
  for (const WorkerId id : here_) {
    const Worker& worker = workers_.at(id);
    if (worker.gone && !worker.ended && now - worker.gone_since > kTimeToEnd) workers_here_->kill(worker.pid);
  }
  // Uses the plan's time, so that a pause of this process does not look like one of a starting worker.
  for (const ChildExit& exit : workers_here_->look_after(plan_time_)) worker_ended(exit);
  workers_here_->start_missing(plan_time_);
  tell_start_problems();
}

/// Forgets old workers, because a farm that runs for months meets any number of them. What open jobs report
/// about theirs is kept.
void FarmRun::forget_gone_workers() {
  std::erase_if(workers_, [&](const auto& entry) {
    const Worker& worker = entry.second;
    const bool is_over = worker.gone && (worker.pid == 0 || worker.ended);
    return is_over &&
           std::ranges::none_of(jobs_, [&](const auto& job) { return job.second->has_share(entry.first); });
  });
  std::erase_if(here_, [&](WorkerId id) { return !workers_.contains(id); });
  if (said_.size() > kMostSaid) said_.clear();  // then a notice may be shown twice
}

void FarmRun::tell_start_problems() {
  for (const std::string& text : workers_here_->take_problems()) problem(text);
  for (const std::string& text : workers_here_->take_notices()) notice(text);
}

void FarmRun::dismiss_all() {
  for (const auto& [id, worker] : workers_)
    if (!worker.dismissed && !worker.gone) server_->dismiss(id, "the render is over");
}

void FarmRun::worker_ended(const ChildExit& exit) {
  if (workers_here_->launches()) return problem(fmt::format("the launcher of workers ended: {}", exit.how));
  const auto found = std::ranges::find_if(
      workers_, [&](const auto& w) { return w.second.pid == exit.pid && !w.second.ended; });
  if (found == workers_.end()) {
    problem(fmt::format("a worker ended before it was connected: {}", exit.how));
    return;
  }
  Worker& worker = found->second;
  worker.ended = true;
  worker.ended_since = now_;
  if (worker.dismissed || worker.has_left) return;  // reported already
  for (const auto& [id, job] : jobs_)
    if (job->has_share(found->first)) job->share(found->first).ended = exit.how;
  // The end of a process may be known before the end of its stream.
  const std::optional<UnitId> last_unit = worker.gone ? worker.last_unit : plan_.in_hand(found->first);
  const std::string where = last_unit ? " at " + unit_text(unit(*last_unit)) : "";
  problem(fmt::format("worker {} was lost{}: {}", worker.name, where, exit.how));
}

void FarmRun::advance_clock() {
  const Seconds now = since_start();
  plan_time_ += std::min(now - now_, kLongestTick);
  for (const auto& [id, job] : jobs_) job->advance(now - now_, !plan_.finished(id));
  now_ = now;
}

void FarmRun::tick() {
  const Seconds since_last = now_ - std::exchange(last_tick_, now_);
  for (const auto& [id, job] : jobs_) {
    // Beside other jobs, or without workers, a job may wait for a long time.
    const bool is_alone = jobs_.size() == 1 && !options_.service;
    if (is_alone || plan_.is_in_hand(id)) job->was_rendered_for(since_last);
    if (job->budget_is_spent()) tell_plan(NoFurtherUnits{id});
  }
  tell_plan(Tick{});
  tell_if_workers_wait();
}

/// Once, for the job whose result came last.
void FarmRun::tell_if_workers_wait() {
  if (waiting_was_told_ || now_ < next_waiting_) return;
  next_waiting_ = now_ + kWaitingInterval;
  const JobRun* of = job(last_result_of_);
  const int workers = ready_workers();
  totals_.cpu = double(std::clock()) / CLOCKS_PER_SEC;
  const bool has_enough = of != nullptr && !of->job().interactive &&
                          plan_.units_left() > kUnitsPerWorker * std::uint64_t(workers);
  const auto measured = waiting_share_.measure(now_, workers, has_enough, totals_);
  if (!measured || measured->waiting < kMuchWaiting) return;
  waiting_was_told_ = true;
  // With photon maps, the samples of a pass share one, so fewer passes are another image.
  const RenderJob& settings = of->job();
  const std::uint32_t pass = settings.request.plan.samples_per_pass;
  const bool has_maps = settings.scene.header.integrator.photons == PHOTONS_PROGRESSIVE;
  const std::uint32_t more = has_maps ? 0 : std::min({4 * pass, settings.spp, kMaxSamplesPerUnit});
  notice(waiting_text(*measured, pass, more));
}

void FarmRun::publish() {
  for (const auto& [id, job] : jobs_) job->publish();
}

void FarmRun::report_progress() {
  std::optional<std::vector<WatchedWorker>> workers;  // computed on demand
  for (const auto& [id, job] : jobs_) {
    if (job->is_progress_due(since_start()))
      source_.progress(id, job->progress(plan_, ready_workers(), since_start()));
    if (!job->board()->is_watched()) continue;
    if (!workers) workers = watched_workers();
    job->show_progress(plan_, *workers, since_start());
  }
  if (source_.wants_workers() && since_start() >= next_workers_) {
    next_workers_ = since_start() + kWorkersInterval;
    source_.workers(farm_workers());
    forget_gone_workers();
  }
}

std::vector<FarmWorker> FarmRun::farm_workers() {
  std::vector<FarmWorker> present;
  for (const auto& [id, worker] : workers_) {
    if (worker.gone || worker.dismissed) continue;
    const std::optional<UnitId> in_hand = plan_.in_hand(id);
    present.push_back({.id = id,
                       .name = worker.name,
                       .device = worker.device,
                       .units = worker.units,
                       .samples = worker.samples,
                       .busy_seconds = worker.busy_seconds,
                       .since = since_start() - worker.since,
                       .job = in_hand ? std::optional(in_hand->job) : std::nullopt});
  }
  return present;
}

int FarmRun::ready_workers() const {
  return int(std::ranges::count_if(workers_, [](const auto& w) { return w.second.ready && !w.second.gone; }));
}

std::vector<WatchedWorker> FarmRun::watched_workers() {
  std::vector<WatchedWorker> watched;
  for (const auto& [id, worker] : workers_) {
    if (!worker.ready || worker.gone) continue;
    const std::optional<UnitId> in_hand = plan_.in_hand(id);
    const RenderUnit area = in_hand ? unit(*in_hand) : RenderUnit{};
    watched.push_back({.number = id,
                       .name = worker.name,
                       .device = {},
                       .units = 0,
                       .job = in_hand ? in_hand->job : 0,
                       .x = area.x,
                       .y = area.y,
                       .width = area.width,
                       .height = area.height});
  }
  return watched;
}

void FarmRun::problem(const std::string& text) {
  problems_.push_back(text);
  if (problems_.size() > kMostProblems) problems_.erase(problems_.begin());
  if (jobs_.empty()) unsaid_problems_.push_back(text);
  for (const auto& [id, job] : jobs_) job->problem(text);
}

void FarmRun::notice(const std::string& text) {
  for (const auto& [id, job] : jobs_) job->board()->say(text);
  source_.notice(text);
}

}  // namespace penumbra
