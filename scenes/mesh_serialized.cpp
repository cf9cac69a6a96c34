#include <fmt/format.h>

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <limits>

#include "scenes/inflated_stream.h"
#include "scenes/mesh_reader.h"

namespace penumbra {
namespace {

static_assert(std::endian::native == std::endian::little, "the format's numbers are copied as they are");

constexpr std::uint16_t kFormat = 0x041c;
constexpr std::size_t kHeaderBytes = 4;  // format and version
constexpr int kFirstVersion = 3, kLastVersion = 4;
/// Deflate expands a byte to at most 1032 bytes (zlib's technical details).
constexpr std::uint64_t kMostInflation = 1032;
constexpr std::size_t kMaxNameBytes = 65536;
constexpr std::size_t kChunk = std::size_t{1} << 20;  // number of values for which memory is reserved at once

enum Flag : std::uint32_t {
  kNormals = 0x0001,
  kTexcoords = 0x0002,
  kColours = 0x0008,
  kFaceNormals = 0x0010,
  kSingle = 0x1000,
  kDouble = 0x2000,
};
constexpr std::uint32_t kKnownFlags = kNormals | kTexcoords | kColours | kFaceNormals | kSingle | kDouble;

/// The numbers of a compressed mesh, in order.
class PackedNumbers {
 public:
  explicit PackedNumbers(std::string_view packed) : stream_(packed, InflatedStream::Format::kZlib) {}

  /// Reads exactly `bytes` bytes. Errors: the stream ends early or is damaged.
  Expected<void> read(void* to, std::size_t bytes) {
    using State = InflatedStream::State;
    if (stream_.read(to, bytes) == bytes) return {};
    const bool ends = stream_.state() == State::kEnd || stream_.state() == State::kCutOff;
    return fail(ends ? "the data end early" : "the compressed data are damaged");
  }

  template <typename T>
  Expected<T> number() {
    T value{};
    if (auto done = read(&value, sizeof value); !done) return std::unexpected(done.error());
    return value;
  }

 private:
  InflatedStream stream_;
};

template <typename T>
T number_at(std::string_view bytes, std::size_t offset) {
  T value{};
  std::memcpy(&value, bytes.data() + offset, sizeof value);
  return value;
}

class SerializedReader {
 public:
  SerializedReader(const SourceFile& file, std::int64_t index)
      : file_(file), bytes_(file.text), index_(index) {}

  Expected<MeshFile> read() {
    const auto at = offset();
    if (!at) return wrong(at.error().message);
    if (auto done = check_header(*at); !done) return wrong(done.error().message);
    const std::string_view packed = bytes_.substr(*at + kHeaderBytes);
    PackedNumbers stream(packed);
    if (auto done = mesh(stream, packed.size()); !done)
      return wrong(fmt::format("mesh {}: {}", index_, done.error().message));
    return std::move(result_);
  }

 private:
  [[nodiscard]] std::unexpected<Error> wrong(std::string_view message) const {
    return fail(fmt::format("{}: error: {}", file_.path.string(), message));
  }

  /// Checks the header at `at` and returns the version.
  Expected<int> check_header(std::size_t at) const {
    if (bytes_.size() < kHeaderBytes || at > bytes_.size() - kHeaderBytes)
      return fail("the file ends early: there is no room for a header");
    if (number_at<std::uint16_t>(bytes_, at) != kFormat) {
      return fail(at == 0 ? "this is no serialized file: it does not start with 0x041c"
                          : fmt::format("no mesh starts at byte {}, where its table of meshes says so", at));
    }
    const int version = number_at<std::uint16_t>(bytes_, at + 2);
    if (version < kFirstVersion || version > kLastVersion) {
      return fail(fmt::format("version {} of the format is not one that Penumbra reads: {} and {} are",
                              version, kFirstVersion, kLastVersion));
    }
    return version;
  }

  /// The offset of the mesh, from the table at the end of the file.
  Expected<std::size_t> offset() const {
    if (index_ < 0) return fail(fmt::format("shape_index is {}: meshes are counted from 0", index_));
    const auto version = check_header(0);
    if (!version) return std::unexpected(version.error());
    if (index_ == 0) return 0;
    const std::uint64_t entry = *version >= 4 ? 8 : 4, rest = bytes_.size() - kHeaderBytes;
    const std::uint64_t count = rest < 4 ? 0 : number_at<std::uint32_t>(bytes_, bytes_.size() - 4);
    if (count == 0 || 4 + count * entry > rest)
      return fail("the file's table of meshes, at its end, does not fit into it");
    if (std::uint64_t(index_) >= count) {
      return fail(fmt::format("there is no mesh {}: the file has {}, counted from 0", index_, count));
    }
    const std::size_t at = bytes_.size() - 4 - std::size_t((count - std::uint64_t(index_)) * entry);
    const std::uint64_t start =
        entry == 8 ? number_at<std::uint64_t>(bytes_, at) : number_at<std::uint32_t>(bytes_, at);
    if (start > rest) {
      return fail(
          fmt::format("mesh {} would start at byte {}, where the file has {}", index_, start, bytes_.size()));
    }
    return std::size_t(start);
  }

  Expected<void> mesh(PackedNumbers& stream, std::uint64_t packed_bytes) {
    const auto flags = stream.number<std::uint32_t>();
    if (!flags) return std::unexpected(flags.error());
    if ((*flags & ~kKnownFlags) != 0)
      result_.warnings.push_back(
          fmt::format("mesh {}: its flags {:#06x} have a meaning that is not known; they are ignored", index_,
                      *flags & ~kKnownFlags));
    const int version = number_at<std::uint16_t>(bytes_, std::size_t(*offset()) + 2);
    if (version >= 4) {
      if (auto done = skip_name(stream); !done) return done;
    }
    const auto vertices = stream.number<std::uint64_t>();
    if (!vertices) return std::unexpected(vertices.error());
    const auto triangles = stream.number<std::uint64_t>();
    if (!triangles) return std::unexpected(triangles.error());
    const bool doubles = (*flags & kDouble) != 0;
    const std::uint64_t numbers = 3u + ((*flags & kNormals) != 0 ? 3 : 0) +
                                  ((*flags & kTexcoords) != 0 ? 2 : 0) + ((*flags & kColours) != 0 ? 3 : 0);
    const std::uint64_t most = packed_bytes * kMostInflation, of_vertex = numbers * (doubles ? 8 : 4);
    constexpr std::uint64_t kMost = std::numeric_limits<std::uint32_t>::max();
    if (*vertices > kMost || *triangles > kMost || *vertices > most / of_vertex || *triangles > most / 12) {
      return fail(fmt::format("it promises {} vertices and {} triangles, which its {} bytes cannot hold",
                              *vertices, *triangles, packed_bytes));
    }
    auto done = doubles ? attributes<double>(stream, *flags, *vertices)
                        : attributes<float>(stream, *flags, *vertices);
    if (!done) return done;
    if (auto read = indices(stream, *vertices, *triangles); !read) return read;
    result_.face_normals = (*flags & kFaceNormals) != 0;
    return {};
  }

  static Expected<void> skip_name(PackedNumbers& stream) {
    for (std::size_t i = 0; i < kMaxNameBytes; ++i) {
      const auto next = stream.number<char>();
      if (!next) return std::unexpected(next.error());
      if (*next == '\0') return {};
    }
    return fail("its name has no end");
  }

  template <typename Number>
  Expected<void> attributes(PackedNumbers& stream, std::uint32_t flags, std::uint64_t vertices) {
    Mesh& m = result_.mesh;
    auto done = values<Number>(stream, vertices, m.positions, "position");
    if (done && (flags & kNormals) != 0) done = values<Number>(stream, vertices, m.normals, "normal");
    if (done && (flags & kTexcoords) != 0)
      done = values<Number>(stream, vertices, m.texcoords, "texture coordinate");
    if (done && (flags & kColours) != 0) done = values<Number>(stream, vertices, m.colours, "colour");
    return done;
  }

  /// Reads one value per vertex. Memory grows as values arrive, because the stated count is not trusted.
  template <typename Number, typename Vector>
  Expected<void> values(PackedNumbers& stream, std::uint64_t count, std::vector<Vector>& to,
                        std::string_view what) {
    constexpr auto kNumbers = std::size_t(Vector::length());
    std::vector<Number> chunk;
    while (to.size() < count) {
      const std::size_t next = std::min<std::size_t>(kChunk, std::size_t(count) - to.size());
      chunk.resize(next * kNumbers);
      if (auto done = stream.read(chunk.data(), chunk.size() * sizeof(Number)); !done) return done;
      for (std::size_t i = 0; i < next; ++i) {
        Vector v;
        for (std::size_t k = 0; k < kNumbers; ++k) {
          const Number number = chunk[i * kNumbers + k];
          v[int(k)] = typename Vector::value_type(number);
          if (std::isfinite(v[int(k)])) continue;
          return fail(
              fmt::format("the {} of vertex {} has {}, not a finite number", what, to.size(), number));
        }
        to.push_back(v);
      }
    }
    return {};
  }

  Expected<void> indices(PackedNumbers& stream, std::uint64_t vertices, std::uint64_t triangles) {
    std::vector<glm::uvec3>& to = result_.mesh.triangles;
    std::vector<glm::uvec3> chunk;
    while (to.size() < triangles) {
      chunk.resize(std::min<std::size_t>(kChunk, std::size_t(triangles) - to.size()));
      if (auto done = stream.read(chunk.data(), chunk.size() * sizeof(glm::uvec3)); !done) return done;
      for (const glm::uvec3& t : chunk) {
        const std::uint32_t largest = std::max({t.x, t.y, t.z});
        if (largest >= vertices) {
          return fail(fmt::format(
              "triangle {}: vertex index {} is out of range: there are {} vertices, counted from 0",
              to.size(), largest, vertices));
        }
        to.push_back(t);
      }
    }
    return {};
  }

  const SourceFile& file_;
  std::string_view bytes_;
  std::int64_t index_;
  MeshFile result_;
};

}  // namespace

Expected<MeshFile> read_serialized(const SourceFile& file, std::int64_t index) {
  return SerializedReader(file, index).read();
}

}  // namespace penumbra
