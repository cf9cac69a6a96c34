// A render by itself: its scene is read while the workers start, its files are written while they end.
#pragma once

#include <atomic>
#include <expected>
#include <functional>
#include <future>
#include <optional>
#include <string>
#include <vector>

#include "scheduler/cli/exit_code.h"
#include "scheduler/cli/progress.h"
#include "scheduler/cli/render_preparation.h"

namespace penumbra {

class OneRender final : public JobSource {
 public:
  using Prepared = std::expected<PreparedRender, ExitCode>;

  /// All of them outlive it. `show`: how far it is, on the terminal.
  OneRender(const RenderOptions& options, const std::vector<std::string>& command_line,
            const std::atomic<bool>& stop, bool show);

  /// Prepares, perhaps on another thread, renders, and writes what there is. The error is that of `prepare`,
  /// which has said why. Where the machine was to choose what computes, and its choice brings down every
  /// worker (a driver that crashes is none that fails), native code renders after all.
  std::expected<void, ExitCode> run(const std::function<Prepared()>& prepare);

  // --- After run()
  [[nodiscard]] PreparedRender& prepared() { return **prepared_; }
  /// What came of it; the error: no worker could do it. None: it was stopped before it began.
  [[nodiscard]] const std::optional<Expected<RenderOutcome>>& outcome() const { return outcome_; }
  /// Whether its files are there, if there was anything to write.
  [[nodiscard]] const Expected<void>& written() const { return written_; }

  // --- Of the farm's thread
  std::shared_ptr<const RenderJob> next() override;
  bool is_exhausted() override;
  void progress(JobId id, const RenderProgress& progress) override;
  void notice(const std::string& text) override { notices_.push_back(text); }
  void done(JobId id, Expected<RenderOutcome> outcome) override;

 private:
  void prepare_by(const std::function<Prepared()>& prepare);
  void render(const FarmOptions& farm);

  const RenderOptions& options_;
  const std::vector<std::string>& command_line_;
  const std::atomic<bool>& stop_;
  const bool show_;
  ProgressPrinter printer_;

  std::optional<Prepared> prepared_;         // before is_prepared_, of the thread that prepares
  std::atomic<bool> is_prepared_ = false;    // or never will be
  bool is_taken_ = false;                    // by the farm
  std::vector<std::string> notices_, said_;  // said: by an attempt before
  std::optional<Expected<RenderOutcome>> outcome_;
  Expected<void> written_;
  std::future<Expected<void>> writing_;  // the last member: it is waited for before the others go
};

}  // namespace penumbra
