// One call of run_render: passes arrivals to the plan, and the plan's orders to merge, workers, watchers and
// statistics.
#pragma once

#include <algorithm>
#include <chrono>
#include <functional>
#include <map>
#include <memory>
#include <optional>
#include <set>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/stopwatch.h"
#include "scheduler/farm/private_socket.h"
#include "scheduler/farm/problem_text.h"
#include "scheduler/farm/render_job.h"
#include "scheduler/farm/server.h"
#include "scheduler/farm/worker_processes.h"
#include "scheduler/plan/merge.h"
#include "scheduler/plan/tile_grid.h"
#include "scheduler/watch/render_feed.h"
#include "scheduler/watch/tev_stream.h"

namespace penumbra {

class RenderRun {
 public:
  RenderRun(const RenderJob& job, const std::atomic<bool>& stop,
            const std::function<void(const RenderProgress&)>& on_progress);

  Expected<RenderOutcome> run();

 private:
  using Clock = std::chrono::steady_clock;

  struct Worker {
    WorkerShare share;
    int pid = 0;  // of the process here; 0: this render has not started it
    bool ready = false, dismissed = false, gone = false, ended = false;
    std::optional<UnitId> last_unit;  // in hand when it was lost
    Seconds gone_since = 0;
    std::uint64_t parts = 0;  // of units, as it reports
  };

  void on(const arrivals::Connected& arrival);
  void on(const arrivals::Compiling& arrival);
  void on(const arrivals::Ready& arrival);
  void on(const arrivals::Beat& arrival);
  void on(const arrivals::JobFailed& arrival);
  void on(arrivals::Result& arrival);
  void on(const arrivals::BadResult& arrival);
  void on(const arrivals::UnitFailed& arrival);
  void on(const arrivals::Gone& arrival);
  void on(const arrivals::ViewChanged& arrival);
  void on(const arrivals::SamplesWanted& arrival);

  void tell_plan(const PlanEvent& event, arrivals::Result* result = nullptr);
  void obey(const Assign& order, arrivals::Result*);
  void obey(const MergeResult& order, arrivals::Result* result);
  void obey(const DiscardResult&, arrivals::Result*) {}
  void obey(const SetAside& order, arrivals::Result*);
  void obey(const DismissWorker& order, arrivals::Result*);
  void obey(const RedoTile& order, arrivals::Result*);
  void obey(const Overdue& order, arrivals::Result*);
  void obey(const GiveUp&, arrivals::Result*);

  Expected<void> start();
  void look_after_workers();
  void tell_start_problems();
  void worker_ended(const WorkerEnd& end);
  void advance_clock();
  void tick();
  void report_progress();
  void show_progress(bool ended);
  void tell_how_to_watch();
  RenderOutcome outcome() &&;

  [[nodiscard]] Seconds since_start() const { return seconds_since(started_); }
  /// An interactive render waits for its watchers' next request.
  [[nodiscard]] bool is_done() const { return !job_.interactive && plan_.finished(); }
  [[nodiscard]] bool can_go_on() const { return workers_here_->any_left() && !plan_.gave_up(); }
  /// Samples of a pixel in so many passes.
  [[nodiscard]] std::uint32_t spp_of(std::uint32_t passes) const {
    return std::uint32_t(std::min(std::uint64_t(passes) * job_.samples_per_pass, std::uint64_t(job_.spp)));
  }
  /// Empty for a unit that the job does not have: a faulty worker may name any.
  [[nodiscard]] RenderUnit unit(const UnitId& id) const {
    const bool exists = id.image == 0 && id.tile < grid_.tiles() && id.pass < grid_.passes();
    return exists ? grid_.unit(id.tile, id.pass) : RenderUnit{};
  }
  // The plan knows of one image at a time; on the wire its number is that of the view.
  [[nodiscard]] UnitId on_wire(UnitId id) const { return {view_.number, id.pass, id.tile}; }
  [[nodiscard]] bool is_of_this_view(const UnitId& id) const { return id.image == view_.number; }
  [[nodiscard]] static UnitId in_plan(UnitId id) { return {0, id.pass, id.tile}; }
  [[nodiscard]] Plan make_plan() const;
  [[nodiscard]] Merge make_merge() const;
  [[nodiscard]] std::string detail(const UnitId& id) const {
    const auto found = details_.find(id);
    return found == details_.end() ? "" : found->second;
  }
  [[nodiscard]] WorkerName names() const {
    return [this](WorkerId worker) { return workers_.at(worker).share.name; };
  }
  void problem(std::string text);
  void notice(std::string text);
  /// A notice that all workers send alike is shown once.
  [[nodiscard]] bool is_new(const std::string& text) { return said_.insert(text).second; }

  const RenderJob& job_;
  const std::atomic<bool>& stop_;
  const std::function<void(const RenderProgress&)>& on_progress_;
  const int planes_;
  const TileGrid grid_;
  const Clock::time_point started_ = Clock::now();

  WatchView view_;
  Plan plan_;
  Merge merge_;
  WatchBoard board_;
  RenderFeed feed_;
  std::optional<TevStream> tev_;
  std::string scene_hash_;
  std::map<WorkerId, Worker> workers_;
  std::map<UnitId, std::string> details_;  // what was said last about a unit that failed
  std::set<std::string> job_failures_;
  std::set<std::string> said_;
  std::vector<std::string> problems_, notices_;
  bool budget_spent_ = false;
  std::uint64_t samples_done_ = 0;
  Seconds ready_ = 0, first_tile_ = 0, last_tile_ = 0;
  Seconds active_ = 0;  // since the view began, while there was something to render
  Seconds now_ = 0, plan_time_ = 0, last_tick_ = 0;
  Seconds next_progress_ = 0, next_shown_ = 0;
  double relative_error_ = 0;  // as last reported
  // The workers talk to the server through the socket, so they go first and the socket last.
  std::optional<PrivateSocket> socket_;
  std::unique_ptr<Server> server_;
  std::optional<WorkerProcesses> workers_here_;
};

}  // namespace penumbra
