// A single render. The scene is read while the workers start, and files are written while they end.
#pragma once

#include <atomic>
#include <expected>
#include <functional>
#include <future>
#include <optional>
#include <set>
#include <string>
#include <vector>

#include "scheduler/run/progress.h"
#include "scheduler/run/render_preparation.h"
#include "scheduler/web/render_page.h"
#include "worker/cli/exit_code.h"

namespace penumbra {

class OneRender final : public JobSource {
 public:
  using Prepared = std::expected<PreparedRender, ExitCode>;

  /// The arguments must outlive this object. `show`: display progress on the terminal.
  OneRender(const RenderOptions& options, const std::vector<std::string>& command_line,
            const std::atomic<bool>& stop, bool show);

  /// Prepares (possibly on another thread), renders, and writes the results. The error is that of `prepare`,
  /// which has printed it. If the backend was chosen automatically and every worker died with it (a driver
  /// that crashes does not report an error), the render is repeated with native code.
  std::expected<void, ExitCode> run(const std::function<Prepared()>& prepare);

  // --- Valid after run()
  [[nodiscard]] PreparedRender& prepared() { return **prepared_; }
  /// The outcome, or an error if no worker could render it. Nothing if it was stopped before it began.
  [[nodiscard]] const std::optional<Expected<RenderOutcome>>& outcome() const { return outcome_; }
  /// Whether the files were written, if there was anything to write.
  [[nodiscard]] const Expected<void>& written() const { return written_; }

  // --- Called from the farm's thread
  std::shared_ptr<const RenderJob> next() override;
  bool is_exhausted() override;
  void took(JobId id) override { page_.took(0, id); }
  void shown(JobId id, const std::shared_ptr<WatchBoard>& board) override { page_.shown(id, board); }
  void progress(JobId id, const RenderProgress& progress) override;
  [[nodiscard]] bool wants_workers() const override { return page_.is_open(); }
  void workers(const std::vector<FarmWorker>& workers) override { page_.workers(workers); }
  void notice(const std::string& text) override {
    if (is_taken_) page_.say(text);                           // the first ones contain tokens
    if (told_.insert(text).second) notices_.push_back(text);  // a second attempt has the same address
  }
  void done(JobId id, Expected<RenderOutcome> outcome) override;

 private:
  void prepare_by(const std::function<Prepared()>& prepare);
  void render(const FarmOptions& farm);
  void show_end();

  const RenderOptions& options_;
  const std::vector<std::string>& command_line_;
  const std::atomic<bool>& stop_;
  const bool show_;
  ProgressPrinter printer_;

  std::optional<Prepared> prepared_;       // written by the preparing thread before is_prepared_ is set
  std::atomic<bool> is_prepared_ = false;  // whether preparing has ended, with or without success
  bool is_taken_ = false;                  // whether the farm has taken the job
  std::set<std::string> told_;
  std::vector<std::string> notices_, said_;  // said_: those shown by an earlier attempt
  std::optional<Expected<RenderOutcome>> outcome_;
  Expected<void> written_;
  RenderPage page_;
  // The last member, so that it is waited for before the others are destroyed.
  std::future<Expected<void>> writing_;
};

}  // namespace penumbra
