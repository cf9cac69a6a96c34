#include "scenes/nori/nori_scene.h"

#include <pugixml.hpp>
#include <string_view>
#include <utility>

#include "scenes/file_access.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/scene_builder.h"
#include "scenes/mitsuba/xml_source.h"
#include "scenes/nori/nori_tree.h"
#include "scenes/reading.h"

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
  Reading reading(options);
  reading.refuse_variables("Nori");
  mitsuba::ObjectTree tree = read_tree(file, reading.files, reading.diagnostics, reading.report);
  if (reading.failed()) return reading.error();
  SceneDescription scene = mitsuba::build_scene({tree, reading.diagnostics, options.lenient, options.settings}, reading.files);
  return reading.finish(std::move(scene), tree.scene.location);
}

}  // namespace penumbra::nori
