#include "scheduler/sets/set_plan.h"

#include <fmt/format.h>

#include <algorithm>
#include <functional>
#include <iterator>
#include <map>
#include <numeric>

#include "kernels/host/atomic_file.h"
#include "scenes/names.h"
#include "scenes/settings.h"
#include "scheduler/files/output_check.h"
#include "scheduler/files/quoting.h"
#include "scheduler/render/frames.h"
#include "scheduler/sets/job_file.h"
#include "scheduler/sets/render_arguments.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostRenders = 100'000;

/// The error with its location, if it has one.
std::unexpected<Error> fail_at(SourceLocation location, const std::string& text) {
  return fail(location.file != nullptr ? describe(location) + ": " + text : text);
}

bool has_frames(const RenderPattern& pattern) {
  return std::ranges::find(pattern.axes, AxisKind::kFrame, &RenderAxis::kind) != pattern.axes.end();
}

/// A name that distinguishes this pattern's images: the varied parameters, and the frame of a shot.
std::string default_name(const RenderPattern& pattern) {
  std::string name = "{scene}";
  for (const RenderAxis& axis : pattern.axes)
    if (axis.values.size() > 1 && axis.kind != AxisKind::kScene && axis.kind != AxisKind::kFrame)
      name += "-{" + axis.name + "}";
  name += ".exr";
  return has_frames(pattern) ? with_frame_field(name) : name;
}

/// The name pattern for the images, before its fields are substituted.
Expected<std::string> name_of_images(const std::string& given, const RenderPattern& pattern) {
  if (given.empty()) return default_name(pattern);
  std::string out = given;
  std::error_code is_missing;
  if (has_frames(pattern) && fs::path(out).has_extension() && !fs::is_directory(out, is_missing))
    out = with_frame_field(out);
  if (out.contains('{')) return out;
  const fs::path path = out;
  std::error_code ignored;
  if (path.has_filename() && !fs::is_directory(path, ignored) && path.has_extension() &&
      count_combinations(pattern.axes, kMostRenders) != 1)
    return fail(fmt::format("{}: of several images it is a folder, or a name with fields, as in '{}/{}{}'",
                            out, path.has_parent_path() ? path.parent_path().string() : ".",
                            fs::path(default_name(pattern)).stem().string(), path.extension().string()));
  if (path.has_filename() && path.has_extension() && !fs::is_directory(path, ignored)) return out;
  return (path / default_name(pattern)).string();
}

/// The longest common parent folder.
fs::path common_folder(const fs::path& a, const fs::path& b) {
  fs::path common;
  const auto differ = std::mismatch(a.begin(), a.end(), b.begin(), b.end());
  for (auto part = a.begin(); part != differ.first; ++part) common /= *part;
  return common;
}

/// Whether the options say that there is a denoised image beside the image. No scene file says so.
bool asks_for_denoising(const SceneOptions& options) {
  RenderSettings settings;
  const auto apply = [&](std::string_view value) {
    (void)apply_setting(settings, "film.denoise", value);  // errors are those of reading the scene
  };
  for (const std::string& assignment : options.settings) {
    const std::size_t equals = std::min(assignment.find('='), assignment.size());
    if (to_snake_case(assignment.substr(0, equals)) == "film.denoise")
      apply(std::string_view(assignment).substr(std::min(equals + 1, assignment.size())));
  }
  if (!options.denoise.empty()) apply(options.denoise);
  return is_denoised(settings.film);
}

class SetPlanner {
 public:
  SetPlanner(const RenderOptions& options, const CommandLine& command)
      : options_(options), given_(axes_of_command(command)) {}

  Expected<SetPlan> plan() {
    RenderPattern scenes{.axes = {{AxisKind::kScene, "scene", {}}}};
    std::vector<std::pair<std::size_t, RenderPattern>> patterns;
    for (const std::string& scene : options_.scenes) {
      if (!is_job_file(scene)) {
        std::error_code ignored;
        const bool is_pattern =
            !options_.frames.empty() && scene.contains('#') && !fs::exists(scene, ignored);
        scenes.axes.front().values.push_back(is_pattern ? with_frame_field(scene) : scene);
        continue;
      }
      auto file = read_job_file(scene);
      if (!file) return std::unexpected(file.error());
      for (const RenderPattern& pattern : file->patterns)
        if (const auto added = add(pattern); !added) return std::unexpected(added.error());
      files_.push_back(std::move(*file));
    }
    if (!scenes.axes.front().values.empty())
      if (const auto added = add(scenes); !added) return std::unexpected(added.error());
    order_members();
    choose_alike();
    const std::size_t more = options_.scenes.size() - 1;
    plan_.name = fs::path(options_.scenes.front()).filename().string();
    if (more > 0) plan_.name += fmt::format(" and {} more", more);
    plan_.has_job_file = !files_.empty();
    plan_.summary = options_.summary.empty() ? default_summary() : fs::path(options_.summary);
    if (const auto taken = take_file(plan_.summary, "the summary"); !taken)
      return std::unexpected(taken.error());
    if (!options_.table.empty())
      if (const auto taken = take_file(options_.table, "--table"); !taken)
        return std::unexpected(taken.error());
    if (const auto found = find_shots(); !found) return std::unexpected(found.error());
    return std::move(plan_);
  }

 private:
  Expected<void> add(RenderPattern pattern) {
    for (const RenderAxis& axis : given_) set_axis(pattern.axes, axis);
    for (RenderAxis& axis : pattern.axes)
      if (axis.kind == AxisKind::kFrame && options_.preview_order) axis.values = preview_order(axis.values);
    const auto name = name_of_images(options_.out.empty() ? pattern.out.value_or("") : options_.out, pattern);
    if (!name)
      return fail_at(pattern.location, (options_.out.empty() ? "out " : "-o ") + name.error().message);
    const std::size_t count = count_combinations(pattern.axes, kMostRenders - members_.size());
    if (count == 0)
      return fail_at(pattern.location, fmt::format("more than {} renders in all", kMostRenders));
    for (const RenderChoice& choice : all_choices(pattern.axes))
      if (const auto added = add(pattern, choice, *name); !added)
        return fail_at(pattern.location, added.error().message);
    return {};
  }

  Expected<void> add(const RenderPattern& pattern, RenderChoice choice, const std::string& name) {
    const std::vector<RenderAxis>& axes = pattern.axes;
    NameFields fields;
    // File names of a command line are taken as given, but for the field of a frame.
    const bool frame_is_a_file = has_frames(pattern) && has_field(choice.front(), "frame");
    const bool has_fields = pattern.location.file != nullptr || frame_is_a_file;
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if (axes[i].kind == AxisKind::kDefine && axes[i].name == "frame" && has_frames(pattern))
        return fail("-D frame: $frame is the number of the frame already");
      if (axes[i].kind != AxisKind::kScene) fields[axes[i].name] = choice[i];
    }
    const fs::path scene_pattern = choice.front();
    for (std::size_t i = 0; i < axes.size(); ++i) {
      if (!has_fields || (axes[i].kind != AxisKind::kScene && axes[i].kind != AxisKind::kDefine)) continue;
      auto filled = fill_in(choice[i], fields);
      if (!filled) return std::unexpected(filled.error());
      choice[i] = std::move(*filled);
    }
    const fs::path scene = choice.front();
    for (auto& [field, value] : fields) value = file_name_of(value);
    fields["scene"] = scene.stem().string();
    fields["folder"] = fs::absolute(scene).lexically_normal().parent_path().filename().string();
    auto out = fill_in(name, fields);
    if (!out) return fail((options_.out.empty() ? "out " : "-o ") + out.error().message);
    auto options = options_of(axes, choice, options_);
    if (!options) return std::unexpected(options.error());
    options->scene.frame_is_a_file = frame_is_a_file;
    options->scene.blends_frames = options->scene.frame.has_value() && options_.time_radius > 0;
    SetMember member{.options = std::move(*options), .priority = pattern.priority, .name = scene.string()};
    member.options.out = std::move(*out);
    for (std::size_t i = 1; i < axes.size(); ++i) {
      member.choices.emplace_back(axes[i].name, choice[i]);
      if (axes[i].values.size() > 1) member.name += fmt::format(" {}={}", axes[i].name, choice[i]);
    }
    auto files = choose_output_files(member.options);
    if (!files) return std::unexpected(files.error());
    member.files = std::move(*files);
    if (asks_for_denoising(member.options.scene)) add_denoised_files(member.files);
    member.shot = has_frames(pattern) ? shot_of(name, scene_pattern, fields) : "";
    if (const auto taken = take_files(member); !taken) return taken;
    if (options_.out.empty() && pattern.out) member.base = fs::current_path() / pattern.folder;
    names_[{files_.size(), pattern.name}].push_back(members_.size());
    members_.push_back({std::move(member), files_.size(), pattern.after});
    return {};
  }

  /// SetMember::shot. `fields`: of the member's names. The scene's name may have the frame's number too.
  static std::string shot_of(const std::string& name, const fs::path& scene_pattern, NameFields fields) {
    if (const auto file = FrameFiles::of(scene_pattern.stem().string()))
      fields["scene"] = file->without_field().string();
    fields.erase("frame");
    return fill_in(with_hashes(name), fields).value_or("");
  }

  /// Tells frames that choose their integrator where their shot begins.
  void choose_alike() {
    std::map<std::string, int> begins;
    for (const SetMember& member : plan_.members)
      if (const auto frame = member.options.scene.frame; frame && !member.shot.empty()) {
        const auto [begin, is_new] = begins.emplace(member.shot, *frame);
        begin->second = std::min(begin->second, *frame);
      }
    for (SetMember& member : plan_.members)
      if (member.options.scene.integrator == kAutoIntegrator && begins.contains(member.shot))
        member.options.scene.shot_begin = begins.at(member.shot);
  }

  /// The shots of the members, which are in their order.
  Expected<void> find_shots() {
    std::map<std::string, std::size_t> places;
    for (std::size_t i = 0; i < plan_.members.size(); ++i) {
      const SetMember& member = plan_.members[i];
      if (member.shot.empty() || !member.files.png) continue;
      const fs::path images = fs::absolute(member.shot).lexically_normal();
      const auto pictures =
          FrameFiles::of(fs::path(images).replace_extension(member.files.png->extension()).string());
      if (!pictures) continue;
      const auto [place, is_new] = places.emplace(member.shot, plan_.shots.size());
      if (is_new) plan_.shots.push_back({.pictures = *pictures});
      plan_.shots[place->second].frames.emplace_back(*member.options.scene.frame, i);
    }
    if (!options_.video.empty()) {
      if (plan_.shots.size() != 1)
        return fail(plan_.shots.empty()
                        ? "--video is of frames: choose them with --frames, or in a job file"
                        : fmt::format("--video is of one shot, not of {}", plan_.shots.size()));
      if (const auto taken = take_file(options_.video, "--video"); !taken) return taken;
    }
    for (SetShot& shot : plan_.shots) {
      std::ranges::sort(shot.frames);
      if (options_.no_sheet) continue;
      const std::string& images = plan_.members[shot.frames.front().second].shot;
      const fs::path name = FrameFiles::of(images)->without_field();
      const std::string stem = name.stem().string();
      // Where the name was the number alone.
      const bool has_name = !stem.empty() && !stem.starts_with('.');
      // Where that is taken, as by "a_####.exr" of "a.####.exr", the whole name tells the sheets apart.
      for (const std::string& sheet : {has_name ? stem + "-contact.png" : std::string("contact.png"),
                                       fs::path(images).stem().string() + "-contact.png"})
        if (const fs::path file = name.parent_path() / sheet; take_file(file, "the contact sheet")) {
          shot.sheet = file;
          break;
        }
    }
    return {};
  }

  /// Moves the members to the plan: by priority, each after its predecessors.
  void order_members() {
    std::vector<std::size_t> left(members_.size()), places(members_.size());
    std::iota(left.begin(), left.end(), 0);
    std::ranges::sort(left, {}, [&](std::size_t i) { return std::pair(-members_[i].member.priority, i); });
    std::vector<bool> is_placed(members_.size());
    const auto is_next = [&](std::size_t i) {
      return std::ranges::all_of(members_[i].after, [&](const std::string& name) {
        return std::ranges::all_of(names_.at({members_[i].file, name}),
                                   [&](std::size_t before) { return bool(is_placed[before]); });
      });
    };
    while (!left.empty()) {
      std::vector<std::size_t> waiting;
      for (const std::size_t i : left) {
        if (!is_next(i)) {
          waiting.push_back(i);
          continue;
        }
        for (const std::string& name : members_[i].after)
          for (const std::size_t before : names_.at({members_[i].file, name}))
            members_[i].member.after.push_back(places[before]);
        is_placed[i] = true;
        places[i] = plan_.members.size();
        plan_.members.push_back(std::move(members_[i].member));
      }
      left = std::move(waiting);  // gets shorter: no render comes after itself
    }
  }

  /// The summary is beside the first job file, so that its place does not depend on which renders there are.
  /// If the command says where the images go, or if there are no job files, it is in the common folder of all
  /// images. Each job file has its own: NAME.jobs.json, and jobs.json of jobs.toml.
  [[nodiscard]] fs::path default_summary() const {
    const fs::path job_file = files_.empty() ? fs::path("jobs.toml") : files_.front().source->path;
    const std::string stem = job_file.stem().string();
    const std::string name = stem == "jobs" ? "jobs.json" : stem + ".jobs.json";
    if (!files_.empty() && options_.out.empty()) {
      fs::path beside = job_file.parent_path() / name;
      if (check_writable(beside)) return beside;
    }
    fs::path common = plan_.members.front().files.all().front().parent_path();
    for (const SetMember& member : plan_.members)
      for (const fs::path& file : member.files.all()) common = common_folder(common, file.parent_path());
    return common / name;
  }

  Expected<void> take_file(const fs::path& file, const char* what) {
    const auto identity = identity_of_output(file);
    if (!identity) return {};
    const auto [taken, is_new] = taken_by_.emplace(*identity, what);
    if (is_new) return {};
    return fail(fmt::format("{} is a file of {} and {}", file.string(), taken->second, what));
  }

  /// Error if two renders write the same file.
  Expected<void> take_files(const SetMember& member) {
    for (const fs::path& file : member.files.all()) {
      const auto identity = identity_of_output(file);
      if (!identity) continue;
      const auto [taken, is_new] = taken_by_.emplace(*identity, member.name);
      if (!is_new)
        return fail(
            fmt::format("{} and {} would both be written to {}; tell them apart with fields of the name, "
                        "such as {{folder}}",
                        taken->second, member.name, file.string()));
    }
    return {};
  }

  const RenderOptions& options_;
  const std::vector<RenderAxis> given_;
  std::vector<JobFile> files_;
  struct Unordered {
    SetMember member;
    std::size_t file;  // names are those of one job file
    std::vector<std::string> after;
  };
  std::vector<Unordered> members_;
  std::map<std::pair<std::size_t, std::string>, std::vector<std::size_t>> names_;  // members of a file's name
  SetPlan plan_;
  std::map<FileIdentity, std::string> taken_by_;
};

}  // namespace

Expected<SetPlan> plan_set(const RenderOptions& options, const CommandLine& command) {
  if (options.pixel) return fail("--pixel is of one scene");
  if (!options.statistics.empty())
    return fail("--statistics FILE is of one scene; of several each has its own beside its image");
  return SetPlanner(options, command).plan();
}

std::vector<const SceneOptions*> scenes_of(const SetPlan& plan) {
  std::vector<const SceneOptions*> scenes;
  for (const SetMember& member : plan.members) scenes.push_back(&member.options.scene);
  return scenes;
}

}  // namespace penumbra
