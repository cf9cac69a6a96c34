#include "scenes/rainbow/rainbow_scene.h"

#include <fmt/format.h>

#include <pugixml.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "scenes/file_access.h"
#include "scenes/mitsuba/plugin.h"
#include "scenes/mitsuba/scene_builder.h"
#include "scenes/mitsuba/xml_reader.h"
#include "scenes/mitsuba/xml_source.h"
#include "scenes/rainbow/translate.h"
#include "scenes/reading.h"

namespace penumbra::rainbow {
namespace {

constexpr const char* kSamples = "sampleNum";

/// What shows that the file is Rainbow's; empty: nothing.
std::string sign_of(const pugi::xml_node& root) {
  if (std::string_view(root.name()) != "scene" || root.child("mesh")) return "";  // those are Nori's
  if (root.child("mode")) return "it has a <mode>";
  if (root.find_node([](const pugi::xml_node& node) { return std::string_view(node.name()) == "hide"; }))
    return "it has a <hide>";
  // Integrators of other programs, too, have a number of samples, but not when to save the image.
  const pugi::xml_node integrator = root.child("integrator");
  if (integrator.find_child_by_attribute("integer", "name", kSamples) &&
      integrator.find_child_by_attribute("integer", "name", "delta"))
    return fmt::format("its integrator has {} and delta", kSamples);
  return "";
}

std::string sign_of(const SourceFile& source) {
  const std::string& text = source.text;
  if (text.find("<mode") == text.npos && text.find("<hide") == text.npos && text.find(kSamples) == text.npos)
    return "";
  pugi::xml_document document;
  return mitsuba::parse_xml(source, document) ? sign_of(document.document_element()) : "";
}

/// Changes one element and those inside it to what Mitsuba's reader knows. Rainbow's parser skips <mode>'s
/// kind of output and everything hidden, and multiplies the steps of a transform in the order in which they
/// are written: the last one is the first to move a point, the reverse of Mitsuba.
void adapt(pugi::xml_node element) {
  std::vector<pugi::xml_node> left_out;
  for (pugi::xml_node& child : element.children()) {
    const std::string_view tag = child.name();
    if (tag == "hide" || tag == "mode") left_out.push_back(child);
    if (tag == "camera") child.set_name("sensor");
    if (tag == "color") child.set_name("rgb");
    adapt(child);
  }
  for (const pugi::xml_node& child : left_out) element.remove_child(child);
  if (std::string_view(element.name()) != "transform") return;
  for (pugi::xml_node child = element.last_child().previous_sibling(); child;) {
    const pugi::xml_node before = child.previous_sibling();
    element.append_move(child);
    child = before;
  }
}

}  // namespace

bool is_scene(const std::filesystem::path& file) {
  const auto source = FileAccess(std::nullopt).read(file, kMaxSceneFileBytes);
  return source && !sign_of(**source).empty();
}

Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options) {
  Reading reading(options);
  const mitsuba::XmlDialect dialect{[](pugi::xml_document& document) { adapt(document); }};
  mitsuba::ObjectTree tree =
      mitsuba::read_object_tree(file, options, reading.files, reading.diagnostics, &dialect);
  if (reading.failed()) return reading.error();
  translate(tree, reading.report);
  if (reading.failed()) return reading.error();
  SceneDescription scene =
      mitsuba::build_scene({tree, reading.diagnostics, options.lenient, options.settings}, reading.files);
  scene.dialect = fmt::format("rainbow ({})", sign_of(*tree.files.front()));
  return reading.finish(std::move(scene), tree.scene.location);
}

}  // namespace penumbra::rainbow
