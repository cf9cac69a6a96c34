#include "scheduler/cli/set_plan.h"

#include <fmt/format.h>

#include <map>

namespace penumbra {
namespace {

namespace fs = std::filesystem;

/// The name with its fields filled in.
Expected<std::string> fill_in(const std::string& name, const fs::path& scene) {
  const std::map<std::string, std::string> fields = {
      {"scene", scene.stem().string()},
      {"folder", fs::absolute(scene).lexically_normal().parent_path().filename().string()}};
  std::string filled;
  for (std::size_t at = 0; at < name.size();) {
    if (name[at] != '{') {
      filled += name[at++];
      continue;
    }
    const std::size_t end = name.find('}', at);
    if (end == std::string::npos) return fail(fmt::format("-o {}: a '{{' without its '}}'", name));
    const std::string field = name.substr(at + 1, end - at - 1);
    const auto found = fields.find(field);
    if (found == fields.end())
      return fail(
          fmt::format("-o {}: '{{{}}}' is no field of a name; {{scene}} and {{folder}} are", name, field));
    filled += found->second;
    at = end + 1;
  }
  return filled;
}

/// Where the images go, as the name of each before its fields are filled in.
Expected<std::string> name_of_images(const RenderOptions& options) {
  if (options.out.empty()) return "{scene}.exr";
  if (options.out.contains('{')) return options.out;
  const fs::path out = options.out;
  std::error_code ignored;
  if (out.has_filename() && !fs::is_directory(out, ignored) && out.has_extension())
    return fail(fmt::format(
        "-o {}: of several scenes it is a folder, or a name with {{scene}} or {{folder}}, "
        "as in -o '{}/{{scene}}{}'",
        options.out, out.has_parent_path() ? out.parent_path().string() : ".", out.extension().string()));
  return (out / "{scene}.exr").string();
}

}  // namespace

Expected<SetPlan> plan_set(const RenderOptions& options) {
  if (options.pixel) return fail("--pixel is of one scene");
  if (!options.statistics.empty())
    return fail("--statistics FILE is of one scene; of several each has its own beside its image");
  const Expected<std::string> name = name_of_images(options);
  if (!name) return std::unexpected(name.error());
  SetPlan plan;
  std::map<fs::path, std::string> scene_of;  // by output
  for (const std::string& scene : options.scenes) {
    SetMember member{.options = options, .files = {}};
    member.options.scene.scene = scene;
    member.options.scenes = {scene};
    const Expected<std::string> out = fill_in(*name, scene);
    if (!out) return std::unexpected(out.error());
    member.options.out = *out;
    auto files = choose_output_files(member.options);
    if (!files) return std::unexpected(files.error());
    member.files = std::move(*files);
    for (const fs::path& file : member.files.all()) {
      const auto [taken, is_new] = scene_of.emplace(fs::absolute(file).lexically_normal(), scene);
      if (!is_new)
        return fail(
            fmt::format("{} and {} would both be written to {}; tell them apart with {{folder}} in -o",
                        taken->second, scene, file.string()));
    }
    plan.members.push_back(std::move(member));
  }
  plan.summary = options.summary.empty()
                     ? plan.members.front().files.all().front().parent_path() / "jobs.json"
                     : fs::path(options.summary);
  if (const auto taken = scene_of.find(fs::absolute(plan.summary).lexically_normal());
      taken != scene_of.end())
    return fail(
        fmt::format("{} is a file of the scene {} and the summary", plan.summary.string(), taken->second));
  return plan;
}

}  // namespace penumbra
