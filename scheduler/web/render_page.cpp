#include "scheduler/web/render_page.h"

#include <algorithm>
#include <limits>
#include <nlohmann/json.hpp>

#include "kernels/host/console.h"
#include "kernels/host/process.h"
#include "scheduler/record/version.h"
#include "scheduler/service/job_queue.h"
#include "scheduler/service/status_text.h"
#include "scheduler/service/status_wire.h"
#include "worker/keys/secrets.h"
#include "worker/protocol/text.h"

namespace penumbra {
namespace {

constexpr int kMostMessages = 20;

}  // namespace

std::expected<void, ExitCode> RenderPage::open(const RenderOptions& options) {
  if (options.web.empty()) return {};
  const auto page = web_page_of(options.web, options.keys);
  if (!page) return print_error(page.error()), std::unexpected(kBadInput);
  pictures_.emplace();
  auto server = open_web_page(*page, make_token(), false, *this);
  if (!server) return print_error(server.error()), std::unexpected(kIncomplete);
  server_ = std::move(*server);
  print_message(web_page_notice(*server_, *page));
  return {};
}

wire::JobStatus* RenderPage::find(std::size_t render) {
  return render < std::size_t(state_.jobs_size()) ? state_.mutable_jobs(int(render)) : nullptr;
}

void RenderPage::add(const std::string& name, int priority, std::optional<int> frame) {
  const std::lock_guard lock(mutex_);
  wire::JobStatus& job = *state_.add_jobs();
  job.set_job(std::uint32_t(state_.jobs_size()));
  job.set_name(wire_text(name, kLongestName));
  job.set_priority(priority);
  job.set_submitted(unix_time());
  job.set_relative_error(std::numeric_limits<double>::quiet_NaN());
  if (frame) job.set_frame(*frame);
}

void RenderPage::add_shot(const std::string& name) {
  const std::lock_guard lock(mutex_);
  wire::JobGroup& group = *state_.add_groups();
  group.set_number(std::uint32_t(state_.jobs_size()) + 1);  // jobs and groups are numbered together
  group.set_name(wire_text(name, kLongestName));
  for (wire::JobStatus& job : *state_.mutable_jobs()) {
    if (!job.has_frame()) continue;
    job.set_group(group.number());
    group.set_size(group.size() + 1);
  }
}

void RenderPage::took(std::size_t render, JobId id) {
  const std::lock_guard lock(mutex_);
  renders_[id] = render;
}

void RenderPage::shown(JobId id, const std::shared_ptr<WatchBoard>& board) {
  if (!is_open()) return;
  const std::lock_guard lock(mutex_);
  if (const auto found = renders_.find(id); found != renders_.end())
    pictures_->films().add(JobId(found->second + 1), board);
}

void RenderPage::progress(JobId id, const RenderProgress& progress) {
  const std::lock_guard lock(mutex_);
  const auto found = renders_.find(id);
  wire::JobStatus* job = found != renders_.end() ? find(found->second) : nullptr;
  if (job == nullptr || is_over(*job)) return;
  put_progress(progress, *job);
  for (const std::string& notice : progress.notices) *job->add_problems() = wire_text(notice, kLongestText);
}

void RenderPage::workers(const std::vector<FarmWorker>& workers) {
  const std::lock_guard lock(mutex_);
  state_.clear_workers();
  for (FarmWorker worker : workers) {
    const auto found = worker.job ? renders_.find(*worker.job) : renders_.end();
    worker.job = found != renders_.end() ? std::optional(JobId(found->second + 1)) : std::nullopt;
    *state_.add_workers() = encode(worker);
  }
}

void RenderPage::say(const std::string& message) {
  const std::lock_guard lock(mutex_);
  *state_.add_messages() = wire_text(message, kLongestText);
  if (state_.messages_size() > kMostMessages) state_.mutable_messages()->DeleteSubrange(0, 1);
}

void RenderPage::end(std::size_t render, wire::JobState state, const std::string& error,
                     const OutputFiles& files) {
  const std::lock_guard lock(mutex_);
  wire::JobStatus* job = find(render);
  if (job == nullptr) return;
  job->set_state(state);
  job->set_error(wire_text(error, kLongestText));
  job->set_ended(unix_time());
  for (const std::filesystem::path& path : files.all())
    if (add_file(path, *job)) files_[render].push_back(path);
  if (pictures_) pictures_->films().remove(JobId(render + 1));
}

wire::StatusReply RenderPage::reply() {
  const std::lock_guard lock(mutex_);
  wire::StatusReply reply = state_;
  reply.set_version(std::string(kVersion));
  reply.set_now(unix_time());
  reply.set_up_seconds(std::chrono::duration<double>(std::chrono::steady_clock::now() - started_).count());
  return reply;
}

nlohmann::ordered_json RenderPage::status() {
  wire::StatusReply all = reply();
  for (wire::JobStatus& job : *all.mutable_jobs()) job.clear_problems();
  return web_page_status(std::move(all));
}

nlohmann::ordered_json RenderPage::job(JobId job) {
  wire::StatusReply all = reply();
  if (job == 0 || job > JobId(all.jobs_size())) return {};
  wire::StatusReply one;
  *one.add_jobs() = all.jobs(int(job) - 1);
  return status_json(one)["jobs"][0];
}

std::optional<WebPicture> RenderPage::picture(JobId job, int largest_side) {
  std::optional<std::filesystem::path> stored;
  {
    const std::lock_guard lock(mutex_);
    const std::size_t render = std::size_t(job) - 1;
    const wire::JobStatus* status = find(render);
    if (status == nullptr) return {};
    for (const char* extension : {".exr", ".png"})  // a PNG is read faster
      for (const std::filesystem::path& path : files_[render])
        if (path.extension() == extension) stored = path;
  }
  return stored ? pictures_->of_file(job, *stored, largest_side) : pictures_->of_film(job, largest_side);
}

std::optional<std::filesystem::path> RenderPage::file(JobId job, const std::string& name) {
  const std::lock_guard lock(mutex_);
  const auto found = files_.find(std::size_t(job) - 1);
  if (found == files_.end()) return {};
  for (const std::filesystem::path& path : found->second)
    if (path.filename() == name) return path;
  return {};
}

}  // namespace penumbra
