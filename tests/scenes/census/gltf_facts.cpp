#include <fmt/format.h>
#include <gtest/gtest.h>

#include <algorithm>
#include <cstdint>
#include <limits>
#include <string>
#include <type_traits>

#include "tests/scenes/census/census.h"
#include "tests/scenes/census/items.h"
#include "tests/scenes/gltf_text.h"

namespace penumbra::census {
namespace {

/// One grey texel, as PNG.
constexpr std::string_view kTexel =
    "data:image/png;base64,iVBORw0KGgoAAAANSUhEUgAAAAEAAAABCAAAAAA6fptVAAAACklEQVR4nGNo"
    "AAAAggCBd81ytgAAAABJRU5ErkJggg==";
constexpr int kVertices = 4;

template <typename T>
int put(GltfFile& file, const Item& fact, int width, std::string_view extra) {
  std::vector<T> numbers;
  const bool is_index = fact.type == "indices";
  const double one = fact.tag.find('n') != fact.tag.npos && !std::is_floating_point_v<T>
                         ? double(std::numeric_limits<T>::max())
                         : 1.0;
  for (int i = 0; i < kVertices; ++i) {
    if (is_index) {
      numbers.push_back(T(i < 3 ? i : 0));
      continue;
    }
    for (int c = 0; c < width; ++c) {
      const bool is_place = fact.type == "POSITION" || fact.type.starts_with("TEXCOORD");
      const bool is_first = fact.type.starts_with("WEIGHTS") && c == 0;
      const bool is_z = (fact.type == "NORMAL" && c == 2) || (fact.type == "TANGENT" && c % 3 == 0);
      numbers.push_back(is_place                                             ? T((c == 0   ? i % 2
                                                                                  : c == 1 ? i / 2
                                                                                           : 0) *
                                                                                 one)
                        : is_first || is_z || fact.type.starts_with("COLOR") ? T(one)
                                                                             : T(0));
    }
    // Elements of vertex attributes start at multiples of four bytes.
    while (numbers.size() * sizeof(T) % 4 != 0) numbers.push_back(T(0));
  }
  const int stride = int(numbers.size() * sizeof(T)) / kVertices;
  const int count = is_index ? 3 : kVertices;
  const std::string normalized = fact.tag.find('n') != fact.tag.npos ? ", \"normalized\": true" : "";
  static constexpr int kComponents[] = {5120, 5121, 5122, 5123, 5125, 5126};
  static constexpr std::string_view kNames[] = {"i8", "u8", "i16", "u16", "u32", "f32"};
  const auto component = std::ranges::find_if(kNames, [&](auto name) { return fact.tag.starts_with(name); });
  EXPECT_NE(component, std::end(kNames)) << fact.tag;
  return file.raw_accessor(
      fmt::format(R"({{"bufferView": {}, "componentType": {}, "count": {}, "type": "{}"{}{}}})",
                  file.view(numbers, is_index ? 0 : stride), kComponents[component - std::begin(kNames)],
                  count, fact.name, normalized, extra));
}

int accessor(GltfFile& file, const Item& fact) {
  const int width = fact.name == "SCALAR" ? 1 : fact.name.back() - '0';
  std::string sparse;
  if (fact.tag.ends_with('s')) {
    const int index = file.view(std::vector<std::uint16_t>{1});
    const int value = file.view(std::vector<float>(std::size_t(width), 1.0f));
    sparse = fmt::format(
        R"(, "sparse": {{"count": 1, "indices": {{"bufferView": {}, "componentType": 5123}}, "values": {{"bufferView": {}}}}})",
        index, value);
  }
  if (fact.tag.starts_with("i8")) return put<std::int8_t>(file, fact, width, sparse);
  if (fact.tag.starts_with("u8")) return put<std::uint8_t>(file, fact, width, sparse);
  if (fact.tag.starts_with("i16")) return put<std::int16_t>(file, fact, width, sparse);
  if (fact.tag.starts_with("u16")) return put<std::uint16_t>(file, fact, width, sparse);
  if (fact.tag.starts_with("u32")) return put<std::uint32_t>(file, fact, width, sparse);
  return put<float>(file, fact, width, sparse);
}

std::string primitive(GltfFile& file, const Item& item, std::size_t material) {
  std::vector<std::string> attributes, targets;
  std::string indices;
  for (const Item& fact : item.inside) {
    if (fact.tag == "target") {
      const Item moved{"f32", fact.type, "VEC3", true};
      targets.push_back(fmt::format("\"{}\": {}", fact.type, accessor(file, moved)));
    } else if (fact.type == "indices") {
      indices = fmt::format(", \"indices\": {}", accessor(file, fact));
    } else {
      attributes.push_back(fmt::format("\"{}\": {}", fact.type, accessor(file, fact)));
    }
  }
  return fmt::format(R"({{"mode": {}, "attributes": {{{}}}{}{}{}}})", item.type, fmt::join(attributes, ", "),
                     indices, material > 0 ? fmt::format(", \"material\": {}", material - 1) : "",
                     targets.empty() ? "" : fmt::format(", \"targets\": [{{{}}}]", fmt::join(targets, ", ")));
}

/// Texture 0 has an image, texture 1 has none.
std::string material(const Item& item) {
  std::vector<std::string> members = {fmt::format("\"alphaMode\": \"{}\"", item.type)}, metal, extensions;
  for (const Item& fact : item.inside) {
    const bool of_metal = fact.type.starts_with("baseColor") || fact.type.starts_with("metallic") ||
                          fact.type.starts_with("roughness");
    std::string value;
    if (fact.tag == "tex") value = fmt::format("{{\"index\": {}}}", fact.name == "none" ? 1 : 0);
    if (fact.tag == "value")
      value = fact.type == "doubleSided"       ? "true"
              : fact.type == "baseColorFactor" ? "[0.5, 0.4, 0.3, 1]"
              : fact.type == "emissiveFactor"  ? "[0.5, 0.4, 0.3]"
                                               : "0.5";
    if (fact.tag == "ext")
      extensions.push_back(fmt::format("\"{}\": {{}}", fact.type));
    else
      (of_metal ? metal : members).push_back(fmt::format("\"{}\": {}", fact.type, value));
  }
  if (!metal.empty())
    members.push_back(fmt::format("\"pbrMetallicRoughness\": {{{}}}", fmt::join(metal, ", ")));
  if (!extensions.empty())
    members.push_back(fmt::format("\"extensions\": {{{}}}", fmt::join(extensions, ", ")));
  return fmt::format("{{{}}}", fmt::join(members, ", "));
}

std::string names_of(const Item& item) {
  std::vector<std::string> names;
  for (const Item& each : item.inside) names.push_back(fmt::format("\"{}\"", each.type));
  return fmt::format("[{}]", fmt::join(names, ", "));
}

}  // namespace

std::string gltf_text(const Row& row) {
  GltfFile file;
  std::vector<std::string> members = {fmt::format("\"images\": [{{\"uri\": \"{}\"}}]", kTexel),
                                      "\"textures\": [{\"source\": 0}, {}]", "\"scene\": 0",
                                      "\"scenes\": [{\"nodes\": [0]}]"};
  std::vector<std::string> materials, primitives, children;
  std::string lights;
  for (const Item& item : read_items(row.items)) {
    if (item.tag == "requires") members.push_back("\"extensionsRequired\": " + names_of(item));
    if (item.tag == "uses") members.push_back("\"extensionsUsed\": " + names_of(item));
    if (item.tag == "material") materials.push_back(material(item));
    if (item.tag == "primitive") primitives.push_back(primitive(file, item, materials.size()));
    if (item.tag == "node" && item.type == "matrix")
      children.emplace_back(R"({"mesh": 0, "matrix": [2, 0, 0, 0, 0, 2, 0, 0, 0, 0, 2, 0, 1, 2, 3, 1]})");
    if (item.tag == "node" && item.type == "trs")
      children.emplace_back(
          R"({"mesh": 0, "translation": [1, 2, 3], "rotation": [0, 0, 0, 1], "scale": [1, 2, 3]})");
    if (item.tag == "node" && item.type == "plain") children.emplace_back("{\"mesh\": 0}");
    if (item.tag == "camera") {
      members.push_back(fmt::format(R"("cameras": [{{"type": "{0}", "{0}": {1}}}])", item.type,
                                    item.type == "perspective"
                                        ? R"({"yfov": 0.7, "znear": 0.1})"
                                        : R"({"xmag": 1, "ymag": 1, "znear": 0.1, "zfar": 10})"));
      children.emplace_back("{\"camera\": 0}");
    }
    if (item.tag == "light") {
      lights = fmt::format(R"({{"type": "{}"{}}})", item.type, item.type == "spot" ? ", \"spot\": {}" : "");
      children.emplace_back(R"({"extensions": {"KHR_lights_punctual": {"light": 0}}})");
    }
    if (item.tag == "skin") {
      members.emplace_back("\"skins\": [{\"joints\": [1]}]");
      children.emplace_back("{\"mesh\": 0, \"skin\": 0}");
    }
    if (item.tag == "animation") {
      const int time = file.accessor<float>("SCALAR", {0}, 1);
      const int value = file.accessor<float>("VEC3", {0, 0, 0}, 1);
      members.push_back(fmt::format(
          R"("animations": [{{"samplers": [{{"input": {}, "output": {}}}], "channels": [{{"sampler": 0, "target": {{"node": 0, "path": "translation"}}}}]}}])",
          time, value));
    }
  }
  if (!lights.empty())
    members.push_back(fmt::format(R"("extensions": {{"KHR_lights_punctual": {{"lights": [{}]}}}})", lights));
  if (!materials.empty()) members.push_back(fmt::format("\"materials\": [{}]", fmt::join(materials, ", ")));
  if (!primitives.empty())
    members.push_back(fmt::format("\"meshes\": [{{\"primitives\": [{}]}}]", fmt::join(primitives, ", ")));
  else
    std::erase_if(children, [](const std::string& node) { return node.find("mesh") != node.npos; });
  std::string numbers;
  for (std::size_t i = 1; i <= children.size(); ++i) numbers += fmt::format("{}{}", i > 1 ? ", " : "", i);
  members.push_back(fmt::format("\"nodes\": [{{{}}}{}{}]",
                                children.empty() ? "" : fmt::format("\"children\": [{}]", numbers),
                                children.empty() ? "" : ", ", fmt::join(children, ", ")));
  return file.text(fmt::format("{}", fmt::join(members, ",\n")));
}

}  // namespace penumbra::census
