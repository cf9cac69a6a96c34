#include "scenes/gltf/asset.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <cstring>
#include <exception>

namespace penumbra::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{4} << 30;
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

/// What the parser's callbacks work with.
struct Loading {
  const FileAccess& files;
  fs::path folder;
  Asset& asset;
  std::string problem = {};  ///< with the last file that could not be read

  [[nodiscard]] Expected<fs::path> find(const std::string& name) const {
    const std::array<fs::path, 1> folders = {folder};
    return files.find(name, folders);
  }
};

bool file_exists(const std::string& name, void* user) {
  auto& loading = *static_cast<Loading*>(user);
  // It is looked for beside the parser's own place too; that is ours.
  if (name.starts_with("./") || name.empty()) return false;
  const auto found = loading.find(name);
  if (!found) loading.problem = found.error().message;
  return found.has_value();
}

std::string same_path(const std::string& name, void*) { return name; }

bool read_whole_file(std::vector<unsigned char>* out, std::string* problem, const std::string& name,
                     void* user) {
  auto& loading = *static_cast<Loading*>(user);
  const auto found = loading.find(name);
  const auto bytes =
      found ? loading.files.read_bytes(*found, kMaxMeshFileBytes) : std::unexpected(found.error());
  if (!bytes) {
    loading.problem = bytes.error().message;
    if (problem != nullptr) *problem += loading.problem + "\n";
    return false;
  }
  out->assign(bytes->begin(), bytes->end());
  return true;
}

bool write_nothing(std::string*, const std::string&, const std::vector<unsigned char>&, void*) {
  return false;
}

/// Keeps the bytes of an image as they are: OpenImageIO decodes them. What is in a buffer stays there.
bool keep_image(tinygltf::Image* image, int index, std::string*, std::string*, int, int,
                const unsigned char* bytes, int size, void* user) {
  if (image->bufferView < 0 && bytes != nullptr && size > 0)
    static_cast<Loading*>(user)->asset.images[index].assign(reinterpret_cast<const char*>(bytes),
                                                            std::size_t(size));
  return true;
}

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::uint32_t(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

/// The JSON chunk of a GLB file (glTF 2.0, 4.4), all of whose lengths are checked.
Expected<std::string> json_chunk(const fs::path& file, std::string_view bytes) {
  constexpr std::uint32_t kJson = 0x4E4F534A;
  const auto wrong = [&](std::string_view message) {
    return fail(fmt::format("{}: {}", file.string(), message));
  };
  if (bytes.size() < kHeaderBytes + kChunkHeaderBytes) return wrong("a GLB file that ends in its header");
  if (word(bytes, 4) != 2) return wrong(fmt::format("GLB version {} is not read; 2 is", word(bytes, 4)));
  if (word(bytes, 8) > bytes.size())
    return wrong(
        fmt::format("a GLB file of {} bytes, which says that it has {}", bytes.size(), word(bytes, 8)));
  for (std::size_t at = kHeaderBytes, chunk = 0; at + kChunkHeaderBytes <= word(bytes, 8); ++chunk) {
    const std::size_t length = word(bytes, at);
    if (length > word(bytes, 8) - at - kChunkHeaderBytes)
      return wrong(fmt::format("chunk {} of the GLB file is longer than the file", chunk + 1));
    if (chunk == 0 && word(bytes, at + 4) != kJson)
      return wrong("the first chunk of a GLB file has to be JSON");
    at += kChunkHeaderBytes + length;
  }
  return std::string(bytes.substr(kHeaderBytes + kChunkHeaderBytes, word(bytes, kHeaderBytes)));
}

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text;
}

}  // namespace

Expected<std::string_view> Asset::view(int index) const {
  if (index < 0 || std::size_t(index) >= model.bufferViews.size())
    return fail(fmt::format("there is no buffer view {}", index));
  const tinygltf::BufferView& view = model.bufferViews[std::size_t(index)];
  if (view.buffer < 0 || std::size_t(view.buffer) >= model.buffers.size())
    return fail(fmt::format("buffer view {} is of the buffer {}, which is not there", index, view.buffer));
  const auto& bytes = model.buffers[std::size_t(view.buffer)].data;
  if (view.byteOffset > bytes.size() || view.byteLength > bytes.size() - view.byteOffset)
    return fail(fmt::format("buffer view {} ends beyond its buffer of {} bytes", index, bytes.size()));
  return std::string_view(reinterpret_cast<const char*>(bytes.data()) + view.byteOffset, view.byteLength);
}

Expected<std::string_view> Asset::image(int index) const {
  if (index < 0 || std::size_t(index) >= model.images.size())
    return fail(fmt::format("there is no image {}", index));
  const tinygltf::Image& image = model.images[std::size_t(index)];
  if (image.bufferView >= 0) return view(image.bufferView);
  const auto found = images.find(index);
  if (found == images.end())
    return fail(fmt::format("the image {} cannot be read{}", index,
                            image.uri.empty() ? "" : fmt::format(": there is no file '{}'", image.uri)));
  return std::string_view(found->second);
}

Expected<std::unique_ptr<Asset>> read_asset(const fs::path& file, const FileAccess& files) {
  auto bytes = files.read_bytes(file, kMostBytes - 1);
  if (!bytes) return std::unexpected(bytes.error());
  auto asset = std::make_unique<Asset>();
  asset->json = std::make_unique<SourceFile>();
  asset->json->path = file;
  const bool is_binary = bytes->starts_with("glTF");
  if (is_binary) {
    auto chunk = json_chunk(file, *bytes);
    if (!chunk) return std::unexpected(chunk.error());
    asset->json->text = std::move(*chunk);
  } else {
    asset->json->text = bytes->starts_with("\xEF\xBB\xBF") ? bytes->substr(3) : *bytes;
  }
  if (const auto checked = check_json(*asset->json); !checked) return std::unexpected(checked.error());

  Loading loading{files, file.parent_path(), *asset};
  tinygltf::TinyGLTF parser;
  parser.SetImageLoader(keep_image, &loading);
  parser.SetFsCallbacks({file_exists, same_path, read_whole_file, write_nothing, &loading});
  std::string problem, warnings;
  bool done = false;
  try {
    done = is_binary
               ? parser.LoadBinaryFromMemory(&asset->model, &problem, &warnings,
                                             reinterpret_cast<const unsigned char*>(bytes->data()),
                                             unsigned(bytes->size()), "")
               : parser.LoadASCIIFromString(&asset->model, &problem, &warnings, asset->json->text.data(),
                                            unsigned(asset->json->text.size()), "");
  } catch (const std::exception& what) {  // numbers beyond what an index may be, among others
    problem = what.what();
  }
  if (!done) {
    std::string message = problem.empty() ? "cannot be parsed as glTF" : one_line(problem);
    if (!loading.problem.empty() && message.find(loading.problem) == message.npos)
      message += fmt::format(" ({})", loading.problem);
    return fail(format_diagnostic({asset->json.get(), 0}, "error", message));
  }
  return asset;
}

}  // namespace penumbra::gltf
