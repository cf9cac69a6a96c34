#include "scenes/gltf/asset.h"

#include <fmt/format.h>

#include <array>
#include <cstdint>
#include <exception>

#include "kernels/host/module.h"
#include "scenes/gltf/data_address.h"
#include "scenes/gltf/meshopt_module.h"

namespace penumbra::gltf {
namespace {

namespace fs = std::filesystem;

constexpr std::size_t kMostBytes = std::size_t{4} << 30;
constexpr std::size_t kHeaderBytes = 12, kChunkHeaderBytes = 8;

std::uint32_t word(std::string_view bytes, std::size_t at) {
  std::uint32_t value = 0;
  for (std::size_t i = 0; i < 4; ++i)
    value |= std::uint32_t(static_cast<unsigned char>(bytes[at + i])) << (8 * i);
  return value;
}

struct GlbChunks {
  std::string_view json, binary;
};

/// The chunks of a GLB file (glTF 2.0, 4.4). All lengths are checked; unknown chunks are ignored.
Expected<GlbChunks> glb_chunks(const fs::path& file, std::string_view bytes) {
  constexpr std::uint32_t kJson = 0x4E4F534A, kBinary = 0x004E4942;
  const auto wrong = [&](std::string_view message) {
    return fail(fmt::format("{}: {}", file.string(), message));
  };
  if (bytes.size() < kHeaderBytes + kChunkHeaderBytes) return wrong("a GLB file that ends in its header");
  if (word(bytes, 4) != 2) return wrong(fmt::format("GLB version {} is not read; 2 is", word(bytes, 4)));
  if (word(bytes, 8) > bytes.size())
    return wrong(
        fmt::format("a GLB file of {} bytes, which says that it has {}", bytes.size(), word(bytes, 8)));
  GlbChunks chunks;
  for (std::size_t at = kHeaderBytes, chunk = 0; at + kChunkHeaderBytes <= word(bytes, 8); ++chunk) {
    const std::size_t length = word(bytes, at);
    const std::uint32_t type = word(bytes, at + 4);
    if (length > word(bytes, 8) - at - kChunkHeaderBytes)
      return wrong(fmt::format("chunk {} of the GLB file is longer than the file", chunk + 1));
    if (chunk == 0 && type != kJson) return wrong("the first chunk of a GLB file has to be JSON");
    at += kChunkHeaderBytes;
    if (chunk == 0) chunks.json = bytes.substr(at, length);
    if (chunk == 1 && type == kBinary) chunks.binary = bytes.substr(at, length);
    at += length;
  }
  return chunks;
}

std::string one_line(std::string text) {
  while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
  for (char& c : text)
    if (c == '\n') c = ' ';
  return text;
}

/// The data that a URI contains or refers to.
Expected<std::string> contents_of(const Asset& asset, std::string_view address, std::uint64_t most) {
  if (is_data_address(address)) return data_of_address(address);
  const auto found = find_file(asset, address);
  return found ? asset.files.read_bytes(*found, most) : std::unexpected(found.error());
}

Expected<void> read_buffers(Asset& asset, const std::vector<BufferEntry>& entries, std::string_view binary) {
  for (std::size_t i = 0; i < entries.size(); ++i) {
    const BufferEntry& entry = entries[i];
    const auto wrong = [&](std::string_view message) {
      return fail(format_diagnostic(asset.place({"buffers", i, "uri"}), "error", message));
    };
    tinygltf::Buffer& buffer = asset.model.buffers.emplace_back();
    std::string_view bytes = i == 0 ? binary : std::string_view();
    Expected<std::string> contents;
    if (!entry.uri.empty()) {
      contents = contents_of(asset, entry.uri, kMaxMeshFileBytes);
      if (!contents) return wrong(fmt::format("buffer {}: {}", i, contents.error().message));
      bytes = *contents;
    } else if (bytes.empty()) {
      continue;  // a placeholder for compressed data has no URI; its views report that where they are used
    }
    if (bytes.size() < entry.bytes)
      return wrong(
          fmt::format("buffer {} has {} bytes, where 'byteLength' says {}", i, bytes.size(), entry.bytes));
    buffer.data.assign(bytes.begin(), bytes.begin() + std::ptrdiff_t(entry.bytes));
  }
  return {};
}

std::size_t number_of(const tinygltf::Value& object, const char* name) {
  if (!object.IsObject() || !object.Has(name) || !object.Get(name).IsNumber()) return 0;
  const double value = object.Get(name).GetNumberAsDouble();
  return value >= 0 && value < double(kMostBytes) ? std::size_t(value) : kMostBytes;
}

std::string text_of(const tinygltf::Value& object, const char* name, const char* fallback) {
  return object.IsObject() && object.Has(name) && object.Get(name).IsString()
             ? object.Get(name).Get<std::string>()
             : fallback;
}

}  // namespace

Expected<fs::path> find_file(const Asset& asset, std::string_view address) {
  const std::array<fs::path, 1> folders = {asset.json->path.parent_path()};
  if (address.starts_with("http://") || address.starts_with("https://"))
    return fail(fmt::format("'{}' is not on this machine; only files are read", address));
  auto found = asset.files.find(percent_decoded(address), folders);
  // Some names contain a percent sign that is not an escape.
  if (!found && address.contains('%'))
    if (auto as_it_stands = asset.files.find(address, folders)) return as_it_stands;
  return found;
}

Expected<std::string_view> Asset::part(int buffer, std::size_t offset, std::size_t length,
                                       std::string_view name) const {
  if (buffer < 0 || std::size_t(buffer) >= model.buffers.size())
    return fail(fmt::format("{} is of the buffer {}, which is not there", name, buffer));
  const auto& bytes = model.buffers[std::size_t(buffer)].data;
  if (bytes.empty() && length > 0)
    return fail(fmt::format(
        "{} is of the buffer {}, which has no data: neither a 'uri' nor a binary part of the file", name,
        buffer));
  if (offset > bytes.size() || length > bytes.size() - offset)
    return fail(fmt::format("{} ends beyond its buffer of {} bytes", name, bytes.size()));
  return std::string_view(reinterpret_cast<const char*>(bytes.data()) + offset, length);
}

Expected<std::string> Asset::unpacked(const tinygltf::Value& compression, int index) const {
  static const Expected<const void*> module =
      load_module("libpenumbra_meshopt_reader.so", "penumbra_meshopt_reader");
  if (!module)
    return fail(
        fmt::format("EXT_meshopt_compression needs a part of the program that is built where meshoptimizer "
                    "(Debian: libmeshoptimizer-dev) is: {}",
                    module.error().message));
  const auto bytes =
      part(int(number_of(compression, "buffer")), number_of(compression, "byteOffset"),
           number_of(compression, "byteLength"), fmt::format("compressed buffer view {}", index));
  if (!bytes) return std::unexpected(bytes.error());
  return static_cast<const MeshoptReader*>(*module)->read(
      *bytes, {number_of(compression, "count"), number_of(compression, "byteStride"),
               text_of(compression, "mode", ""), text_of(compression, "filter", "NONE")});
}

Expected<std::string_view> Asset::view(int index) const {
  if (index < 0 || std::size_t(index) >= model.bufferViews.size())
    return fail(fmt::format("there is no buffer view {}", index));
  const tinygltf::BufferView& view = model.bufferViews[std::size_t(index)];
  for (const char* name : {"EXT_meshopt_compression", "KHR_meshopt_compression"}) {
    const auto compression = view.extensions.find(name);
    if (compression == view.extensions.end()) continue;
    auto known = unpacked_.find(index);
    if (known == unpacked_.end())
      known = unpacked_.emplace(index, unpacked(compression->second, index)).first;
    if (!known->second) return fail(fmt::format("buffer view {}: {}", index, known->second.error().message));
    return std::string_view(*known->second);
  }
  return part(view.buffer, view.byteOffset, view.byteLength, fmt::format("buffer view {}", index));
}

Expected<std::string_view> Asset::image(int index) const {
  if (index < 0 || std::size_t(index) >= model.images.size())
    return fail(fmt::format("there is no image {}", index));
  const tinygltf::Image& image = model.images[std::size_t(index)];
  if (image.bufferView >= 0) return view(image.bufferView);
  if (image.uri.empty()) return fail(fmt::format("image {} has neither 'uri' nor 'bufferView'", index));
  auto known = images_.find(index);
  if (known == images_.end())
    known = images_.emplace(index, contents_of(*this, image.uri, kMaxImageFileBytes)).first;
  if (!known->second) return fail(fmt::format("image {}: {}", index, known->second.error().message));
  return std::string_view(*known->second);
}

Expected<std::unique_ptr<Asset>> read_asset(const fs::path& file, const FileAccess& files) {
  auto bytes = files.read_bytes(file, kMostBytes - 1);
  if (!bytes) return std::unexpected(bytes.error());
  auto asset = std::make_unique<Asset>(files);
  asset->json->path = file;
  std::string_view binary;
  if (bytes->starts_with("glTF")) {
    const auto chunks = glb_chunks(file, *bytes);
    if (!chunks) return std::unexpected(chunks.error());
    asset->json->text = chunks->json;
    binary = chunks->binary;
  } else {
    asset->json->text = bytes->starts_with("\xEF\xBB\xBF") ? bytes->substr(3) : *bytes;
  }
  if (const auto checked = check_json(*asset->json); !checked) return std::unexpected(checked.error());
  auto input = parser_input(*asset->json);
  if (!input) return std::unexpected(input.error());

  tinygltf::TinyGLTF parser;
  std::string problem, warnings;
  bool done = false;
  try {
    done = parser.LoadASCIIFromString(&asset->model, &problem, &warnings, input->text.data(),
                                      unsigned(input->text.size()), "");
  } catch (const std::exception& what) {  // for example for numbers beyond the range of an index
    problem = what.what();
  }
  if (!done)
    return fail(format_diagnostic({asset->json.get(), 0}, "error",
                                  problem.empty() ? "cannot be parsed as glTF" : one_line(problem)));
  for (const std::size_t accessor : input->without_view) asset->model.accessors[accessor].bufferView = -1;
  if (!input->without_view.empty()) asset->model.bufferViews.pop_back();
  asset->animations = std::move(input->animations);
  for (ImageEntry& entry : input->images) {
    tinygltf::Image& image = asset->model.images.emplace_back();
    image.name = std::move(entry.name);
    image.uri = std::move(entry.uri);
    image.mimeType = std::move(entry.media_type);
    image.bufferView = entry.view;
  }
  if (const auto read = read_buffers(*asset, input->buffers, binary); !read)
    return std::unexpected(read.error());
  return asset;
}

}  // namespace penumbra::gltf
