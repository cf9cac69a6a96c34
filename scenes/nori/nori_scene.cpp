#include "scenes/nori/nori_scene.h"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <string_view>
#include <utility>

#include "scenes/file_access.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/scene_builder.h"
#include "scenes/mitsuba/xml_source.h"
#include "scenes/nori/nori_tree.h"
#include "scenes/number.h"
#include "scenes/reading.h"

namespace penumbra::nori {
namespace {

/// The only variable of a file: the number of the scene in a <test>.
constexpr std::string_view kTestScene = "scene";

TreeOptions tree_options(Reading& reading) {
  TreeOptions result;
  const ReadOptions& options = reading.options;
  for (const auto& [name, value] : options.defines) {
    const auto number = parse_integer(value);
    if (name != kTestScene)
      reading.diagnostics.error(
          {}, fmt::format(
                  "-D {}={}: a Nori scene has no variables, but for 'scene', the number of one in a <test>",
                  name, value));
    else if (!number || *number < 1 || *number > 1'000'000)
      reading.diagnostics.error({}, fmt::format("-D scene={}: scenes have numbers from 1 on", value));
    else
      result.test_scene = int(*number);
  }
  if (!options.dialect.empty()) {
    const auto dialect = dialects().parse(options.dialect);
    if (dialect)
      result.dialect = *dialect;
    else
      reading.diagnostics.error({}, fmt::format("dialect: {}", dialect.error().message));
  }
  return result;
}

}  // namespace

bool is_scene(const std::filesystem::path& file) {
  const auto source = FileAccess(std::nullopt).read(file, kMaxSceneFileBytes);
  if (!source) return false;
  const std::string& text = (*source)->text;
  if (text.find("<mesh") == text.npos && text.find("<camera") == text.npos && text.find("<test") == text.npos)
    return false;
  pugi::xml_document document;
  if (!mitsuba::parse_xml(**source, document)) return false;
  const pugi::xml_node root = document.document_element();
  const std::string_view name = root.name();
  if (name == "test") return !root.attribute("version");
  // Some files that were derived from Mitsuba files still have a version.
  return name == "scene" && (root.child("camera") || (root.child("mesh") && !root.attribute("version")));
}

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  Reading reading(options);
  const TreeOptions how = tree_options(reading);
  Tree tree = read_tree(file, how, reading.files, reading.diagnostics, reading.report);
  if (reading.failed()) return reading.error();
  mitsuba::ObjectTree& objects = tree.objects;
  SceneDescription scene =
      mitsuba::build_scene({objects, reading.diagnostics, options.lenient, options.settings}, reading.files);
  scene.dialect = describe(tree.dialect);
  return reading.finish(std::move(scene), objects.scene.location);
}

}  // namespace penumbra::nori
