#include "scheduler/sets/job_file.h"

#include <fmt/format.h>
#include <glob.h>

#include <algorithm>
#include <fstream>
#include <map>
#include <set>

#include "scenes/file_access.h"
#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/toml/toml_file.h"
#include "scheduler/render/frames.h"
#include "scheduler/sets/render_arguments.h"

namespace penumbra {
namespace {

namespace fs = std::filesystem;

constexpr std::int64_t kHighestPriority = 1'000'000;

/// A value as text of the command line. Nothing for tables, lists and dates.
std::optional<std::string> text_of(const toml::node& node) {
  if (const auto* text = node.as_string()) return text->get();
  if (const auto* integer = node.as_integer()) return fmt::to_string(integer->get());
  if (const auto* number = node.as_floating_point()) return fmt::to_string(number->get());
  if (const auto* boolean = node.as_boolean()) return boolean->get() ? "true" : "false";
  return std::nullopt;
}

class JobFileReader {
 public:
  explicit JobFileReader(const SourceFile& file) : file_(file) {}

  std::vector<RenderPattern> read(Diagnostics& diagnostics) {
    diagnostics_ = &diagnostics;
    const std::optional<toml::table> root = parse_toml(file_, diagnostics);
    if (!root) return {};
    RenderPattern defaults{.folder = file_.path.parent_path()};
    std::vector<RenderPattern> patterns;
    const toml::array* renders = nullptr;
    for (const auto& [key, node] : in_order(*root)) {
      if (*key == "defaults" && node->is_table())
        read_table(*node->as_table(), defaults);
      else if (*key == "render" && node->is_array() && node->as_array()->is_homogeneous<toml::table>())
        renders = node->as_array();
      else if (*key == "render" || *key == "defaults")
        error(*key, *key == "render"
                        ? "a render is a [[render]] table, with two brackets on each side, because "
                          "there may be several"
                        : "[defaults] is one table, with one bracket on each side");
      else
        error(*key, fmt::format("'{}' is none of a job file's parts: they are [defaults] and [[render]]",
                                key->str()));
    }
    if (renders == nullptr) {
      if (!diagnostics.failed()) diagnostics.error({&file_, 0}, "no [[render]]");
      return patterns;
    }
    for (const toml::node& node : *renders) {
      RenderPattern pattern = defaults;
      pattern.location = toml_location(file_, node.source().begin);
      read_table(*node.as_table(), pattern);
      // The scene is always the first axis.
      const auto scene = std::ranges::find(pattern.axes, AxisKind::kScene, &RenderAxis::kind);
      if (scene != pattern.axes.end())
        std::rotate(pattern.axes.begin(), scene, scene + 1);
      else
        diagnostics.error(pattern.location, "this render has no scene: scene = \"file.xml\"");
      patterns.push_back(std::move(pattern));
    }
    check_order(patterns);
    return patterns;
  }

 private:
  void error(const toml::key& key, std::string_view text) {
    diagnostics_->error(toml_location(file_, key.source().begin), text);
  }
  void error(const toml::node& node, std::string_view text) {
    diagnostics_->error(toml_location(file_, node.source().begin), text);
  }

  void read_table(const toml::table& table, RenderPattern& pattern) {
    for (const auto& [key, node] : in_order(table)) {
      std::string name(key->str());
      std::ranges::replace(name, '_', '-');
      if (name == "scene")
        read_scenes(*node, pattern);
      else if (name == "out")
        read_out(*node, pattern);
      else if (name == "priority")
        read_priority(*node, pattern);
      else if (name == "name")
        read_name(*node, pattern);
      else if (name == "after")
        read_after(*node, pattern);
      else if (name == "frame" || name == "frames")
        read_axis(AxisKind::kFrame, "frame", *node, pattern);
      else if (name == "set" || name == "define")
        read_assignments(name == "set" ? AxisKind::kSetting : AxisKind::kDefine, name, "", *node, pattern);
      else if (const RenderOption* option = find_varied_option(name))
        read_axis(kind_of(*option), option->name(), *node, pattern);
      else if (is_shared_option(name))
        error(*key, fmt::format("'{}' is for all renders together: give it on the command line, as --{}",
                                name, name));
      else
        unknown(*key);
    }
  }

  void unknown(const toml::key& key) {
    std::vector<std::string> known{"scene", "out", "name", "after", "priority", "frames", "set", "define"};
    known.insert(known.end(), varied_option_names().begin(), varied_option_names().end());
    error(key, fmt::format("a render has no '{}'{}", key.str(), known_names(key.str(), known, "It has")));
  }

  /// The values of a list, or a single value.
  std::vector<const toml::node*> values_of(const toml::node& node) {
    const toml::array* array = node.as_array();
    if (array == nullptr) return {&node};
    if (array->empty()) error(node, "a list without values: there would be nothing to render");
    std::vector<const toml::node*> values;
    for (const toml::node& each : *array) values.push_back(&each);
    return values;
  }

  void read_axis(AxisKind kind, const std::string& name, const toml::node& node, RenderPattern& pattern) {
    RenderAxis axis{kind, name, {}};
    for (const toml::node* each : values_of(node)) {
      const auto text = text_of(*each);
      if (!text) {
        error(*each, fmt::format("{}: a text, a number, true or false, or a list of those", name));
        continue;
      }
      if (text->empty() && kind == AxisKind::kOption) {
        error(*each, fmt::format("{}: an empty text", name));
        continue;
      }
      std::vector<std::string> values{*text};
      if (kind == AxisKind::kFrame) {
        auto frames = frames_of(*text);
        if (!frames) {
          error(*each, frames.error().message);
          continue;
        }
        values = std::move(*frames);
      } else if (name == "seed") {
        values = range_of(*text).value_or(values);
      }
      // The values of a range differ only in size, so checking both ends suffices.
      for (const std::string& value : {values.front(), values.back()})
        if (const auto checked = check_value(kind, name, value); !checked) {
          error(*each, checked.error().message);
          break;
        }
      for (const std::string& value : values) {
        if (std::ranges::find(axis.values, value) != axis.values.end() && values.size() == 1)
          error(*each, fmt::format("{}: '{}' twice", name, value));
        axis.values.push_back(value);
      }
    }
    if (!axis.values.empty()) set_axis(pattern.axes, std::move(axis));
  }

  /// Reads name = value pairs; nested tables give names with dots.
  void read_assignments(AxisKind kind, std::string_view what, const std::string& before,
                        const toml::node& node, RenderPattern& pattern) {
    const toml::table* table = node.as_table();
    if (table == nullptr)
      return error(node, fmt::format("{0} is a table: {0}.{1} = 1", what,
                                     kind == AxisKind::kSetting ? "film.width" : "NAME"));
    for (const auto& [key, value] : in_order(*table)) {
      const std::string name = before + std::string(key->str());
      if (value->is_table())
        read_assignments(kind, what, name + ".", *value, pattern);
      else
        read_axis(kind, name, *value, pattern);
    }
  }

  void read_scenes(const toml::node& node, RenderPattern& pattern) {
    RenderAxis axis{AxisKind::kScene, "scene", {}};
    for (const toml::node* each : values_of(node)) {
      const auto* text = each->as_string();
      if (text == nullptr) {
        error(*each, "scene: a file's name, or a list of them");
        continue;
      }
      const bool is_pattern = text->get().find_first_of("*?[") != std::string::npos;
      const fs::path path = pattern.folder / text->get();
      if (!is_pattern) {
        axis.values.push_back(path.string());
        continue;
      }
      if (text->get().contains('{'))
        error(*each,
              "scene: a name with both a field and one of * ? [ ]; frames of files are "
              "\"shot.{frame:04}.xml\"");
      const std::vector<std::string> found = matches(path.string());
      if (found.empty()) error(*each, fmt::format("no file matches {}", path.string()));
      axis.values.insert(axis.values.end(), found.begin(), found.end());
    }
    if (!axis.values.empty()) set_axis(pattern.axes, std::move(axis));
  }

  static std::vector<std::string> matches(const std::string& pattern) {
    glob_t found{};
    std::vector<std::string> names;
    if (glob(pattern.c_str(), 0, nullptr, &found) == 0)
      for (std::size_t i = 0; i < found.gl_pathc; ++i) names.emplace_back(found.gl_pathv[i]);
    globfree(&found);
    return names;
  }

  void read_out(const toml::node& node, RenderPattern& pattern) {
    const auto* text = node.as_string();
    if (text == nullptr || text->get().empty())
      return error(node, "out: a folder, or a name as in \"out/{scene}-{seed:03}.exr\"");
    // A trailing slash, which marks a folder, is kept.
    pattern.out = (pattern.folder / text->get()).string();
  }

  void read_priority(const toml::node& node, RenderPattern& pattern) {
    const auto* number = node.as_integer();
    if (number == nullptr || number->get() < -kHighestPriority || number->get() > kHighestPriority)
      return error(node, fmt::format("priority: a whole number from -{0} to {0}; the highest goes first",
                                     kHighestPriority));
    pattern.priority = int(number->get());
  }

  void read_name(const toml::node& node, RenderPattern& pattern) {
    const auto* text = node.as_string();
    if (text == nullptr || text->get().empty())
      return error(node, "name: a text, by which other renders come after this one");
    pattern.name = text->get();
  }

  void read_after(const toml::node& node, RenderPattern& pattern) {
    pattern.after.clear();
    for (const toml::node* each : values_of(node)) {
      const auto* text = each->as_string();
      if (text == nullptr || text->get().empty())
        error(*each, "after: the name of another render, or a list of names");
      else
        pattern.after.push_back(text->get());
    }
  }

  /// Each name after which a render comes must exist, and none may come after itself.
  void check_order(const std::vector<RenderPattern>& patterns) {
    std::map<std::string, std::set<std::string>> waits;  // of each name, the names that must be done first
    for (const RenderPattern& pattern : patterns)
      if (!pattern.name.empty()) waits[pattern.name].insert(pattern.after.begin(), pattern.after.end());
    std::vector<std::string> names;
    for (const auto& [name, after] : waits) names.push_back(name);
    for (const RenderPattern& pattern : patterns)
      for (const std::string& name : pattern.after)
        if (!waits.contains(name))
          diagnostics_->error(pattern.location, fmt::format("after: no render has the name '{}'{}", name,
                                                            known_names(name, names, "There are")));
    const auto is_free = [&](const auto& entry) {
      return std::ranges::none_of(entry.second,
                                  [&](const std::string& name) { return waits.contains(name); });
    };
    while (std::erase_if(waits, is_free) > 0) {
    }
    for (const RenderPattern& pattern : patterns)
      if (waits.contains(pattern.name))
        return diagnostics_->error(pattern.location,
                                   fmt::format("after: '{}' would come after itself", pattern.name));
  }

  const SourceFile& file_;
  Diagnostics* diagnostics_ = nullptr;
};

}  // namespace

bool is_job_file(const fs::path& file) {
  if (extension_of(file) != ".toml") return false;
  std::ifstream stream(file);
  for (std::string line; std::getline(stream, line);) {
    std::erase_if(line, [](char c) { return c == ' ' || c == '\t'; });
    // Of a file that is meant as one, its reader tells what is wrong with it.
    if (line.starts_with("[[render]]") || line.starts_with("[render]")) return true;
  }
  return false;
}

Expected<JobFile> read_job_file(const fs::path& file) {
  auto source = FileAccess(std::nullopt).read(file, kMaxSceneFileBytes);
  if (!source) return std::unexpected(source.error());
  JobFile job_file{std::move(*source), {}};
  Diagnostics diagnostics;
  job_file.patterns = JobFileReader(*job_file.source).read(diagnostics);
  if (diagnostics.failed()) return std::unexpected(diagnostics.error());
  return job_file;
}

}  // namespace penumbra
