#include "scheduler/cli/service/service_run.h"

#include <fmt/format.h>

#include <algorithm>
#include <map>
#include <memory>
#include <optional>
#include <thread>
#include <utility>
#include <vector>

#include "kernels/host/console.h"
#include "kernels/host/parallel.h"
#include "kernels/host/text.h"
#include "scheduler/cli/service/submitted_render.h"
#include "scheduler/farm/access.h"
#include "scheduler/farm/job_run.h"
#include "scheduler/files/program_path.h"
#include "scheduler/record/film_image.h"
#include "scheduler/run/progress.h"
#include "scheduler/run/render_checkpoint.h"
#include "scheduler/run/render_outputs.h"
#include "scheduler/service/end_hook.h"
#include "scheduler/service/job_queue.h"
#include "scheduler/service/jobs_service.h"
#include "scheduler/service/status_text.h"
#include "scheduler/sets/shot_denoising.h"
#include "scheduler/web/service_page.h"
#include "scheduler/web/web_page.h"
#include "worker/protocol/mailbox.h"

namespace penumbra {
namespace {

// Between looks whether the frames are there that others are denoised with.
constexpr std::chrono::milliseconds kBetweenLooks{100};
// The number of jobs whose scenes and films are in memory: the current one and the next, and a few more with
// higher priority.
constexpr int kOpenJobs = 2, kMostOpenJobs = 4;

wire::JobState state_of(RenderEndKind kind) {
  switch (kind) {
    case RenderEndKind::kIncomplete:
      return wire::JOB_INCOMPLETE;
    case RenderEndKind::kFailed:
      return wire::JOB_FAILED;
    case RenderEndKind::kDone:
      break;
  }
  return wire::JOB_DONE;
}

/// The outcome of a job that was cancelled before this service began it: what an earlier service has
/// rendered.
RenderOutcome outcome_of_checkpoint(const RenderJob& job) {
  RenderOutcome outcome;
  Merge merge = job.before ? std::move(job.before->merge) : merge_of_job(job);
  outcome.passes_finished = merge.finished_passes();
  outcome.units_in_order = merge.units_in_order();
  outcome.ended_by_tile = job.request.plan.adaptive && merge.is_done();
  outcome.shares_missing = job.request.plan.adaptive && !(merge.is_done() && merge.is_undisturbed());
  outcome.samples_before = merge.samples();
  outcome.seconds_before = job.before ? job.before->rendered : 0;
  outcome.film = std::move(merge).take_film();
  return outcome;
}

struct OpenJob {
  JobId id = 0;
  std::shared_ptr<PreparedRender> prepared;
  std::string name;
  std::vector<std::string> command_line;
  std::optional<int> frame = {};  ///< if it is denoised with the frames beside it
};
/// A job of which all but the denoised images is written, or all.
struct WrittenJob {
  JobId id = 0;
  std::string name;
  OutputFiles files;
  Film film;
  std::shared_ptr<CheckpointFile> checkpoint;
  int frame = 0;
  RenderEnd end;
  bool was_cancelled = false, has_samples = false;
};
struct FinishedJob {
  OpenJob job;
  Expected<RenderOutcome> outcome;
};

/// Four threads: one reads scenes, one drives the farm, one writes images, one looks after jobs that are
/// over.
class ServiceRun final : public JobSource {
 public:
  ServiceRun(const ServiceOptions& options, Spool& spool, JobQueue& queue, std::string worker,
             const std::atomic<bool>& stop)
      : options_(options), spool_(spool), queue_(queue), worker_(std::move(worker)), stop_(stop) {}

  ExitCode run(const std::string& worker_executable, std::shared_ptr<const Keys> keys, const WebPage& page);

  // --- Called from the farm's thread
  std::shared_ptr<const RenderJob> next() override;
  bool is_exhausted() override { return false; }
  void took(JobId id) override { open_[id] = *std::exchange(taken_, {}); }
  void shown(JobId id, const std::shared_ptr<WatchBoard>& board) override {
    if (page_) page_->pictures().films().add(id, board);
  }
  void progress(JobId id, const RenderProgress& progress) override;
  [[nodiscard]] bool wants_workers() const override { return true; }
  void workers(const std::vector<FarmWorker>& workers) override { queue_.workers(workers); }
  [[nodiscard]] std::vector<JobChange> changes() override { return queue_.take_changes(); }
  void notice(const std::string& text) override {
    print_message(text);
    if (!tells_tokens_) queue_.say(text);
  }
  void done(JobId id, Expected<RenderOutcome> outcome) override;

 private:
  void read_scenes();
  Expected<OpenJob> read_scene(const JobQueue::Taken& taken);
  void write_images();
  void write(FinishedJob finished);
  /// Denoises the frames for which those beside them are there.
  void denoise_frames();
  void end(WrittenJob job);
  void look_after_ends();

  const ServiceOptions& options_;
  Spool& spool_;
  JobQueue& queue_;
  const std::string worker_;  // hash of the worker's executable
  const std::atomic<bool>& stop_;
  std::atomic<bool> is_over_ = false;
  // The first notices contain tokens, which must not be shown to everyone who may ask for the status.
  bool tells_tokens_ = true;

  Mailbox<OpenJob> ready_;
  Mailbox<FinishedJob> finished_;
  std::optional<OpenJob> taken_;
  std::map<JobId, OpenJob> open_;
  std::optional<ServicePage> page_;
  std::vector<OpenJob> again_;  // jobs to be rendered again because the automatically chosen device failed
  std::vector<WrittenJob> frames_;  // that wait for those beside them; used by the thread that writes images
  // Incomplete jobs. Whether the job or the whole farm has ended is known only when the farm goes on.
  std::vector<FinishedJob> unfinished_;
};

// --- The thread that reads scenes

void ServiceRun::read_scenes() {
  while (const auto taken = queue_.take(kOpenJobs, kMostOpenJobs)) {
    Expected<OpenJob> job = fail("");
    try {
      job = read_scene(*taken);
    } catch (const std::exception& error) {  // usually out of memory; other jobs may need less
      job = fail(error.what());
    }
    if (job) {
      ready_.put(std::move(*job));
      job_signal().notify();
    } else {
      print_error({fmt::format("job {}, {}: {}", taken->job, taken->submission.name, job.error().message)});
      queue_.end(taken->job, wire::JOB_FAILED, job.error().message);
    }
  }
}

Expected<OpenJob> ServiceRun::read_scene(const JobQueue::Taken& taken) {
  const Submission& submission = taken.submission;
  auto scene = spool_.read_scene(submission.scene);
  if (!scene) return std::unexpected(scene.error());
  auto prepared = prepared_of(submission, std::move(*scene), spool_.folder_of(taken.job), options_.threads,
                              options_.workers);
  if (!prepared) return std::unexpected(prepared.error());
  prepared->job.number = taken.job;
  RenderOptions keeping;
  keeping.resume = true;
  keeping.checkpoint_interval = options_.checkpoint_interval;
  if (const auto attached = attach_checkpoint(*prepared, keeping, worker_); !attached) {
    queue_.problem(taken.job, attached.error().message);  // of another version of this program, or damaged
    print_warning(fmt::format("job {}: {}", taken.job, attached.error().message));
  } else if (prepared->job.before) {
    print_message(fmt::format("job {}: {}", taken.job, *attached));
  }
  prepared->is_denoised_later = submission.beside.has_value();
  return OpenJob{taken.job, std::make_shared<PreparedRender>(std::move(*prepared)), submission.name,
                 submission.command_line, submission.beside ? submission.frame : std::nullopt};
}

// --- The thread that drives the farm

std::shared_ptr<const RenderJob> ServiceRun::next() {
  tells_tokens_ = false;
  for (FinishedJob& finished : std::exchange(unfinished_, {})) finished_.put(std::move(finished));
  for (;;) {
    if (!again_.empty()) {
      taken_ = std::move(again_.back());
      again_.pop_back();
    } else {
      taken_ = ready_.take(std::chrono::milliseconds(0));
    }
    if (!taken_) return nullptr;
    if (queue_.open(taken_->id)) return {taken_->prepared, &taken_->prepared->job};
    RenderOutcome outcome = outcome_of_checkpoint(taken_->prepared->job);
    finished_.put({*std::exchange(taken_, {}), std::move(outcome)});
  }
}

void ServiceRun::progress(JobId id, const RenderProgress& progress) {
  queue_.progress(id, progress);
  for (const std::string& notice : progress.notices) print_message(fmt::format("job {}: {}", id, notice));
}

void ServiceRun::done(JobId id, Expected<RenderOutcome> outcome) {
  OpenJob job = std::move(open_.extract(id).mapped());
  if (!outcome && job.prepared->job.device.backend == Backend::kAuto && !stop_) {
    const std::string why = "native code renders: " + outcome.error().message;
    print_warning(fmt::format("job {}: {}", id, why));
    queue_.problem(id, why);
    if (const auto can_go_on = fall_back_to_native(*job.prepared); can_go_on)
      return again_.push_back(std::move(job));
    else
      outcome = std::unexpected(can_go_on.error());
  }
  const bool complete = outcome && outcome->complete;
  (complete ? finished_.put({std::move(job), std::move(outcome)})
            : void(unfinished_.push_back({std::move(job), std::move(outcome)})));
}

// --- The thread that writes images

void ServiceRun::write_images() {
  for (;;) {
    std::optional<FinishedJob> finished = frames_.empty() ? finished_.take() : finished_.take(kBetweenLooks);
    if (!finished && (frames_.empty() || is_over_)) return;
    if (finished) write(std::move(*finished));
    if (!is_over_) denoise_frames();
  }
}

void ServiceRun::write(FinishedJob finished) {
  const OpenJob& job = finished.job;
  const bool was_cancelled = queue_.begin_writing(job.id);
  RenderEnd end{RenderEndKind::kFailed, finished.outcome ? "" : finished.outcome.error().message};
  // A job that was cancelled before its first sample leaves no files; that is not a failure.
  const bool has_samples = finished.outcome && sample_range(finished.outcome->film).total > 0;
  const Film film = job.prepared->record.film;  // the record is consumed
  try {
    if (has_samples || (finished.outcome && !was_cancelled)) {
      for (const std::string& problem : finished.outcome->problems) queue_.problem(job.id, problem);
      end = finish_render(*job.prepared, *finished.outcome, job.command_line, fmt::format("job {}", job.id),
                          was_cancelled ? StoppedBy::kCancel
                          : stop_       ? StoppedBy::kSignal
                                        : StoppedBy::kNothing);
    }
  } catch (const std::exception& error) {
    end = {RenderEndKind::kFailed, error.what()};
  }
  WrittenJob written{.id = job.id,
                     .name = job.name,
                     .files = job.prepared->files,
                     .film = film,
                     .checkpoint = job.prepared->checkpoint,
                     .frame = job.frame.value_or(0),
                     .end = std::move(end),
                     .was_cancelled = was_cancelled,
                     .has_samples = has_samples};
  if (job.frame && has_samples && finished.outcome->complete && written.end.kind != RenderEndKind::kFailed) {
    queue_.await_frames(job.id);
    return frames_.push_back(std::move(written));
  }
  this->end(std::move(written));
}

void ServiceRun::denoise_frames() {
  for (WrittenJob& job : std::exchange(frames_, {})) {
    const auto beside = queue_.frames_beside(job.id);
    if (!beside) {
      frames_.push_back(std::move(job));
      continue;
    }
    try {
      std::vector<NoisyFrame> frames;
      for (const auto& [frame, exr] : *beside) frames.push_back({frame, exr, {}});
      const auto place = std::ranges::lower_bound(frames, job.frame, {}, &NoisyFrame::number);
      const auto index = std::size_t(place - frames.begin());
      frames.insert(
          place, {job.frame, *job.files.exr, *job.files.denoised_exr, job.files.denoised_png.value_or("")});
      ShotDenoiser denoiser(std::move(frames), denoise_options(job.film), kMostTimeRadius);
      if (const auto done = write_denoised_frame(denoiser.denoise(index), job.film, job.files); !done)
        job.end = {RenderEndKind::kFailed, done.error().message};
    } catch (const std::exception& error) {  // usually out of memory
      job.end = {RenderEndKind::kFailed, error.what()};
    }
    end(std::move(job));
  }
}

void ServiceRun::end(WrittenJob job) {
  wire::JobState state = state_of(job.end.kind);
  // Its files could not be written.
  const bool is_lost = job.has_samples && job.end.kind == RenderEndKind::kFailed;
  std::string error = std::move(job.end.error);
  if (job.was_cancelled && state != wire::JOB_DONE && !is_lost) {
    state = wire::JOB_CANCELLED;
    error = job.has_samples ? "what was rendered before is kept" : "nothing was rendered before";
  }
  print_message(fmt::format("job {}, {}: {}{}{}", job.id, job.name, job_state_name(state),
                            error.empty() ? "" : ": ", error));
  queue_.end(job.id, state, error);
  if (page_) page_->pictures().films().remove(job.id);
  // Only after the job's end is on disk; until then the checkpoint could be needed.
  // Jobs that are not done keep it for `penumbra retry`.
  if (state == wire::JOB_DONE && job.checkpoint) job.checkpoint->remove();
}

// --- The thread that looks after jobs that are over

void ServiceRun::look_after_ends() {
  const auto hook = EndHook::make(options_.on_done);
  if (!hook) return;  // checked before
  while (!is_over_) {
    if (options_.keep)
      for (const JobId removed : queue_.remove_older_than(*options_.keep))
        print_message(fmt::format("job {} has been over for long and is removed (--keep)", removed));
    const auto ended = queue_.wait_for_end();
    if (!ended) continue;
    if (const auto called = hook->call(*ended, is_over_); !called) {
      print_warning(called.error().message);
      queue_.say(called.error().message);
      if (is_over_) continue;  // the next service calls it again
    }
    queue_.told(*ended);
  }
}

// --- Running all threads

ExitCode ServiceRun::run(const std::string& worker_executable, std::shared_ptr<const Keys> keys,
                         const WebPage& page) {
  std::unique_ptr<WebServer> server;
  std::string token;
  if (!page.address.empty()) {
    const auto kept = spool_.watch_token();
    if (!kept) return print_error(kept.error()), kIncomplete;
    token = *kept;
    page_.emplace(queue_);
    auto opened = open_web_page(page, token, true, *page_);
    if (!opened) return print_error(opened.error()), kIncomplete;
    server = std::move(*opened);
    print_message(web_page_notice(*server, page));
  }
  FarmOptions farm{.workers = options_.workers,
                   .worker_executable = worker_executable,
                   .listen = options_.listen,
                   .keys = std::move(keys),
                   .comes_back = true,
                   .watch_token = token,
                   .tells_how_to_watch = true,
                   .open_jobs = kMostOpenJobs,
                   .service = [this](std::function<void(const std::string&)> on_call) {
                     return make_jobs_service(queue_, spool_, std::move(on_call));
                   }};
  std::thread reader([this] { read_scenes(); });
  std::thread writer([this] { write_images(); });
  std::thread caretaker([this] { look_after_ends(); });
  const Expected<void> ran = run_farm(farm, *this, stop_);
  is_over_ = true;
  queue_.close();
  caretaker.join();
  reader.join();
  finished_.close();
  writer.join();
  for (const FinishedJob& left : unfinished_) queue_.put_back(left.job.id);
  for (const WrittenJob& left : frames_) queue_.put_back(left.id);
  while (const auto never_opened = ready_.take(std::chrono::milliseconds(0)))
    queue_.put_back(never_opened->id);
  if (!ran) return print_error(ran.error()), kIncomplete;
  return stop_ ? kAllDone : kIncomplete;
}

}  // namespace

ExitCode run_service(const ServiceOptions& options, const std::atomic<bool>& stop) {
  const auto worker = find_program("penumbra-worker");
  if (!worker) return print_error(worker.error()), kIncomplete;
  const auto keys = listening_keys(options.listen, options.keys);
  if (!keys) return print_error(keys.error()), kBadInput;
  const auto page = web_page_of(options.web, options.keys);
  if (!page) return print_error(page.error()), kBadInput;
  const auto spool = Spool::open(options.spool);
  if (!spool) return print_error(spool.error()), kBadInput;
  std::vector<std::string> problems;
  JobQueue queue(**spool, problems, !options.on_done.empty());
  for (const std::string& problem : problems) print_warning(problem);
  if (options.own_jobs) queue.own_jobs();
  ServiceOptions with_threads = options;
  if (options.threads == 0)
    with_threads.threads = std::max(1, int(core_count()) / std::max(1, options.workers));
  return ServiceRun(with_threads, **spool, queue, program_hash(*worker), stop)
      .run(worker->string(), *keys, *page);
}

}  // namespace penumbra
