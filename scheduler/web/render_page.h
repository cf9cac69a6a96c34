// What the page in the browser shows of `penumbra render`: one render or a set.
#pragma once

#include <chrono>
#include <map>
#include <memory>
#include <mutex>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/farm/render_farm.h"
#include "scheduler/run/output_files.h"
#include "scheduler/run/render_options.h"
#include "scheduler/web/job_pictures.h"
#include "scheduler/web/web_page.h"

namespace penumbra {

/// Numbers the renders from 1 on, in the order of add(). Thread-safe. Without --web nothing is shown.
class RenderPage final : public WebContent {
 public:
  /// Opens the page and prints where it is. Errors: see web_page_of (kBadInput) and open_web_page.
  std::expected<void, ExitCode> open(const RenderOptions& options);
  /// Shows the last state and ends. The page says that the render is over.
  void close() { server_.reset(); }
  [[nodiscard]] bool is_open() const { return server_ != nullptr; }

  void add(const std::string& name, int priority = 0, std::optional<int> frame = {});
  /// The frames among the renders that were added are a group of this name. Call it after them.
  void add_shot(const std::string& name);
  /// The farm has taken the render under its own number.
  void took(std::size_t render, JobId id);
  void shown(JobId id, const std::shared_ptr<WatchBoard>& board);
  void progress(JobId id, const RenderProgress& progress);
  void workers(const std::vector<FarmWorker>& workers);
  void say(const std::string& message);
  /// The render is over; `files` are those that it has written, or that were there.
  void end(std::size_t render, wire::JobState state, const std::string& error, const OutputFiles& files);

  // --- For the page
  [[nodiscard]] nlohmann::ordered_json status() override;
  [[nodiscard]] nlohmann::ordered_json job(JobId job) override;
  [[nodiscard]] std::optional<WebPicture> picture(JobId job, int largest_side) override;
  [[nodiscard]] std::optional<std::filesystem::path> file(JobId job, const std::string& name) override;

 private:
  [[nodiscard]] wire::JobStatus* find(std::size_t render);
  [[nodiscard]] wire::StatusReply reply();

  const std::chrono::steady_clock::time_point started_ = std::chrono::steady_clock::now();
  std::optional<JobPictures> pictures_;  // nothing without --web: it has a thread
  std::mutex mutex_;
  wire::StatusReply state_;
  std::map<JobId, std::size_t> renders_;  // by the farm's numbers
  std::map<std::size_t, std::vector<std::filesystem::path>> files_;
  std::unique_ptr<WebServer> server_;  // the last member: it uses the others
};

}  // namespace penumbra
