#include "scheduler/run/output_files.h"

#include <fmt/format.h>

#include <algorithm>

#include "kernels/host/atomic_file.h"
#include "scenes/names.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

}  // namespace

std::vector<fs::path> OutputFiles::all() const {
  std::vector<fs::path> paths;
  for (const auto& file : {exr, png, statistics, denoised_exr, denoised_png}) {
    if (file) paths.push_back(*file);
  }
  return paths;
}

Expected<OutputFiles> choose_output_files(const RenderOptions& options) {
  OutputFiles files;
  if (options.interactive) return files;
  if (!options.statistics.empty()) files.statistics = options.statistics;
  if (options.pixel && options.out.empty()) return files;

  const fs::path named_after_scene = fs::path(options.scene.file).stem().string() + ".exr";
  fs::path out = options.out.empty() ? named_after_scene : fs::path(options.out);
  std::error_code ignored;
  if (!out.has_filename() || fs::is_directory(out, ignored)) out /= named_after_scene;
  const std::string extension = extension_of(out);
  if (extension != ".exr" && extension != ".png") {
    return fail(
        fmt::format("-o {}: the name must end in .exr or .png, or be a folder that exists", options.out));
  }
  files.png = fs::path(out).replace_extension(extension == ".png" ? out.extension() : ".png");
  if (extension == ".exr") files.exr = out;
  if (!files.statistics && !options.no_statistics)
    files.statistics = fs::path(out).replace_extension(".json");
  if (files.statistics && (files.statistics == files.png || files.statistics == files.exr)) {
    return fail(fmt::format("--statistics {}: that is the image's own name", options.statistics));
  }
  return files;
}

Expected<OutputFiles> image_files(const fs::path& out) {
  const std::string extension = extension_of(out);
  if (extension != ".exr" && extension != ".png")
    return fail(fmt::format("-o {}: the name must end in .exr or .png", out.string()));
  OutputFiles files;
  files.png = fs::path(out).replace_extension(extension == ".png" ? out.extension() : ".png");
  if (extension == ".exr") files.exr = out;
  return files;
}

fs::path denoised_name(const fs::path& image) {
  return image.parent_path() / (image.stem().string() + "-denoised" + image.extension().string());
}

void add_denoised_files(OutputFiles& files) {
  if (files.exr) files.denoised_exr = denoised_name(*files.exr);
  if (files.png) files.denoised_png = denoised_name(*files.png);
}

Expected<void> make_folders(const OutputFiles& files) {
  for (const fs::path& file : files.all()) {
    if (auto made = make_folders(file); !made) return made;
  }
  for (const fs::path& file : files.all()) {
    if (auto writable = check_writable(file); !writable) return writable;
  }
  return {};
}

}  // namespace penumbra
