// `penumbra denoise`: removes noise from an image.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <chrono>
#include <filesystem>
#include <memory>

#include "kernels/host/process.h"
#include "scenes/names.h"
#include "scheduler/cli/commands.h"
#include "scheduler/denoise/denoise_image.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/files/output_check.h"
#include "scheduler/image/image_files.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/run/output_files.h"
#include "scheduler/run/render_options.h"
#include "scheduler/run/render_preparation.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

struct DenoiseCommandOptions {
  std::string image, out;
  DenoiseOptions denoise;
  RenderRequest device;  ///< only the options of the device
};

Expected<OutputFiles> files_of(const DenoiseCommandOptions& options) {
  return image_files(options.out.empty()
                         ? denoised_name(std::filesystem::path(options.image).replace_extension(".exr"))
                         : std::filesystem::path(options.out));
}

ExitCode denoise(DenoiseCommandOptions options) {
  const auto files = files_of(options);
  if (!files) return print_error(files.error()), kBadInput;
  const std::vector<std::filesystem::path> outputs = files->all();
  if (const auto checked = check_outputs(outputs, std::array{std::filesystem::path(options.image)}); !checked)
    return print_error(checked.error()), kBadInput;
  if (const auto checked = check_device_options(options.device); !checked)
    return print_error(checked.error()), kBadInput;
  options.denoise.device = device_of(options.device);
  constexpr std::array<std::string_view, 3> kRadianceFormats{".exr", ".hdr", ".pfm"};
  if (std::ranges::find(kRadianceFormats, extension_of(options.image)) == kRadianceFormats.end())
    return print_error(
               {fmt::format("{}: denoising takes radiance, from an EXR (or .hdr, .pfm); other formats "
                            "hold what a display shows",
                            options.image)}),
           kBadInput;
  const auto noisy = read_image(options.image);
  if (!noisy) return print_error(noisy.error()), kBadInput;
  const auto begin = std::chrono::steady_clock::now();
  const auto outcome = denoise_image(*noisy, options.denoise);
  if (!outcome)
    return print_error({fmt::format("{}: {}", options.image, outcome.error().message)}), kBadInput;
  const double seconds = seconds_since(begin);
  for (const std::string& remark : outcome->remarks)
    print_remark(fmt::format("{}: {}\n", options.image, remark));
  OutputBatch batch;
  const Image& image = outcome->image;
  if (files->exr) batch.add_aside(*files->exr, [&image] { return encode_exr(image); });
  if (files->png) batch.add_aside(*files->png, [&image] { return encode_png(image); });
  if (const auto made = make_folders(*files); !made) return print_error(made.error()), kIncomplete;
  if (const auto done = batch.finish(); !done) return print_error(done.error()), kIncomplete;
  std::vector<std::string> names;
  for (const auto& file : outputs) names.push_back(file.string());
  print_remark(fmt::format("wrote {}: {}, {:.2f} s, {:.1f} s a megapixel\n", fmt::join(names, ", "),
                           method_name(options.denoise.method), seconds,
                           seconds * 1e6 / double(image.pixels())));
  return kAllDone;
}

}  // namespace

void add_denoise_command(CommandLine& app, Command& chosen) {
  CommandLine* command =
      app.add_command("denoise", "Remove noise from an image, with the help of its layers");
  const auto options = std::make_shared<DenoiseCommandOptions>();
  command->add_option("IMAGE", options->image, "EXR to denoise")->check(some_text())->required();
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
      "Examples:\n"
      "  penumbra denoise cornell.exr\n"
      "  penumbra denoise cornell.exr --method nlmeans -o smooth.exr");
  command->callback([options, &chosen] { chosen = [options] { return denoise(*options); }; });
}

}  // namespace penumbra
