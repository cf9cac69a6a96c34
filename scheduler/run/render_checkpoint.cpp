#include "scheduler/run/render_checkpoint.h"

#include <fmt/format.h>

#include <filesystem>
#include <memory>

#include "scheduler/farm/job_run.h"
#include "scheduler/farm/render_job_check.h"
#include "scheduler/record/version.h"

namespace penumbra {
namespace {

/// The identity, extended by what the state of the film also depends on: the tiles.
RenderIdentity identity_of_checkpoint(const PreparedRender& prepared, const std::string& worker) {
  RenderIdentity identity = identity_of(prepared, worker);
  const RenderJob& job = prepared.job;
  identity.settings.emplace_back("tile", fmt::to_string(job.request.plan.tile));
  identity.settings.emplace_back(
      "crop", fmt::format("{},{},{},{}", job.x, job.y, job.x + job.width, job.y + job.height));
  return identity;
}

std::string what_is_there(const std::filesystem::path& path, const ResumedState& before,
                          const RenderJob& job) {
  const double all = job.request.plan.adaptive ? double(before.merge.samples_expected())
                                               : double(job.spp) * job.width * job.height;
  return fmt::format("going on with {}: {:.1f}% of the samples are there, of {:.1f} s", path.string(),
                     100 * double(before.merge.samples()) / all, before.rendered);
}

Expected<void> read_checkpoint(PreparedRender& prepared) {
  prepared.job.before.reset();
  // An empty film takes a while for large images.
  if (!prepared.checkpoint || !prepared.checkpoint->exists()) return {};
  auto read = prepared.checkpoint->read(merge_of_job(prepared.job));
  if (!read) return std::unexpected(read.error());
  if (*read) prepared.job.before = std::make_shared<ResumedState>(std::move(**read));
  return {};
}

}  // namespace

RenderIdentity identity_of(const PreparedRender& prepared, const std::string& worker) {
  RenderRecord record = prepared.record;
  record.scene.file = std::filesystem::path(record.scene.file).filename().string();
  RenderIdentity identity{.version = std::string(kVersion),
                          .worker = worker,
                          .scene = prepared.job.manifest->hash,
                          .settings = {}};
  for (const auto& [name, value] : record_entries(record))
    identity.settings.emplace_back(name,
                                   std::visit([](const auto& v) { return fmt::format("{}", v); }, value));
  return identity;
}

Expected<std::string> attach_checkpoint(PreparedRender& prepared, const RenderOptions& options,
                                        const std::string& worker) {
  // There is nothing to store for one pixel or for an interactive window.
  if (options.pixel || options.interactive || prepared.files.all().empty()) return "";
  std::filesystem::path path = prepared.files.all().front();
  path += ".checkpoint";
  prepared.checkpoint = std::make_shared<CheckpointFile>(path, identity_of_checkpoint(prepared, worker),
                                                         options.checkpoint_interval);
  prepared.job.checkpoints = prepared.checkpoint;
  // A checkpoint's copy of the film needs memory as well.
  if (const auto checked = check_render_job(prepared.job); !checked) return std::unexpected(checked.error());
  if (options.restart) return "";
  if (auto read = read_checkpoint(prepared); !read)
    return fail(read.error().message + "; with --restart the render begins anew and replaces it");
  if (prepared.job.before) return what_is_there(path, *prepared.job.before, prepared.job);
  return options.resume ? fmt::format("there is no {}: the render starts at the beginning", path.string())
                        : "";
}

Expected<void> fall_back_to_native(PreparedRender& prepared) {
  prepared.job.device.backend = Backend::kNative;
  return prepared.job.before ? read_checkpoint(prepared) : Expected<void>();
}

void remove_checkpoint(PreparedRender& prepared) {
  if (prepared.checkpoint) prepared.checkpoint->remove();
}

}  // namespace penumbra
