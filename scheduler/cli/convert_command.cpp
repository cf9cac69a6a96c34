// `penumbra convert`: converts a scene of any format to a Mitsuba 3 file, and an image to a PNG or an EXR.
#include <fmt/format.h>
#include <fmt/ranges.h>

#include <algorithm>
#include <array>
#include <filesystem>
#include <memory>
#include <span>
#include <vector>

#include "scenes/diagnostic.h"
#include "scenes/mitsuba/scene_writer.h"
#include "scenes/names.h"
#include "scenes/scene_reader.h"
#include "scheduler/cli/commands.h"
#include "scheduler/files/output_batch.h"
#include "scheduler/files/output_check.h"
#include "scheduler/image/image_files.h"
#include "scheduler/image/picture.h"
#include "scheduler/render/option_checks.h"
#include "scheduler/run/loaded_scene.h"
#include "worker/cli/help_text.h"

namespace penumbra {
namespace {

constexpr double kMostStops = 64;
constexpr const char* kOtherNameOfClamp = "srgb";
constexpr const char* kImageOptions = "Images";

struct ConvertOptions {
  RenderRequest render;  ///< the input, which may be an image
  std::string output;
  PictureOptions picture;
};

ExitCode bad_usage(const std::string& message) { return print_error({message}), kBadInput; }

/// Options that the command line has of the other kind of input.
std::vector<std::string> out_of_place(const CommandLine& command, bool of_images) {
  std::vector<std::string> names;
  for (const Option* option : command.options())
    if (option->is_given() && !option->is_positional() && (option->group() == kImageOptions) == of_images)
      names.push_back(option->name());
  return names;
}

/// Why the output is not what the input can be converted to; empty: it is.
std::string wrong_output(const ConvertOptions& options) {
  const std::string &input = options.render.scene.file, &output = options.output;
  const std::string extension = extension_of(output);
  if (is_image_name(input))
    return extension == ".png" || extension == ".exr" ? ""
           : extension == ".xml"
               ? fmt::format(
                     "'{}' is an image, of which no scene can be made: `penumbra convert {} OUT.png`, "
                     "or OUT.exr",
                     input, input)
               : fmt::format("'{}' does not end in .png or .exr, to which images are converted", output);
  if (extension == ".xml") return "";
  return is_image_name(output)
             ? fmt::format("'{}' is a scene: `penumbra render {} -o {}` renders an image of it", input, input,
                           output)
             : fmt::format("'{}' does not end in .xml: what is written is Mitsuba 3 XML", output);
}

void warn_of_non_finite(const std::string& file, std::uint64_t pixels, const char* become) {
  if (pixels > 0)
    print_warning(fmt::format("{}: {} NaN or infinite{}", file,
                              pixels == 1 ? "1 pixel is" : fmt::format("{} pixels are", pixels), become));
}

ExitCode write_image(const std::string& output, const Expected<std::vector<std::uint8_t>>& bytes) {
  if (!bytes) return print_error(bytes.error()), kIncomplete;
  if (const auto written = write_output(output, *bytes); !written)
    return print_error(written.error()), kIncomplete;
  return kAllDone;
}

ExitCode convert_image(const ConvertOptions& options, const CommandLine& command) {
  const std::string& input = options.render.scene.file;
  if (const auto names = out_of_place(command, false); !names.empty())
    return bad_usage(fmt::format("{}: for scenes, and '{}' is an image", fmt::join(names, ", "), input));
  const bool to_exr = extension_of(options.output) == ".exr";
  for (const char* name : {"--exposure", "--tonemap"})
    if (to_exr && command.option(name)->is_given())
      return bad_usage(fmt::format("{}: for .png; an .exr holds radiance as it is", name));
  const std::array inputs{std::filesystem::path(input)}, outputs{std::filesystem::path(options.output)};
  if (const auto checked = check_outputs(outputs, inputs); !checked)
    return print_error(checked.error()), kBadInput;
  auto image = read_image(input);
  if (!image) return print_error(image.error()), kBadInput;
  if (to_exr) {
    auto linear = linear_image(*image, options.picture.layer);
    if (!linear) return bad_usage(fmt::format("{}: {}", input, linear.error().message));
    std::erase_if(linear->metadata, [](const auto& entry) { return describes_file(entry.first); });
    warn_of_non_finite(input, non_finite_pixels(*linear), "");
    return write_image(options.output, encode_exr(*linear));
  }
  const auto picture = picture_of(*image, options.picture);
  if (!picture) return bad_usage(fmt::format("{}: {}", input, picture.error().message));
  warn_of_non_finite(input, picture->non_finite, ", magenta in the PNG");
  if (!picture->remark.empty()) print_remark(picture->remark + "\n");
  return write_image(options.output, encode_png_bytes(image->data.width, image->data.height, picture->pixels,
                                                      picture->has_alpha));
}

ExitCode convert_scene(const ConvertOptions& options, const CommandLine& command) {
  if (const auto names = out_of_place(command, true); !names.empty())
    return bad_usage(fmt::format("{}: for images, and '{}' is a scene", fmt::join(names, ", "),
                                 options.render.scene.file));
  // Known before a long scene is read.
  const std::filesystem::path input = options.render.scene.file, output = options.output;
  if (const auto checked = check_outputs(std::span(&output, 1), std::span(&input, 1)); !checked)
    return print_error(checked.error()), kBadInput;
  const auto scene = read_scene_with_options(options.render.scene);
  if (!scene) return print_error(scene.error()), kBadInput;
  for (const std::string& warning : scene->warnings) print_warning(warning);
  std::vector<std::string> refused;
  auto files = mitsuba::scene_files(*scene, options.output, &refused);
  if (!files) return print_error(files.error()), kIncomplete;
  std::vector<std::filesystem::path> outputs;
  for (const mitsuba::SceneFile& file : *files) outputs.push_back(file.path);
  if (const auto checked = check_outputs(outputs, scene->files); !checked)
    return print_error(checked.error()), kBadInput;
  if (const auto made = make_folders(options.output); !made) return print_error(made.error()), kIncomplete;
  OutputBatch batch;
  for (mitsuba::SceneFile& file : *files) {
    const auto bytes = bytes_of(file.contents);
    batch.add(file.path, {bytes.begin(), bytes.end()});
    file.contents.clear();
    file.contents.shrink_to_fit();
  }
  if (const auto done = batch.finish(); !done) return print_error(done.error()), kIncomplete;
  for (const std::string& what : refused) print_warning(fmt::format("{}: {}", options.output, what));
  return kAllDone;
}

ExitCode convert(const ConvertOptions& options, const CommandLine& command) {
  if (const std::string wrong = wrong_output(options); !wrong.empty()) return bad_usage(wrong);
  return is_image_name(options.render.scene.file) ? convert_image(options, command)
                                                  : convert_scene(options, command);
}

void add_image_options(CommandLine& command, PictureOptions& options) {
  command.add_option("--exposure", options.exposure, "Multiply radiance by 2^STOPS")
      ->type_name("STOPS")
      ->check(number_between(-kMostStops, kMostStops))
      ->capture_default_str()
      ->group(kImageOptions);
  std::vector<std::string> tones(kToneOperatorNames.begin(), kToneOperatorNames.end());
  tones.emplace_back(kOtherNameOfClamp);
  command
      .add_option_function(
          "--tonemap",
          [&options](const std::string& name) {
            const auto found = std::ranges::find(kToneOperatorNames, name);
            options.tone = name == kOtherNameOfClamp ? ToneOperator::kClamp
                                                     : ToneOperator(found - kToneOperatorNames.begin());
            return Expected<void>();
          },
          "How radiance fits the display, before the sRGB curve. clamp, srgb: above 1 is white; reinhard: "
          "x / (1 + luminance); filmic: Hable's curve, white at 5.6; aces: Narkowicz's fit")
      ->type_name("NAME")
      ->check(one_of(tones))
      ->default_str("clamp")
      ->group(kImageOptions);
  command
      .add_option("--layer", options.layer,
                  "Layer or channel of an EXR: albedo, normal, depth, samples.Y… (default: for .png the "
                  "beauty layer, for .exr all)")
      ->type_name("NAME")
      ->check(some_text())
      ->group(kImageOptions);
}

}  // namespace

void add_convert_command(CommandLine& app, Command& chosen) {
  CommandLine* command =
      app.add_command("convert", "Write a scene as a Mitsuba 3 file, or an image as PNG or EXR");
  const auto options = std::make_shared<ConvertOptions>();
  command
      ->add_option("INPUT", options->render.scene.file,
                   "Scene file: " + list_names(scene_formats()) +
                       "; or an image: .exr, .hdr, .pfm, .png and others, told by its ending")
      ->required()
      ->group(group::kInput);
  add_scene_overrides(*command, options->render);
  command
      ->add_option("OUTPUT", options->output,
                   "Of a scene .xml, with its meshes beside it; of an image .png or .exr")
      ->required()
      ->group(group::kInput);
  add_image_options(*command, options->picture);
  command->footer(
      "A PNG shows colours with exposure and tone map, normals as 0.5 + 0.5 n, depth and samples over their "
      "range, which is printed, and what is NaN or infinite in magenta. An EXR keeps linear values and "
      "metadata; a PNG becomes linear in it.\n\n"
      "Examples:\n"
      "  penumbra convert scene.toml scene.xml\n"
      "  penumbra convert a.exr a.png --exposure 1.5 --tonemap filmic\n"
      "  penumbra convert a.exr normal.png --layer normal\n"
      "  penumbra convert a.exr albedo.exr --layer albedo");
  command->callback(
      [options, command, &chosen] { chosen = [options, command] { return convert(*options, *command); }; });
}

}  // namespace penumbra
