#include "scenes/gltf/parser_input.h"

#include <fmt/format.h>

#include <cstdint>
#include <limits>
#include <nlohmann/json.hpp>

#include "scenes/gltf/data_address.h"
#include "scenes/gltf/json_places.h"

namespace penumbra::gltf {
namespace {

using nlohmann::json;

std::string text_of(const json& object, const char* name) {
  const auto found = object.find(name);
  return found != object.end() && found->is_string() ? found->get<std::string>() : std::string();
}

/// A whole number, or -1.
int index_of(const json& object, const char* name) {
  const auto found = object.find(name);
  const bool is_index = found != object.end() && found->is_number_unsigned() &&
                        found->get<std::uint64_t>() <= std::uint64_t(std::numeric_limits<int>::max());
  return is_index ? found->get<int>() : -1;
}

/// Removes an array from the root and returns it; empty if there is none.
json take(json& root, const char* name) {
  const auto found = root.find(name);
  if (found == root.end()) return json::array();
  json result = std::move(*found);
  root.erase(found);
  return result;
}

class Preparation {
 public:
  explicit Preparation(const SourceFile& source) : source_(source) {}

  Expected<ParserInput> result() {
    json root = json::parse(source_.text, nullptr, false);
    if (!root.is_object()) return wrong({}, "a glTF file is an object: {...}");
    if (const auto checked = check_version(root); !checked) return std::unexpected(checked.error());
    ParserInput input;
    if (const auto done = take_buffers(root, input); !done) return std::unexpected(done.error());
    if (const auto done = take_images(root, input); !done) return std::unexpected(done.error());
    if (const auto done = take_animations(root, input); !done) return std::unexpected(done.error());
    give_views(root, input);
    input.text = root.dump(-1, ' ', false, json::error_handler_t::replace);
    return input;
  }

 private:
  [[nodiscard]] std::unexpected<Error> wrong(std::initializer_list<JsonStep> path,
                                             std::string_view message) const {
    return fail(format_diagnostic(json_place(source_, path), "error", message));
  }

  Expected<void> check_version(const json& root) const {
    const auto asset = root.find("asset");
    if (asset == root.end() || !asset->is_object())
      return wrong({}, R"(the file has no "asset": {"version": "2.0"}, so it is no glTF 2.0)");
    std::string version = text_of(*asset, "minVersion");
    if (version.empty()) version = text_of(*asset, "version");
    if (version.empty() && asset->contains("version")) version = (*asset)["version"].dump();
    if (version.starts_with("2.") || version == "2") return {};
    return wrong({"asset"}, fmt::format("glTF version '{}' is not read; 2.0 is", version));
  }

  Expected<void> take_buffers(json& root, ParserInput& input) const {
    const json buffers = take(root, "buffers");
    if (!buffers.is_array()) return wrong({"buffers"}, "'buffers' is an array");
    for (std::size_t i = 0; i < buffers.size(); ++i) {
      const json& buffer = buffers[i];
      if (!buffer.is_object() || !buffer.contains("byteLength") || !buffer["byteLength"].is_number_unsigned())
        return wrong({"buffers", i}, "a buffer is an object with a 'byteLength', a whole number");
      input.buffers.push_back({text_of(buffer, "uri"), buffer["byteLength"].get<std::size_t>()});
    }
    return {};
  }

  Expected<void> take_images(json& root, ParserInput& input) const {
    const json images = take(root, "images");
    if (!images.is_array()) return wrong({"images"}, "'images' is an array");
    for (std::size_t i = 0; i < images.size(); ++i) {
      const json& image = images[i];
      if (!image.is_object()) return wrong({"images", i}, "an image is an object");
      ImageEntry entry{text_of(image, "name"), text_of(image, "uri"), text_of(image, "mimeType")};
      if (entry.media_type.empty() && is_data_address(entry.uri))
        entry.media_type = entry.uri.substr(5, entry.uri.find_first_of(";,", 5) - 5);
      if (image.contains("bufferView") && image["bufferView"].is_number_integer())
        entry.view = image["bufferView"].get<int>();
      input.images.push_back(std::move(entry));
    }
    return {};
  }

  Expected<void> take_animations(json& root, ParserInput& input) const {
    const json animations = take(root, "animations");
    if (!animations.is_array()) return wrong({"animations"}, "'animations' is an array");
    for (std::size_t i = 0; i < animations.size(); ++i) {
      const json& animation = animations[i];
      AnimationEntry& entry = input.animations.emplace_back();
      for (const char* name : {"samplers", "channels"}) {
        if (!animation.is_object() || !animation.contains(name) || !animation[name].is_array())
          return wrong({"animations", i},
                       "an animation is an object with the arrays 'channels' and 'samplers'");
        for (std::size_t k = 0; k < animation[name].size(); ++k)
          if (!animation[name][k].is_object())
            return wrong({"animations", i, name, k}, fmt::format("'{}' are objects", name));
      }
      entry.name = text_of(animation, "name");
      for (const json& sampler : animation["samplers"]) {
        const std::string interpolation =
            sampler.contains("interpolation") ? text_of(sampler, "interpolation") : "LINEAR";
        entry.samplers.push_back({index_of(sampler, "input"), index_of(sampler, "output"), interpolation});
      }
      for (std::size_t k = 0; k < animation["channels"].size(); ++k) {
        const json& channel = animation["channels"][k];
        if (!channel.contains("target") || !channel["target"].is_object())
          return wrong({"animations", i, "channels", k}, "a channel has a 'target', an object");
        const json& target = channel["target"];
        std::string pointer;
        if (const json::json_pointer at("/extensions/KHR_animation_pointer"); target.contains(at))
          pointer = text_of(target[at], "pointer");
        entry.channels.push_back(
            {index_of(channel, "sampler"), index_of(target, "node"), text_of(target, "path"), pointer});
      }
    }
    return {};
  }

  static void give_views(json& root, ParserInput& input) {
    const auto accessors = root.find("accessors");
    const auto meshes = root.find("meshes");
    if (accessors == root.end() || !accessors->is_array() || meshes == root.end() || !meshes->is_array())
      return;
    json& views = root["bufferViews"];
    if (!views.is_null() && !views.is_array()) return;
    const std::size_t added = views.size();
    for (const json& mesh : *meshes) {
      if (!mesh.is_object() || !mesh.contains("primitives") || !mesh["primitives"].is_array()) continue;
      for (const json& primitive : mesh["primitives"]) {
        if (!primitive.is_object() || !primitive.contains("indices") ||
            !primitive["indices"].is_number_unsigned())
          continue;
        const auto index = primitive["indices"].get<std::size_t>();
        if (index >= accessors->size()) continue;
        json& accessor = (*accessors)[index];
        if (!accessor.is_object() || accessor.contains("bufferView")) continue;
        accessor["bufferView"] = added;
        input.without_view.push_back(index);
      }
    }
    if (!input.without_view.empty()) views.push_back({{"buffer", 0}, {"byteLength", 0}});
    if (views.is_null()) root.erase("bufferViews");
  }

  const SourceFile& source_;
};

}  // namespace

Expected<ParserInput> parser_input(const SourceFile& json) { return Preparation(json).result(); }

}  // namespace penumbra::gltf
