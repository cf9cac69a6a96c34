#include "scheduler/cli/one_render.h"

#include <utility>

#include "kernels/host/console.h"
#include "scheduler/files/program_path.h"
#include "scheduler/record/film_image.h"
#include "scheduler/run/render_checkpoint.h"
#include "scheduler/run/render_outputs.h"

namespace penumbra {

OneRender::OneRender(const RenderOptions& options, const std::vector<std::string>& command_line,
                     const std::atomic<bool>& stop, bool show)
    : options_(options),
      command_line_(command_line),
      stop_(stop),
      show_(show),
      printer_(progress_style(options.progress, show), terminal_columns()) {}

std::expected<void, ExitCode> OneRender::run(const std::function<Prepared()>& prepare) {
  // Listen on a public address, or occupy hosts of a queue, only for a scene that can be rendered.
  const auto worker = find_program("penumbra-worker");
  if (worker && options_.listen.empty() && options_.launch.empty() && options_.web.empty()) {
    FarmOptions farm = farm_of(options_);
    farm.worker_executable = worker->string();
    farm.tells_how_to_watch = true;
    auto preparing = std::async(std::launch::async, [&] { prepare_by(prepare); });
    render(farm);
    preparing.get();
    if (!*prepared_) return std::unexpected(prepared_->error());
  } else {
    prepare_by(prepare);
    if (!*prepared_) return std::unexpected(prepared_->error());
    page_.add(options_.scene.file);
    if (const auto opened = page_.open(options_); !opened) return opened;
    render((*prepared_)->farm);
  }

  PreparedRender& prepared = **prepared_;
  if (outcome_ && !*outcome_ && prepared.job.device.backend == Backend::kAuto && !stop_) {
    said_.push_back("native code renders: " + outcome_->error().message);
    outcome_.reset();
    is_taken_ = false;
    if (const auto ready = fall_back_to_native(prepared); ready)
      render(prepared.farm);
    else
      outcome_ = std::unexpected(ready.error());
  }
  if (writing_.valid()) written_ = writing_.get();
  if (page_.is_open()) show_end();
  return {};
}

void OneRender::show_end() {
  const bool has_failed = !outcome_ || !*outcome_ || !written_;
  const std::string error = !written_                ? written_.error().message
                            : outcome_ && !*outcome_ ? outcome_->error().message
                                                     : "";
  page_.end(0,
            has_failed              ? wire::JOB_FAILED
            : (*outcome_)->complete ? wire::JOB_DONE
                                    : wire::JOB_INCOMPLETE,
            error, prepared().files);
  page_.close();
}

void OneRender::prepare_by(const std::function<Prepared()>& prepare) {
  const auto let_the_farm_know = [this] {
    is_prepared_ = true;
    job_signal().notify();
  };
  try {
    prepared_ = prepare();
  } catch (...) {
    let_the_farm_know();
    throw;
  }
  let_the_farm_know();
}

void OneRender::render(const FarmOptions& farm) {
  const Expected<void> ran = run_farm(farm, *this, stop_);
  printer_.finish();
  if (!ran && !outcome_) outcome_ = std::unexpected(ran.error());
}

std::shared_ptr<const RenderJob> OneRender::next() {
  if (is_exhausted() || !is_prepared_) return nullptr;
  is_taken_ = true;
  // Without ownership, because the owner waits for run().
  return {std::shared_ptr<const RenderJob>(), &(*prepared_)->job};
}

bool OneRender::is_exhausted() {
  return is_prepared_ && (is_taken_ || !prepared_ || !prepared_->has_value());
}

void OneRender::progress(JobId id, const RenderProgress& progress) {
  page_.progress(id, progress);
  RenderProgress with_notices = progress;
  with_notices.notices.insert(with_notices.notices.begin(), notices_.begin(), notices_.end());
  notices_.clear();
  printer_.update(with_notices);
  // The address and its token are printed nevertheless, because the user asked for an address.
  if (!show_ && !options_.listen.empty())
    for (const std::string& text : with_notices.notices) print_message(text);
}

void OneRender::done(JobId, Expected<RenderOutcome> outcome) {
  printer_.finish();
  outcome_ = std::move(outcome);
  if (!*outcome_) return;
  RenderOutcome& rendered = **outcome_;
  rendered.problems.insert(rendered.problems.begin(), said_.begin(), said_.end());
  if (sample_range(rendered.film).total == 0) return;  // do not overwrite an existing image with an empty one
  writing_ = std::async(std::launch::async | std::launch::deferred,
                        [this, &rendered] { return write_outputs(**prepared_, rendered, command_line_); });
}

}  // namespace penumbra
