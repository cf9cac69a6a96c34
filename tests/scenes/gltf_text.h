// glTF scenes written in tests: numbers become buffers in data URIs.
#pragma once

#include <fmt/format.h>

#include <cstdint>
#include <cstring>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "tests/scenes/scene_text.h"

namespace penumbra {

inline std::string base64(std::string_view bytes) {
  static constexpr std::string_view kDigits =
      "ABCDEFGHIJKLMNOPQRSTUVWXYZabcdefghijklmnopqrstuvwxyz0123456789+/";
  std::string text;
  for (std::size_t i = 0; i < bytes.size(); i += 3) {
    std::uint32_t word = 0;
    for (std::size_t k = 0; k < 3; ++k)
      word = word << 8 | (i + k < bytes.size() ? std::uint32_t(std::uint8_t(bytes[i + k])) : 0u);
    for (std::size_t k = 0; k < 4; ++k)
      text += i + k > bytes.size() ? '=' : kDigits[word >> (18 - 6 * k) & 63u];
  }
  return text;
}

/// A glTF file in parts: what is given is put together with a buffer, its views and their accessors.
class GltfFile {
 public:
  /// An accessor of these numbers, "VEC3" for example; its index. `extra`: further members, ", \"…\": …".
  template <typename T>
  int accessor(const char* type, std::vector<T> numbers, std::size_t count, std::string_view extra = "") {
    const int view = this->view(numbers);
    accessors_.push_back(
        fmt::format(R"({{"bufferView": {}, "componentType": {}, "count": {}, "type": "{}"{}}})", view,
                    component<T>(), count, type, extra));
    return int(accessors_.size()) - 1;
  }
  int raw_accessor(std::string text) {
    accessors_.push_back(std::move(text));
    return int(accessors_.size()) - 1;
  }
  /// A buffer view of these numbers; a stride of 0 is none.
  template <typename T>
  int view(const std::vector<T>& numbers, int stride = 0) {
    while (buffer_.size() % 4 != 0) buffer_ += '\0';
    const std::size_t offset = buffer_.size();
    buffer_.append(reinterpret_cast<const char*>(numbers.data()), numbers.size() * sizeof(T));
    views_.push_back(fmt::format(R"({{"buffer": 0, "byteOffset": {}, "byteLength": {}{}}})", offset,
                                 numbers.size() * sizeof(T),
                                 stride > 0 ? fmt::format(", \"byteStride\": {}", stride) : ""));
    return int(views_.size()) - 1;
  }

  /// Members of the root: "nodes": [...] and so on.
  [[nodiscard]] std::string text(std::string_view members) const {
    return fmt::format(
        "{{\n\"asset\": {{\"version\": \"2.0\"}},\n{},\n{}\n}}\n", members,
        buffers(fmt::format(R"("uri": "data:application/octet-stream;base64,{}", )", base64(buffer_))));
  }
  /// The same as a binary file.
  [[nodiscard]] std::string binary(std::string_view members) const {
    std::string json = fmt::format("{{\"asset\": {{\"version\": \"2.0\"}},\n{},\n{}}}", members, buffers(""));
    while (json.size() % 4 != 0) json += ' ';
    std::string bytes = buffer_;
    while (bytes.size() % 4 != 0) bytes += '\0';
    const auto word = [](std::size_t value) {
      const auto v = std::uint32_t(value);
      return std::string(reinterpret_cast<const char*>(&v), 4);
    };
    return "glTF" + word(2) + word(12 + 8 + json.size() + 8 + bytes.size()) + word(json.size()) + "JSON" +
           json + word(bytes.size()) + std::string("BIN\0", 4) + bytes;
  }
  [[nodiscard]] const std::string& buffer() const { return buffer_; }
  [[nodiscard]] std::string buffers(std::string_view uri) const {
    return fmt::format(
        "\"accessors\": [{}],\n\"bufferViews\": [{}],\n\"buffers\": [{{{}\"byteLength\": {}}}]",
        fmt::join(accessors_, ", "), fmt::join(views_, ", "), uri, buffer_.size());
  }

 private:
  template <typename T>
  static int component() {
    if (std::is_same_v<T, float>) return 5126;
    const int size = sizeof(T) == 1 ? 5120 : sizeof(T) == 2 ? 5122 : 5124;
    return size + (std::is_unsigned_v<T> ? 1 : 0);
  }

  std::string buffer_;
  std::vector<std::string> views_, accessors_;
};

class GltfText : public SceneText {
 protected:
  Expected<SceneDescription> read_gltf(std::string_view text, const ReadOptions& options = {}) {
    write("scene.gltf", text);
    return read_scene(folder_ / "scene.gltf", options);
  }
  SceneDescription good_gltf(std::string_view text, const ReadOptions& options = {}) {
    return good_of(read_gltf(text, options));
  }
  std::string gltf_error(std::string_view text, const ReadOptions& options = {}) {
    return error_of(read_gltf(text, options), text);
  }

  /// A triangle (0,0,0) (1,0,0) (0,1,0) with texture coordinates (x, 1 - y).
  static constexpr const char* kTriangle = R"({"attributes": {"POSITION": 0, "TEXCOORD_0": 1}})";
  static GltfFile triangle() {
    GltfFile file;
    file.accessor<float>("VEC3", {0, 0, 0, 1, 0, 0, 0, 1, 0}, 3);
    file.accessor<float>("VEC2", {0, 1, 1, 1, 0, 0}, 3);
    return file;
  }
  /// One node, of one mesh of these primitives, and what else there is.
  static std::string one_mesh(std::string_view primitives, std::string_view more = "",
                              std::string_view node = "") {
    return fmt::format(R"("scene": 0, "scenes": [{{"nodes": [0]}}], "nodes": [{{"mesh": 0{}}}],
"meshes": [{{"primitives": [{}]}}]{})",
                       node, primitives, more);
  }
  static const Mesh& mesh(const SceneDescription& scene, std::size_t index = 0) {
    return std::get<Mesh>(scene.shapes.at(index).geometry);
  }
};

}  // namespace penumbra
