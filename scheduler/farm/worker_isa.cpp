#include "scheduler/farm/worker_isa.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra {
namespace {

std::string list(std::span<const Isa> isas) { return isas.empty() ? "none that it names" : isa_list(isas); }

}  // namespace

Expected<DeviceOptions> options_for_worker(const DeviceOptions& job, bool embree, std::span<const Isa> has,
                                           const std::string& worker) {
  if (job.backend == Backend::kOpenCl || std::ranges::find(has, job.isa) != has.end()) return job;
  if (embree) {
    return fail(
        fmt::format("worker {} was refused: this image is traced by Embree with {}, and another instruction "
                    "set may change it; the worker has {}. Choose a set that all workers have by --isa, or "
                    "--intersector portable, which gives the same bits on all of them",
                    worker, isa_name(job.isa), list(has)));
  }
  DeviceOptions options = job;
  // A set below the job's comes first, because no more than the job's was asked for.
  if (!has.empty()) options.isa = std::ranges::min(has);
  for (const Isa isa : has)
    if (isa < job.isa) options.isa = std::max(options.isa, isa);
  return options;
}

}  // namespace penumbra
