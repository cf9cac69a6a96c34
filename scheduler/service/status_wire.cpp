#include "scheduler/service/status_wire.h"

#include <algorithm>

#include "kernels/host/process.h"
#include "worker/protocol/text.h"
#include "worker/protocol/wire.h"

namespace penumbra {

wire::FarmWorker encode(const FarmWorker& worker) {
  wire::FarmWorker message;
  message.set_number(worker.id);
  message.set_name(wire_text(worker.name, kLongestName));
  message.set_device(wire_text(worker.device, kLongestName));
  message.set_units(worker.units);
  message.set_samples(worker.samples);
  message.set_busy_seconds(worker.busy_seconds);
  message.set_job(worker.job.value_or(0));
  message.set_since_seconds(worker.since);
  return message;
}

void put_progress(const RenderProgress& progress, wire::JobStatus& status) {
  if (status.state() == wire::JOB_QUEUED && progress.elapsed_seconds > 0) {
    status.set_state(wire::JOB_RENDERING);
    if (status.begun() == 0) status.set_begun(unix_time() - progress.elapsed_seconds);
  }
  status.set_samples_done(progress.samples_done);
  status.set_samples_total(progress.samples_total);
  status.set_samples_before(progress.samples_before);
  status.set_elapsed_seconds(progress.elapsed_seconds);
  status.set_relative_error(progress.relative_error);
  status.set_workers(std::uint32_t(std::max(0, progress.workers)));
}

bool add_file(const std::filesystem::path& file, wire::JobStatus& status) {
  std::error_code missing;
  const std::uintmax_t bytes = std::filesystem::file_size(file, missing);
  if (missing) return false;
  wire::StoredFile& added = *status.add_files();
  added.set_name(wire_text(file.filename().string(), kLongestName));
  added.set_bytes(bytes);
  return true;
}

}  // namespace penumbra
