#include "scenes/nori/nori_scene.h"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <string_view>

#include "scenes/file_access.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/scene_builder.h"
#include "scenes/mitsuba/xml_source.h"
#include "scenes/nori/nori_tree.h"
#include "scenes/settings.h"

namespace penumbra::nori {

bool is_scene(const std::filesystem::path& file) {
  const auto source = FileAccess(std::nullopt).read(file, kMaxSceneFileBytes);
  if (!source) return false;
  const std::string& text = (*source)->text;
  if (text.find("<mesh") == text.npos && text.find("<camera") == text.npos) return false;
  pugi::xml_document document;
  if (!mitsuba::parse_xml(**source, document)) return false;
  const pugi::xml_node root = document.document_element();
  return std::string_view(root.name()) == "scene" && !root.attribute("version") &&
         (root.child("mesh") || root.child("camera"));
}

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  const FileAccess files(options.confine_to);
  Diagnostics diagnostics;
  ReaderReport report(diagnostics, options.lenient);
  for (const auto& [name, value] : options.defines)
    diagnostics.error({}, fmt::format("-D {}={}: a Nori scene has no variables", name, value));
  mitsuba::ObjectTree tree = read_tree(file, files, diagnostics, report);
  if (diagnostics.failed()) return std::unexpected(diagnostics.error());
  SceneDescription scene = mitsuba::build_scene({tree, diagnostics, options.lenient}, files);
  if (diagnostics.failed()) return std::unexpected(diagnostics.error());
  if (options.settings.empty()) {  // else they may put it right
    if (const auto checked = check_settings(scene); !checked) {
      diagnostics.error(tree.scene.location, checked.error().message);
      return std::unexpected(diagnostics.error());
    }
  }
  scene.contents_hash = files.contents_hash();
  scene.warnings = diagnostics.take_warnings();
  scene.files = files.files_read();
  return scene;
}

}  // namespace penumbra::nori
