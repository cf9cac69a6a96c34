// Verification: units that a second worker renders too.
#include <utility>

#include "scheduler/plan/plan.h"

namespace penumbra {
namespace {

constexpr int kChecksLookedAt = 16;

/// A hash with good mixing (the finalizer of SplitMix64; Steele, Lea and Flood 2014).
std::uint64_t mixed(std::uint64_t bits) {
  bits += 0x9e3779b97f4a7c15u;
  bits = (bits ^ (bits >> 30)) * 0xbf58476d1ce4e5b9u;
  bits = (bits ^ (bits >> 27)) * 0x94d049bb133111ebu;
  return bits ^ (bits >> 31);
}

}  // namespace

bool Plan::is_to_be_verified(UnitId id) const {
  const double share = jobs_.at(id.job).verify;
  const std::uint64_t name = mixed(mixed(mixed(id.phase) + id.pass) + id.tile);
  return double(name >> 11) * 0x1p-53 < share;
}

/// The unit is verified, or will not be.
void Plan::end_check(UnitId id, Unit& unit) {
  if (!std::exchange(unit.unverified, false)) return;
  Job& job = jobs_.at(id.job);
  job.checks.erase(id);
  --job.unverified;
}

void Plan::give_up_checks(JobId id) {
  Job& job = jobs_.at(id);
  for (const UnitId& unit : std::exchange(job.checks, {})) {
    units_.erase(unit);  // no worker holds it
    --job.unverified;
    ++job.counts.not_verified;
  }
}

/// Whether a worker that is busy now may verify the job's units later.
bool Plan::may_be_verified_later(JobId job) const {
  int able = 0;
  bool is_any_busy = false;
  for (const auto& [id, worker] : workers_) {
    if (worker.unfit.contains(job)) continue;
    ++able;
    is_any_busy |= worker.wants != 0u;
    if (able >= 2 && is_any_busy) return true;
  }
  return false;
}

/// Gives up verifications in jobs where nothing else is left and no worker can do them.
void Plan::give_up_idle_checks() {
  for (auto& [id, job] : jobs_) {
    if (job.units_left > 0 || job.unverified == 0 || job.checks.size() < job.unverified ||
        may_be_verified_later(id))
      job.idle_since.reset();
    else if (!job.idle_since)
      job.idle_since = now_;
    else if (now_ - *job.idle_since >= kTimeToFindASecond)
      give_up_checks(id);
  }
}

/// A unit that another worker has rendered. If all were rendered by this worker, others will verify them.
std::optional<UnitId> Plan::check_for(WorkerId id, JobId job) const {
  int looked_at = 0;
  for (const UnitId& unit : jobs_.at(job).checks) {
    if (units_.at(unit).done_by != id) return unit;
    if (++looked_at == kChecksLookedAt) break;
  }
  return {};
}

}  // namespace penumbra
