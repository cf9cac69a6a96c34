#include <fmt/format.h>

#include <algorithm>
#include <limits>
#include <utility>

#include "scheduler/farm/render_run.h"
#include "scheduler/farm/worker_isa.h"

namespace penumbra {
namespace {

std::string kernel_text(const KernelOrigin& kernels) {
  return fmt::format("OpenCL kernels {} {:.2f} s{}{}", kernels.cached ? "from the cache in" : "compiled in",
                     kernels.seconds, kernels.note.empty() ? "" : "; ", kernels.note);
}

/// gRPC's name of the peer.
std::string peer_text(const std::string& peer) {
  if (peer.starts_with("unix:")) return "over the Unix socket";
  return "from " + peer.substr(peer.find(':') + 1);
}

}  // namespace

// --- What comes from workers

void RenderRun::on(const arrivals::Connected& arrival) {
  Worker& worker = workers_[arrival.worker];
  worker.share.name = fmt::format("{}:{}", arrival.host, arrival.pid);
  worker.pid = workers_here_->claim(arrival.key);
  if (worker.pid == 0)
    notice(fmt::format("a worker that this render did not start has joined it: {}, {}", worker.share.name,
                       peer_text(arrival.peer)));
  else
    workers_here_->is_heard_of(worker.pid, plan_time_);
  const bool embree = job_.scene.header.intersector == INTERSECTOR_EMBREE;
  const auto options = options_for_worker(job_.device, embree, arrival.isas, worker.share.name);
  if (options) {
    server_->send_job(arrival.worker, scene_hash_, *options);
    if (view_.number > 0) server_->send_view(arrival.worker, view_);
    return;
  }
  worker.dismissed = true;
  worker.share.ended = options.error().message;
  problem(options.error().message);
  server_->refuse(arrival.worker, options.error().message);
}

void RenderRun::on(const arrivals::Compiling& arrival) {
  std::string text = fmt::format("compiling OpenCL kernels for {}", arrival.device);
  if (is_new(text)) notice(std::move(text));
}

void RenderRun::on(const arrivals::Ready& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  worker.ready = true;
  worker.share.device = arrival.device;
  worker.share.kernels = arrival.preparation.kernels;
  if (worker.share.kernels && is_new(arrival.device)) notice(kernel_text(*worker.share.kernels));
  for (const std::string& warning : arrival.preparation.warnings)
    if (is_new(warning)) problem(warning);
  workers_here_->is_ready(worker.pid);
  if (ready_ == 0) ready_ = since_start();
  tell_plan(WorkerJoined{arrival.worker});
}

void RenderRun::on(const arrivals::Beat& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  workers_here_->is_heard_of(worker.pid, plan_time_);
  tell_plan(Alive{arrival.worker});
  if (arrival.parts != std::exchange(worker.parts, arrival.parts)) tell_plan(Progressed{arrival.worker});
}

void RenderRun::on(const arrivals::JobFailed& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  worker.dismissed = true;
  worker.share.ended = arrival.message;
  server_->dismiss(arrival.worker, arrival.message);
  // Every worker says the same but for names of temporary files in a compiler's log; once is enough.
  const std::string what = arrival.message.substr(0, arrival.message.find('\n'));
  if (job_failures_.insert(what).second) problem("no worker can do this job: " + arrival.message);
}

void RenderRun::on(arrivals::Result& arrival) {
  WorkerShare& share = workers_.at(arrival.worker).share;
  share.busy_seconds += arrival.busy_seconds;
  share.peak_memory_bytes = std::max(share.peak_memory_bytes, arrival.peak_memory_bytes);
  if (is_of_this_view(arrival.unit))
    tell_plan(UnitDone{arrival.worker, in_plan(arrival.unit), arrival.hash}, &arrival);
}

void RenderRun::on(const arrivals::BadResult& arrival) {
  if (!is_of_this_view(arrival.unit)) return;
  details_[in_plan(arrival.unit)] = arrival.why;
  tell_plan(ResultCorrupt{arrival.worker, in_plan(arrival.unit)});
}

void RenderRun::on(const arrivals::UnitFailed& arrival) {
  if (!is_of_this_view(arrival.unit)) return;
  details_[in_plan(arrival.unit)] = arrival.message;
  tell_plan(UnitFailed{arrival.worker, in_plan(arrival.unit)});
}

void RenderRun::on(const arrivals::Gone& arrival) {
  Worker& worker = workers_.at(arrival.worker);
  worker.gone = true;
  worker.gone_since = since_start();
  worker.last_unit = plan_.in_hand(arrival.worker);
  tell_plan(WorkerLost{arrival.worker});
}

void RenderRun::on(const arrivals::ViewChanged& arrival) {
  view_ = arrival.view;
  active_ = 0;
  plan_ = make_plan();
  merge_.start_again();
  details_.clear();
  samples_done_ = 0;
  relative_error_ = std::numeric_limits<double>::quiet_NaN();
  board_.show_view(view_);
  feed_.begin_view(view_);
  for (const auto& [id, worker] : workers_) {
    if (worker.dismissed || worker.gone) continue;
    server_->send_view(id, view_);
    if (worker.ready) tell_plan(WorkerJoined{id});
  }
}

void RenderRun::on(const arrivals::SamplesWanted& arrival) {
  if (arrival.view != view_.number) return;
  const std::uint64_t spp = std::min(arrival.spp, job_.spp);
  tell_plan(MorePasses{0, std::uint32_t((spp + job_.samples_per_pass - 1) / job_.samples_per_pass)});
}

// --- What the plan orders

void RenderRun::tell_plan(const PlanEvent& event, arrivals::Result* result) {
  for (const PlanOrder& order : plan_.handle(event, plan_time_)) {
    std::visit([&](const auto& o) { obey(o, result); }, order);
  }
}

void RenderRun::obey(const Assign& order, arrivals::Result*) {
  server_->send_unit(order.worker, on_wire(order.unit), unit(order.unit), planes_);
}

void RenderRun::obey(const MergeResult& order, arrivals::Result* result) {
  if (first_tile_ == 0) first_tile_ = since_start();
  const std::uint64_t samples = result->buffer.pixels() * result->buffer.sample_count;
  WorkerShare& share = workers_.at(order.worker).share;
  ++share.units;
  share.samples += samples;
  samples_done_ += samples;
  workers_here_->has_worked();
  merge_.add(order.unit.tile, order.unit.pass, std::move(result->buffer));
  feed_.tile_changed(order.unit.tile, order.worker);
  last_tile_ = since_start();
}

void RenderRun::obey(const SetAside& order, arrivals::Result*) {
  merge_.skip(order.unit.tile, order.unit.pass);
  problem(set_aside_text(order, unit(order.unit), detail(order.unit), job_.reproduce_command, names()));
}

void RenderRun::obey(const DismissWorker& order, arrivals::Result*) {
  Worker& worker = workers_.at(order.worker);
  const std::string why = dismissal_text(order, unit(order.unit), detail(order.unit), names());
  worker.dismissed = true;
  worker.share.ended = why;
  problem(why);
  server_->dismiss(order.worker, why);
  workers_here_->kill(worker.pid);
}

void RenderRun::obey(const RedoTile& order, arrivals::Result*) { samples_done_ -= merge_.redo(order.tile); }

void RenderRun::obey(const Overdue& order, arrivals::Result*) {
  notice(overdue_text(order, unit(order.unit), names()));
}

void RenderRun::obey(const GiveUp&, arrivals::Result*) {
  problem(fmt::format(
      "workers returned different results for the same unit {} times; none can be trusted, so the "
      "render was given up",
      kDisputesToGiveUp));
}

}  // namespace penumbra
