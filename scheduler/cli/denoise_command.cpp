// `penumbra denoise`: removes noise from an image.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>
#include <set>

#include "kernels/host/process.h"
#include "scenes/names.h"
#include "scheduler/cli/commands.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/denoise/shot.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/files/output_check.h"
#include "scheduler/image/image_files.h"
#include "scheduler/render/frame_files.h"
#include "scheduler/render/frames.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/run/output_files.h"
#include "scheduler/run/render_options.h"
#include "scheduler/run/render_preparation.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

struct DenoiseCommandOptions {
  std::string image, out, frames;
  int time_radius = kTimeRadius;
  DenoiseOptions denoise;
  RenderRequest device;  ///< only the options of the device
};

std::filesystem::path out_of(const DenoiseCommandOptions& options) {
  return options.out.empty() ? denoised_name(std::filesystem::path(options.image).replace_extension(".exr"))
                             : std::filesystem::path(options.out);
}

/// Whether a file can hold radiance, by its name.
Expected<void> check_radiance(const std::filesystem::path& image) {
  constexpr std::array<std::string_view, 3> kRadianceFormats{".exr", ".hdr", ".pfm"};
  if (std::ranges::find(kRadianceFormats, extension_of(image)) != kRadianceFormats.end()) return {};
  return fail(
      fmt::format("{}: denoising takes radiance, from an EXR (or .hdr, .pfm); other formats hold what a "
                  "display shows",
                  image.string()));
}

void print_remarks(const std::filesystem::path& image, const std::vector<std::string>& remarks) {
  for (const std::string& remark : remarks) print_remark(fmt::format("{}: {}\n", image.string(), remark));
}

Expected<void> write_files(const Image& image, const OutputFiles& files) {
  OutputBatch batch;
  // In this order: where the EXR is up to date, the PNG is, too.
  if (files.png) batch.add_aside(*files.png, [&image] { return encode_png(image); });
  if (files.exr) batch.add_aside(*files.exr, [&image] { return encode_exr(image); });
  if (auto made = make_folders(files); !made) return made;
  return batch.finish();
}

void print_written(const OutputFiles& files, const DenoiseCommandOptions& options, double seconds,
                   std::size_t pixels) {
  std::vector<std::string> names;
  for (const auto& file : files.all()) names.push_back(file.string());
  print_remark(fmt::format("wrote {}: {}, {:.2f} s, {:.1f} s a megapixel\n", fmt::join(names, ", "),
                           method_name(options.denoise.method), seconds, seconds * 1e6 / double(pixels)));
}

ExitCode denoise_still(const DenoiseCommandOptions& options) {
  const auto files = image_files(out_of(options));
  if (!files) return print_error(files.error()), kBadInput;
  if (const auto checked = check_outputs(files->all(), std::array{std::filesystem::path(options.image)});
      !checked)
    return print_error(checked.error()), kBadInput;
  const auto noisy = read_image(options.image);
  if (!noisy) return print_error(noisy.error()), kBadInput;
  const auto begin = std::chrono::steady_clock::now();
  const auto outcome = denoise_image(*noisy, options.denoise);
  if (!outcome)
    return print_error({fmt::format("{}: {}", options.image, outcome.error().message)}), kBadInput;
  const double seconds = seconds_since(begin);
  print_remarks(options.image, outcome->remarks);
  if (const auto written = write_files(outcome->image, *files); !written)
    return print_error(written.error()), kIncomplete;
  print_written(*files, options, seconds, outcome->image.pixels());
  return kAllDone;
}

/// A shot's frames, ascending, and which of them are asked for.
struct Shot {
  std::vector<NoisyFrame> frames;  ///< all that are there, and those that are asked for
  std::vector<std::size_t> asked;
  std::vector<OutputFiles> files;  ///< of those
};

Expected<Shot> shot_of(const DenoiseCommandOptions& options, const FrameFiles& images) {
  const auto out = FrameFiles::of(out_of(options).string());
  if (!out)
    return fail(fmt::format("-o {}: the name has no field for the frame, such as {}", options.out,
                            with_hashes(with_frame_field(options.out))));
  const std::vector<int> there = images.find();
  std::set<int> asked(there.begin(), there.end());
  if (!options.frames.empty()) {
    const auto frames = frames_of(options.frames);
    if (!frames) return fail("--frames: " + frames.error().message);
    asked.clear();
    for (const std::string& frame : *frames) asked.insert(std::stoi(frame));
  }
  if (asked.empty()) return fail(fmt::format("{}: there is no such file", options.image));
  std::set<int> all = asked;
  all.insert(there.begin(), there.end());
  Shot shot;
  std::vector<std::filesystem::path> inputs, outputs;
  for (const int number : all) {
    auto files = image_files(out->file(number));
    if (!files) return std::unexpected(files.error());
    inputs.push_back(images.file(number));
    shot.frames.push_back({number, inputs.back(), files->exr.value_or(""), files->png.value_or("")});
    if (!asked.contains(number)) continue;
    for (const auto& file : files->all()) outputs.push_back(file);
    shot.asked.push_back(shot.frames.size() - 1);
    shot.files.push_back(std::move(*files));
  }
  if (const auto checked = check_outputs(outputs, inputs); !checked) return std::unexpected(checked.error());
  return shot;
}

/// Frames that fail do not keep the others from being denoised.
ExitCode denoise_shot(const DenoiseCommandOptions& options, const FrameFiles& images) {
  const auto shot = shot_of(options, images);
  if (!shot) return print_error(shot.error()), kBadInput;
  ShotDenoiser denoiser(shot->frames, options.denoise, options.time_radius);
  ExitCode code = kAllDone;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < shot->asked.size(); ++i) {
    const auto begin = std::chrono::steady_clock::now();
    const FrameOutcome outcome = denoiser.denoise(shot->asked[i]);
    const double seconds = seconds_since(begin);
    print_remarks(shot->frames[shot->asked[i]].noisy, outcome.remarks);
    if (outcome.kind == FrameOutcome::Kind::kKept) {
      ++kept;
    } else if (outcome.kind == FrameOutcome::Kind::kFailed) {
      print_error({outcome.error});
      code = kIncomplete;
    } else if (const auto written = write_files(outcome.image, shot->files[i]); !written) {
      print_error(written.error());
      code = kIncomplete;
    } else {
      print_written(shot->files[i], options, seconds, outcome.image.pixels());
    }
  }
  if (kept > 0) print_remark(fmt::format("kept {}, as they would be the same\n", counted(kept, "frame")));
  return code;
}

ExitCode denoise(DenoiseCommandOptions options) {
  if (const auto checked = check_device_options(options.device); !checked)
    return print_error(checked.error()), kBadInput;
  options.denoise.device = device_of(options.device);
  if (const auto checked = check_radiance(options.image); !checked)
    return print_error(checked.error()), kBadInput;
  if (const auto images = FrameFiles::unless_file(options.image)) return denoise_shot(options, *images);
  if (!options.frames.empty())
    return print_error({fmt::format("--frames: {} has no field for the frame, such as ####", options.image)}),
           kBadInput;
  return denoise_still(options);
}

}  // namespace

void add_denoise_command(CommandLine& app, Command& chosen) {
  CommandLine* command =
      app.add_command("denoise", "Remove noise from an image, with the help of its layers");
  const auto options = std::make_shared<DenoiseCommandOptions>();
  command->add_option("IMAGE", options->image, "EXR to denoise, or the frames of a shot: 'shot.####.exr'")
      ->check(some_text())
      ->required();
  command
      ->add_option("-o,--out", options->out,
                   "x.exr writes x.exr and x.png, x.png only that (default: IMAGE-denoised.exr)")
      ->type_name("FILE")
      ->group(group::kOutput);
  command
      ->add_choice(
          "--method",
          {{"nfor", int(Denoise::kNfor)}, {"nlmeans", int(Denoise::kNlMeans)}, {"oidn", int(Denoise::kOidn)}},
          [method = &options->denoise.method](int chosen_method) { *method = Denoise(chosen_method); },
          "nfor: first-order regression on albedo, normal and depth; nlmeans: non-local means; oidn: "
          "Intel Open Image Denoise, if its library is installed")
      ->default_str("nfor")
      ->type_name("NAME")
      ->group("Method");
  command->add_option("--frames", options->frames, "These frames, as in 1-250 (default: all that are there)")
      ->type_name("LIST")
      ->group(group::kFrames);
  command
      ->add_option("--time-radius", options->time_radius,
                   "Frames before, and after, that a frame takes light from; 0: each by itself")
      ->check(whole_number(0, kMostTimeRadius))
      ->capture_default_str()
      ->type_name("N")
      ->group(group::kFrames);
  constexpr const char* kNlMeans = "Non-local means";
  NlMeansOptions& nl_means = options->denoise.nl_means;
  command->add_option("--search-radius", nl_means.search_radius, "Neighbours: (2N + 1)² pixels")
      ->check(whole_number(0, MAX_SEARCH_RADIUS))
      ->capture_default_str()
      ->type_name("N")
      ->group(kNlMeans);
  command->add_option("--patch-radius", nl_means.patch_radius, "Patches that are compared: (2N + 1)² pixels")
      ->check(whole_number(0, MAX_PATCH_RADIUS))
      ->capture_default_str()
      ->type_name("N")
      ->group(kNlMeans);
  command
      ->add_option("--strength", nl_means.strength,
                   "Difference in standard deviations that still counts as noise")
      ->check(number_between(0.01, 100))
      ->default_str("0.45")
      ->type_name("N")
      ->group(kNlMeans);
  add_device_options(*command, options->device);
  command->footer(
      "`penumbra render --denoise` renders and denoises; with --denoise=layers it writes what this command "
      "needs best: two halves of the samples, and the variances of all layers. Without them, and for images "
      "of other renderers, it makes do with what there is and says so. The image itself is not changed.\n\n"
      "Frames of a shot flicker less if they have the layer motion (render --frames 1-250 --denoise=layers "
      "--layers "
      "motion), and noise of their own (--seed-per-frame frame). Denoised frames that would be the same are "
      "kept.\n\n"
      "Examples:\n"
      "  penumbra denoise cornell.exr\n"
      "  penumbra denoise cornell.exr --method nlmeans -o smooth.exr\n"
      "  penumbra denoise 'shot.####.exr'");
  command->callback([options, &chosen] { chosen = [options] { return denoise(*options); }; });
}

}  // namespace penumbra
