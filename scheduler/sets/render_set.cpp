#include "scheduler/sets/render_set.h"

#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <atomic>
#include <chrono>
#include <cmath>
#include <condition_variable>
#include <functional>
#include <map>
#include <memory>
#include <mutex>
#include <numeric>
#include <optional>
#include <ranges>
#include <set>
#include <thread>

#include "kernels/host/atomic_file.h"
#include "kernels/host/console.h"
#include "kernels/host/content_hash.h"
#include "kernels/host/text.h"
#include "scheduler/farm/access.h"
#include "scheduler/files/output_check.h"
#include "scheduler/files/program_path.h"
#include "scheduler/record/film_image.h"
#include "scheduler/render/frames.h"
#include "scheduler/run/progress.h"
#include "scheduler/run/render_checkpoint.h"
#include "scheduler/run/render_outputs.h"
#include "scheduler/run/render_preparation.h"
#include "scheduler/run/shared_scenes.h"
#include "scheduler/sets/failure_reasons.h"
#include "scheduler/sets/set_plan.h"
#include "scheduler/sets/set_summary.h"
#include "scheduler/sets/shot_denoising.h"
#include "scheduler/sets/shot_pictures.h"
#include "scheduler/sets/shot_video.h"
#include "scheduler/web/render_page.h"
#include "worker/protocol/mailbox.h"

namespace penumbra {
namespace {

using Clock = std::chrono::steady_clock;

constexpr std::size_t kPreparedAhead = 1;  // prepared scenes beside those that the farm has taken
constexpr std::size_t kMostUnwritten = 2;  // images waiting to be written
constexpr std::chrono::milliseconds kBetweenLooks{100};  // at whether the set is to end
// The pause after writing the summary, as a multiple of the time that it took.
constexpr int kSummaryPause = 20;

std::vector<std::string> absolute_names(const OutputFiles& files) {
  std::vector<std::string> names;
  for (const auto& file : files.all())
    names.push_back(std::filesystem::absolute(file).lexically_normal().string());
  return names;
}

/// The hash of everything on which the images depend.
std::string key_of(const PreparedRender& prepared, const std::string& worker) {
  const RenderIdentity identity = identity_of(prepared, worker);
  std::string text = identity_text(identity) + fmt::format("strict={}", prepared.record.strict_numerics);
  if (const auto budget = prepared.record.time_budget) text += fmt::format("\ntime_budget={}", *budget);
  return identity.scene + content_hash(bytes_of(text)).substr(0, 16);
}

wire::JobState job_state_of(SetState state) {
  if (state == SetState::kFailed) return wire::JOB_FAILED;
  if (state == SetState::kNotBegun) return wire::JOB_CANCELLED;
  return state == SetState::kIncomplete ? wire::JOB_INCOMPLETE : wire::JOB_DONE;
}

bool is_rendered(const SetEntry& entry) {
  return entry.state == SetState::kDone || entry.state == SetState::kUnchanged;
}

struct ReadyRender {
  std::size_t index = 0;
  std::shared_ptr<PreparedRender> prepared;
};
struct FinishedRender {
  std::size_t index = 0;
  std::shared_ptr<PreparedRender> prepared;
  RenderOutcome outcome;
};

/// Contact sheets that would replace one of the inputs are not written.
void leave_out_sheets(SetPlan& plan, const std::vector<std::filesystem::path>& inputs) {
  for (SetShot& shot : plan.shots)
    if (!shot.sheet.empty() && is_among(shot.sheet, inputs)) {
      print_warning(
          fmt::format("no contact sheet is written: {} is an input of this command", shot.sheet.string()));
      shot.sheet.clear();
    }
}

/// Three threads: one reads scenes, one drives the farm, one writes images.
class SceneSet final : public JobSource {
 public:
  SceneSet(SetPlan plan, const RenderOptions& options, const std::vector<std::string>& command_line,
           std::filesystem::path ffmpeg, const std::atomic<bool>& stop)
      : plan_(std::move(plan)),
        options_(options),
        command_line_(command_line),
        stop_(stop),
        printer_(progress_style(options.progress, !options.quiet), terminal_columns()),
        ffmpeg_(std::move(ffmpeg)),
        scenes_(scenes_of(plan_)),
        denoising_(plan_, options.time_radius) {
    EarlierRenders finished = EarlierRenders::read(plan_.summary);
    for (std::size_t i = 0; i < plan_.members.size(); ++i) {
      const SetMember& member = plan_.members[i];
      const std::vector<std::string> files = absolute_names(member.files);
      if (std::optional<SetEntry> earlier = finished.take(files))
        entries_.push_back(std::move(*earlier));
      else
        entries_.emplace_back().files = files;
      entries_.back().remade.clear();
      if (denoising_.has(i)) {
        OutputFiles denoised;
        denoised.denoised_exr = member.files.denoised_exr;
        denoised.denoised_png = member.files.denoised_png;
        entries_.back().remade = absolute_names(denoised);
      }
      entries_.back().name = member.name;
      longest_name_ = std::max(longest_name_, member.name.size());
      entries_.back().scene = member.options.scene.file;
      entries_.back().choices = member.choices;
      entries_.back().state = SetState::kWaiting;
      entries_.back().error.clear();
      page_.add(member.name, member.priority, member.options.scene.frame);
    }
    if (std::ranges::any_of(plan_.members,
                            [](const SetMember& member) { return member.options.scene.frame.has_value(); }))
      page_.add_shot(plan_.name);
    keys_.resize(entries_.size());
    for (const SetMember& member : plan_.members)
      may_try_again_.push_back(member.options.scene.frame.has_value());
  }

  ExitCode run();

  // --- Called from the farm's thread
  std::shared_ptr<const RenderJob> next() override;
  bool is_exhausted() override;
  void took(JobId id) override {
    page_.took(taken_->index, id);
    open_[id] = std::move(taken_);
  }
  void shown(JobId id, const std::shared_ptr<WatchBoard>& board) override { page_.shown(id, board); }
  [[nodiscard]] bool wants_workers() const override { return page_.is_open(); }
  void workers(const std::vector<FarmWorker>& workers) override { page_.workers(workers); }
  void progress(JobId id, const RenderProgress& progress) override;
  void notice(const std::string& text) override {
    // The user asked for an address, so its token must be shown.
    if (!options_.quiet || !options_.listen.empty()) print_message(text);
    if (!open_.empty()) page_.say(text);  // the first ones contain tokens
  }
  void done(JobId id, Expected<RenderOutcome> outcome) override;

 private:
  /// The first unread render whose predecessors are all over, and once all renders are, a frame that failed;
  /// waits for one. Removes it from `unread`. Nothing if there is none or the set ends.
  std::optional<std::size_t> next_to_read(std::vector<std::size_t>& unread);
  void read_scenes();
  Expected<void> check_earlier(std::size_t index);
  Expected<void> read_scene(std::size_t index);
  /// Sees to it that no file about the whole set replaces one of these, which a scene reads. Error: it would,
  /// and is not only a contact sheet.
  Expected<void> keep_inputs(const std::vector<std::filesystem::path>& inputs);
  /// Error: a scene reads it.
  [[nodiscard]] Expected<void> may_write(const std::filesystem::path& file) const;
  void fail_member(std::size_t index, const Error& error);
  void write_images();
  void write(FinishedRender finished);
  /// Denoises the frames of shots that are ready. Called from one thread at a time.
  void denoise_frames();
  void end(std::size_t index, SetState state, const std::string& error = {}, bool is_told = true);
  /// The same where the render does not get another try. The caller holds mutex_.
  void end_now(std::size_t index, SetState state, const std::string& error, bool is_told);
  [[nodiscard]] Expected<void> write_summary() const;
  [[nodiscard]] std::size_t ended();
  /// Of all renders: " (0:41:10 left)"; empty while none has been rendered.
  [[nodiscard]] std::string time_left_text(double share_of_present);
  [[nodiscard]] Expected<void> make_video() const;
  /// `written`: the files about the whole set.
  ExitCode print_end(const std::vector<std::string>& written);

  SetPlan plan_;
  const RenderOptions& options_;
  const std::vector<std::string>& command_line_;
  const std::atomic<bool>& stop_;
  ProgressPrinter printer_;
  const std::filesystem::path ffmpeg_;  ///< if a video is to be made
  std::string worker_;                  ///< hash of the worker's executable
  SharedScenes scenes_;                 // used by the thread that reads scenes

  const Clock::time_point began_ = Clock::now();
  std::size_t longest_name_ = 0;
  std::condition_variable ended_one_;
  std::mutex mutex_;  // protects the members from here to next_summary_
  std::vector<SetEntry> entries_;
  FailureReasons failures_;
  std::map<std::size_t, bool> told_first_;  // frames that failed once: whether the reason was new
  /// Frames of a shot that failed get another try after all others, for what hindered them may have passed.
  struct FailedFrame {
    std::size_t index;
    SetState state;
    std::string error;
    bool is_told;
  };
  std::vector<FailedFrame> failed_frames_;
  std::set<std::filesystem::path> not_to_write_;  // files about the whole set that scenes read
  std::vector<bool> may_try_again_;               // of each render, whether it gets another try
  std::set<std::string> told_warnings_;           // used by the thread that reads scenes
  std::size_t ended_ = 0, rendered_ = 0;
  Clock::time_point next_summary_{};
  // Hashes of the requested renders; each is written before its render is passed on.
  std::vector<std::string> keys_;
  Mailbox<ReadyRender> ready_{kPreparedAhead};
  Mailbox<FinishedRender> unwritten_;
  std::atomic<std::size_t> unwritten_count_ = 0;
  std::atomic<bool> all_read_ = false, farm_is_over_ = false;
  ShotDenoising denoising_;
  bool has_denoised_all_ = true;
  std::set<std::size_t> whole_;  // images with all their samples, also bad ones; used by one thread at a time
  std::map<std::size_t, Film> films_;    // of each scene that was read; under mutex_
  std::vector<std::size_t> just_ended_;  // since frames were denoised last; under mutex_
  std::map<std::size_t, double> fps_;    // of each scene that was read; used by the thread that reads them
  std::atomic<bool> sampler_replaced_ = false;  // for any of the renders
  std::optional<ReadyRender> next_, taken_;
  std::vector<ReadyRender> again_;  // renders to be repeated because the automatically chosen device failed
  std::map<JobId, std::optional<ReadyRender>> open_;
  RenderPage page_;
};

// --- The thread that reads scenes

std::optional<std::size_t> SceneSet::next_to_read(std::vector<std::size_t>& unread) {
  std::unique_lock lock(mutex_);
  const auto is_over = [&] {
    return unread.empty() && failed_frames_.empty() &&
           std::ranges::none_of(may_try_again_, [](bool may) { return may; });
  };
  while (!is_over() && !stop_ && !farm_is_over_) {
    for (auto at = unread.begin(); at != unread.end(); ++at) {
      const std::vector<std::size_t>& after = plan_.members[*at].after;
      if (!std::ranges::all_of(after, [&](std::size_t i) { return entries_[i].state != SetState::kWaiting; }))
        continue;
      const std::size_t next = *at;
      unread.erase(at);
      return next;
    }
    if (!failed_frames_.empty() && ended_ + failed_frames_.size() + unread.size() == entries_.size()) {
      const FailedFrame failed = std::move(failed_frames_.front());
      failed_frames_.erase(failed_frames_.begin());
      // Where no render has succeeded, another try would not either.
      if (std::ranges::any_of(entries_, is_rendered)) return failed.index;
      end_now(failed.index, failed.state, failed.error, failed.is_told);
      continue;
    }
    ended_one_.wait_for(lock, kBetweenLooks);
  }
  return {};
}

void SceneSet::read_scenes() {
  std::vector<std::size_t> unread(plan_.members.size());
  std::iota(unread.begin(), unread.end(), 0);
  while (const auto next = next_to_read(unread)) {
    const std::size_t i = *next;
    try {
      if (const auto read = read_scene(i); !read) fail_member(i, read.error());
    } catch (const std::exception& error) {  // usually out of memory; other renders may need less
      fail_member(i, {error.what()});
    }
    job_signal().notify();
  }
  all_read_ = true;
  job_signal().notify();
}

Expected<void> SceneSet::check_earlier(std::size_t index) {
  const std::lock_guard lock(mutex_);
  for (const std::size_t i : plan_.members[index].after)
    if (entries_[i].state == SetState::kFailed || entries_[i].state == SetState::kIncomplete)
      return fail(fmt::format("not begun, because {}, after which it comes, is {}", entries_[i].name,
                              set_state_name(entries_[i].state)));
  return {};
}

Expected<void> SceneSet::read_scene(std::size_t index) {
  if (const auto checked = check_earlier(index); !checked) return checked;
  const RenderOptions& options = plan_.members[index].options;
  auto prepared = prepare_render(options, std::bind_front(&SharedScenes::load, &scenes_));
  if (!prepared) return std::unexpected(prepared.error());
  if (const auto device = check_device(prepared->job.device); !device) return device;
  if (const auto denoiser = check_denoiser(prepared->record.film.denoise); !denoiser) return denoiser;
  for (const std::string& warning : prepared->scene.description.warnings)
    if (told_warnings_.insert(warning).second) print_warning(warning);
  if (const auto kept = keep_inputs(prepared->scene.description.files); !kept) return kept;
  keys_[index] = key_of(*prepared, worker_);
  {
    const std::lock_guard lock(mutex_);
    films_[index] = prepared->record.film;
  }
  fps_[index] = prepared->record.scene.fps.value_or(kFramesPerSecond);
  prepared->job.priority = plan_.members[index].priority;
  if (!options_.force && entries_[index].key == keys_[index])
    return end(index, SetState::kUnchanged), Expected<void>();
  if (prepared->scene.sampler_replaced) sampler_replaced_ = true;
  if (const std::string& choice = prepared->scene.choice; !choice.empty() && !options_.quiet)
    print_message(fmt::format("{}: {}", entries_[index].name, choice));
  if (const auto made = make_folders(prepared->files); !made) return made;
  const auto resumed = attach_checkpoint(*prepared, options, worker_);
  if (!resumed) return std::unexpected(resumed.error());
  if (prepared->job.before && !options_.quiet) print_message(*resumed);
  ready_.put({index, std::make_shared<PreparedRender>(std::move(*prepared))});
  return {};
}

Expected<void> SceneSet::keep_inputs(const std::vector<std::filesystem::path>& inputs) {
  leave_out_sheets(plan_, inputs);
  for (const std::filesystem::path& file :
       {plan_.summary, std::filesystem::path(options_.table), std::filesystem::path(options_.video)})
    if (!file.empty() && is_among(file, inputs)) {
      const std::lock_guard lock(mutex_);
      not_to_write_.insert(file);
      return may_write(file);
    }
  return {};
}

Expected<void> SceneSet::may_write(const std::filesystem::path& file) const {
  if (!not_to_write_.contains(file)) return {};
  return fail(fmt::format("{} is an input of a scene; it is not overwritten", file.string()));
}

void SceneSet::fail_member(std::size_t index, const Error& error) {
  const auto [is_new, is_second] = [&] {
    const std::lock_guard lock(mutex_);
    if (const auto first = told_first_.find(index); first != told_first_.end())
      return std::pair(first->second, true);
    const bool added = failures_.add(entries_[index].name, entries_[index].scene, error.message);
    if (may_try_again_[index]) told_first_[index] = added;
    return std::pair(added, false);
  }();
  if (is_new && !is_second) print_error({fmt::format("{}: {}", entries_[index].name, error.message)});
  end(index, SetState::kFailed, error.message, is_new);
}

// --- The thread that drives the farm

std::shared_ptr<const RenderJob> SceneSet::next() {
  if (unwritten_count_ >= kMostUnwritten || is_exhausted() || !next_) return nullptr;
  taken_ = std::exchange(next_, {});
  return {taken_->prepared, &taken_->prepared->job};
}

bool SceneSet::is_exhausted() {
  const bool is_last = all_read_;  // read this first, so that everything queued before is found
  if (!next_ && !again_.empty()) {
    next_ = std::move(again_.back());
    again_.pop_back();
  }
  if (!next_) next_ = ready_.take(std::chrono::milliseconds(0));
  return is_last && !next_;
}

void SceneSet::progress(JobId id, const RenderProgress& progress) {
  page_.progress(id, progress);
  if (open_.begin()->first != id) return;  // show only the most advanced render
  const std::size_t index = open_.begin()->second->index;
  const double done =
      progress.samples_total > 0 ? double(progress.samples_done) / double(progress.samples_total) : 0.0;
  printer_.update(progress, fmt::format("{} of {}{}, {}: ", ended() + 1, plan_.members.size(),
                                        time_left_text(done), entries_[index].name));
}

void SceneSet::done(JobId id, Expected<RenderOutcome> outcome) {
  ReadyRender ready = *std::move(open_.extract(id).mapped());
  if (!outcome) {
    if (ready.prepared->job.device.backend == Backend::kAuto && !stop_) {
      print_warning(
          fmt::format("{}: native code renders: {}", entries_[ready.index].name, outcome.error().message));
      const auto can_go_on = fall_back_to_native(*ready.prepared);
      if (can_go_on) return again_.push_back(std::move(ready));
      outcome = std::unexpected(can_go_on.error());
    }
    return fail_member(ready.index, outcome.error());
  }
  ++unwritten_count_;
  unwritten_.put({ready.index, std::move(ready.prepared), std::move(*outcome)});
}

// --- The thread that writes images

void SceneSet::write_images() {
  while (std::optional<FinishedRender> finished = unwritten_.take()) {
    const std::size_t index = finished->index;
    try {
      write(std::move(*finished));
    } catch (const std::exception& error) {  // usually out of memory; only this image is lost
      fail_member(index, {error.what()});
    }
    --unwritten_count_;
    job_signal().notify();
    denoise_frames();
  }
}

void SceneSet::denoise_frames() {
  {
    const std::lock_guard lock(mutex_);
    for (const std::size_t i : std::exchange(just_ended_, {}))
      denoising_.ended(
          i, is_rendered(entries_[i]) || whole_.contains(i) ? std::optional(films_.at(i)) : std::nullopt);
  }
  if (!stop_ && !denoising_.denoise()) has_denoised_all_ = false;
}

void SceneSet::write(FinishedRender finished) {
  const RenderOutcome& outcome = finished.outcome;
  const std::string name = entries_[finished.index].name;
  const auto [least, most, total] = sample_range(outcome.film);
  if (total == 0 && stop_)
    return end(finished.index, SetState::kNotBegun, "stopped by a signal before its first sample", false);
  const double error = outcome.film.relative_error();
  {
    const std::lock_guard lock(mutex_);
    SetEntry& entry = entries_[finished.index];
    entry.key.clear();  // its files are about to change
    entry.samples = least;
    entry.budget_of = ended_by_budget(outcome, finished.prepared->job) ? finished.prepared->job.spp : 0;
    entry.seconds = outcome.seconds;
    entry.relative_error = error;
  }
  finished.prepared->is_denoised_later = denoising_.has(finished.index);
  const RenderEnd ended = finish_render(*finished.prepared, outcome, command_line_, name,
                                        stop_ ? StoppedBy::kSignal : StoppedBy::kNothing);
  if (outcome.complete && ended.kind != RenderEndKind::kFailed) whole_.insert(finished.index);
  end(finished.index,
      ended.kind == RenderEndKind::kDone     ? SetState::kDone
      : ended.kind == RenderEndKind::kFailed ? SetState::kFailed
                                             : SetState::kIncomplete,
      ended.error);
  // Only after the render's end is on disk; until then the checkpoint could be needed.
  if (outcome.complete && ended.kind != RenderEndKind::kFailed) remove_checkpoint(*finished.prepared);
}

void SceneSet::end(std::size_t index, SetState state, const std::string& error, bool is_told) {
  const std::lock_guard lock(mutex_);
  const bool has_failed = state == SetState::kFailed || state == SetState::kIncomplete;
  if (!has_failed || !may_try_again_[index] || stop_ || farm_is_over_)
    return end_now(index, state, error, is_told);
  may_try_again_[index] = false;
  failed_frames_.push_back({index, state, error, is_told});
  ended_one_.notify_all();
}

void SceneSet::end_now(std::size_t index, SetState state, const std::string& error, bool is_told) {
  may_try_again_[index] = false;
  just_ended_.push_back(index);
  entries_[index].state = state;
  entries_[index].error = error;
  ++ended_;
  ended_one_.notify_all();
  if (state != SetState::kUnchanged) ++rendered_;
  if (!options_.quiet && is_told) {
    clear_line();
    print_remark(set_line(entries_[index], ended_, entries_.size(), longest_name_));
  }
  if (state == SetState::kDone) entries_[index].key = keys_[index];
  page_.end(index, job_state_of(state), error, plan_.members[index].files);
  // Writes the current state of the summary, so that finished renders count as such if this process ends.
  // Limits the time spent on it.
  const Clock::time_point begin = Clock::now();
  if (begin < next_summary_ || !may_write(plan_.summary)) return;
  if (const auto written = write_summary(); !written) print_error(written.error());
  next_summary_ = Clock::now() + kSummaryPause * (Clock::now() - begin);
}

Expected<void> SceneSet::write_summary() const {
  if (const auto may = may_write(plan_.summary); !may) return may;
  return write_set_summary(plan_.summary, entries_);
}

std::size_t SceneSet::ended() {
  const std::lock_guard lock(mutex_);
  return ended_;
}

std::string SceneSet::time_left_text(double share_of_present) {
  const std::lock_guard lock(mutex_);
  if (rendered_ == 0) return "";
  const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  const double left = double(entries_.size() - ended_) - share_of_present;
  return fmt::format(" ({} left)", clock_text(seconds * left / (double(rendered_) + share_of_present)));
}

// --- Running all threads

ExitCode SceneSet::run() {
  const auto worker = find_program("penumbra-worker");
  if (!worker) return print_error(worker.error()), kIncomplete;
  worker_ = program_hash(*worker);
  const auto keys = listening_keys(options_.listen, options_.keys);
  if (!keys) return print_error(keys.error()), kBadInput;
  FarmOptions farm{.workers = options_.workers,
                   .worker_executable = worker->string(),
                   .listen = options_.listen,
                   .keys = *keys,
                   .address_file = options_.address_file,
                   .tells_how_to_watch = true};
  set_launch(options_, farm);
  if (const auto opened = page_.open(options_); !opened) return opened.error();
  std::thread reader([this] { read_scenes(); });
  std::thread writer([this] { write_images(); });
  const Expected<void> ran = run_farm(farm, *this, stop_);
  printer_.finish();
  farm_is_over_ = true;
  ready_.close();
  reader.join();
  unwritten_.close();
  writer.join();
  if (!ran) print_error(ran.error());
  for (const FailedFrame& failed : std::exchange(failed_frames_, {}))
    end(failed.index, failed.state, failed.error, failed.is_told);
  for (std::size_t i = 0; i < entries_.size(); ++i)
    if (entries_[i].state == SetState::kWaiting) {
      if (stop_)
        end(i, SetState::kNotBegun, "stopped by a signal before it began", false);
      else
        end(i, SetState::kFailed, "no worker was left");
    }
  denoise_frames();
  std::vector<std::string> written;
  const std::size_t noisy = denoising_.left();
  if (noisy > 0)
    print_error({fmt::format("{} not denoised: a signal stopped the set", counted(noisy, "frame"))});
  ExitCode code = has_denoised_all_ && noisy == 0 ? kAllDone : kIncomplete;
  const auto add_written = [&](const std::string& file, const Expected<void>& is_written) {
    if (is_written) return written.push_back(file);
    print_error(is_written.error());
    code = kIncomplete;
  };
  add_written(plan_.summary.string(), write_summary());
  if (!options_.table.empty()) {
    const auto may = may_write(options_.table);
    add_written(options_.table, may ? write_output(options_.table, bytes_of(set_table(entries_))) : may);
  }
  bool failed = false;
  for (const std::string& sheet : write_contact_sheets(plan_, entries_, failed)) written.push_back(sheet);
  if (failed) code = kIncomplete;
  if (!options_.video.empty()) add_written(options_.video, make_video());
  page_.close();
  return std::max(code, print_end(written));
}

Expected<void> SceneSet::make_video() const {
  if (const auto may = may_write(options_.video); !may) return may;
  if (stop_) return fail("no video is made: a signal stopped the set");
  const std::vector<SheetFrame> frames = frames_of_shot(plan_.shots.front(), plan_, entries_);
  // The rate is that of the shot's first frame whose scene could be read; other renders do not matter.
  double fps = kFramesPerSecond;
  for (const auto& [frame, index] : std::views::reverse(plan_.shots.front().frames))
    if (const auto found = fps_.find(index); found != fps_.end()) fps = found->second;
  const auto ended = write_video(ffmpeg_, frames, video_rate(frames, fps), options_.video);
  if (!ended) return fail(fmt::format("{}: {}", options_.video, ended.error().message));
  const std::string text = fmt::format("{}: {}", options_.video, ended->text);
  if (ended->held > 0)
    print_warning(text);
  else if (!options_.quiet)
    print_message(text);
  return {};
}

ExitCode SceneSet::print_end(const std::vector<std::string>& written) {
  const double seconds = std::chrono::duration<double>(Clock::now() - began_).count();
  if (!options_.quiet)
    print_remark(set_totals(entries_, seconds) +
                 (written.empty() ? "" : fmt::format("wrote {}\n", fmt::join(written, ", "))));
  if (!options_.quiet && sampler_replaced_) print_sampler_note();
  for (const std::string& line : failures_.repeated()) print_error({line});
  const auto not_begun = std::ranges::count(entries_, SetState::kNotBegun, &SetEntry::state);
  const auto failed = std::ranges::count_if(entries_, [](const SetEntry& entry) {
    return entry.state == SetState::kFailed || entry.state == SetState::kIncomplete;
  });
  if (failed > 0)
    print_error(
        {fmt::format("{} of {} failed or are incomplete", failed, counted(entries_.size(), "render"))});
  if (not_begun > 0)
    print_error({fmt::format("{} of {} not begun: a signal stopped the set", not_begun,
                             counted(entries_.size(), "render"))});
  return failed > 0 || not_begun > 0 ? kIncomplete : kAllDone;
}

/// Checks that summary, table and video can be written, and that neither they nor contact sheets replace a
/// job file or a scene.
Expected<void> check_set_files(SetPlan& plan, const RenderOptions& options) {
  std::vector<std::filesystem::path> outputs{plan.summary};
  if (!options.table.empty()) outputs.emplace_back(options.table);
  if (!options.video.empty()) outputs.emplace_back(options.video);
  std::set<std::filesystem::path> files(options.scenes.begin(), options.scenes.end());
  for (const SetMember& member : plan.members) files.emplace(member.options.scene.file);
  const std::vector inputs(files.begin(), files.end());
  leave_out_sheets(plan, inputs);
  return check_outputs(outputs, inputs);
}

}  // namespace

ExitCode render_set(const RenderOptions& options, const CommandLine& command,
                    const std::vector<std::string>& command_line, const std::atomic<bool>& stop) {
  auto plan = plan_set(options, command);
  if (!plan) return print_error(plan.error()), kBadInput;
  if (const auto checked = check_set_files(*plan, options); !checked)
    return print_error(checked.error()), kBadInput;
  std::filesystem::path ffmpeg;
  if (!options.video.empty()) {
    auto found = find_ffmpeg();
    if (!found) return print_error(found.error()), kBadInput;
    ffmpeg = std::move(*found);
  }
  return SceneSet(std::move(*plan), options, command_line, std::move(ffmpeg), stop).run();
}

}  // namespace penumbra
