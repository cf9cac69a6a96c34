#include "scheduler/cli/service/submitted_render.h"

#include <fmt/format.h>
#include <pwd.h>
#include <unistd.h>

#include <algorithm>

#include "kernels/host/process.h"

#include "scheduler/denoise/denoise_image.h"
#include "scheduler/farm/render_job_check.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// In the service's folder each kind of file has one fixed extension.
std::string stored_name(const std::filesystem::path& path, const char* extension) {
  return std::filesystem::path(path.filename()).replace_extension(extension).string();
}

/// The folder of the member's files as the job file gives it, relative to that file's; empty if that is not
/// below it.
std::string stored_folder(const SetMember& member) {
  if (member.base.empty()) return {};
  const auto absolute = [](const fs::path& path) { return fs::absolute(path).lexically_normal(); };
  const fs::path folder = absolute(member.files.all().front()).parent_path();
  const std::string below = folder.lexically_relative(absolute(member.base / "")).string();
  return is_result_folder(below) ? below : "";
}

/// Of this process: USER@HOST.
std::string submitter_name() {
  const passwd* user = getpwuid(geteuid());
  return fmt::format("{}@{}", user != nullptr ? user->pw_name : fmt::to_string(geteuid()), host_name());
}

}  // namespace

Submission submission_of(const PreparedRender& prepared, const SetMember& member,
                         const std::vector<std::string>& command_line) {
  const RenderJob& job = prepared.job;
  Submission submission{.name = member.name,
                        .scene = job.manifest->hash,
                        .priority = member.priority,
                        .record = prepared.record,
                        .warnings = prepared.scene.description.warnings,
                        .needs = prepared.scene.summary.needs,
                        .left_out = prepared.scene.summary.left_out,
                        .build_seconds = prepared.scene.seconds,
                        .command_line = command_line,
                        .mattes = prepared.scene.mattes,
                        .folder = stored_folder(member),
                        .submitter = submitter_name(),
                        .frame = member.options.scene.frame,
                        .choice = prepared.scene.choice};
  submission.record.threads = 0;  // the service has its own
  std::ranges::copy(job.center, submission.center.begin());
  const OutputFiles& files = prepared.files;
  if (files.exr) submission.files.push_back(stored_name(*files.exr, ".exr"));
  if (files.png) submission.files.push_back(stored_name(*files.png, ".png"));
  if (files.statistics) submission.files.push_back(stored_name(*files.statistics, ".json"));
  // Denoised images come after those that they are made of.
  if (files.denoised_exr) submission.files.push_back(stored_name(*files.denoised_exr, ".exr"));
  if (files.denoised_png) submission.files.push_back(stored_name(*files.denoised_png, ".png"));
  return submission;
}

Expected<PreparedRender> prepared_of(const Submission& submission, StoredScene stored,
                                     const std::filesystem::path& folder, int threads, int workers) {
  const RenderRecord& record = submission.record;
  const SceneHeader& header = stored.scene.header;
  if (header.film.width != record.film.width || header.film.height != record.film.height)
    return fail(fmt::format("the scene's film has {} x {} pixels, that of the settings {} x {}",
                            header.film.width, header.film.height, record.film.width, record.film.height));
  if ((record.scene.intersector == "embree") != (header.intersector == INTERSECTOR_EMBREE))
    return fail("the scene's intersector is not that of the settings");
  const bool has_mattes = (header.features & FEATURE_MATTES) != 0u;
  if (record.scene.cryptomatte != has_mattes ||
      submission.mattes.mattes.size() != std::size_t(header.matte_count))
    return fail("the scene's mattes are not those of the settings");
  if (const auto denoiser = check_denoiser(record.film.denoise); !denoiser)
    return std::unexpected(denoiser.error());
  PreparedRender prepared;
  for (const std::string& name : submission.files) {
    const std::filesystem::path path = folder / name;
    OutputFiles& files = prepared.files;
    (path.extension() == ".exr"   ? (files.exr ? files.denoised_exr : files.exr)
     : path.extension() == ".png" ? (files.png ? files.denoised_png : files.png)
                                  : files.statistics) = path;
  }
  prepared.record = record;
  prepared.record.threads = threads;
  prepared.scene.description.warnings = submission.warnings;
  prepared.scene.summary.needs = submission.needs;
  prepared.scene.summary.left_out = submission.left_out;
  prepared.scene.seconds = submission.build_seconds;
  prepared.scene.choice = submission.choice;
  prepared.scene.mattes = submission.mattes;
  prepared.job = job_of_record(prepared.record, device_of(prepared.record), std::move(stored.scene),
                               std::move(stored.manifest));
  show_choice(prepared);
  prepared.job.priority = submission.priority;
  prepared.job.submitter = submission.submitter;
  std::ranges::copy(submission.center, prepared.job.center);
  prepared.farm.workers = workers;
  if (const auto checked = check_render_job(prepared.job); !checked) return std::unexpected(checked.error());
  return prepared;
}

}  // namespace penumbra
