#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <unordered_map>

#include "scenes/mesh_reader.h"
#include "scenes/number.h"

namespace penumbra {
namespace {

/// Indices into the file's v, vt and vn lists, from 0; -1: not given.
struct Corner {
  std::int64_t position = -1, texcoord = -1, normal = -1;
  bool operator==(const Corner&) const = default;
};

struct CornerHash {
  std::size_t operator()(const Corner& c) const {
    std::uint64_t h = std::uint64_t(c.position) * 0x9E3779B97F4A7C15u;
    h = (h ^ (h >> 29) ^ std::uint64_t(c.texcoord)) * 0xBF58476D1CE4E5B9u;
    h = (h ^ (h >> 32) ^ std::uint64_t(c.normal)) * 0x94D049BB133111EBu;
    return std::size_t(h ^ (h >> 31));
  }
};

const std::vector<std::string> kIgnoredStatements = {
    "g",      "o",   "s",          "usemtl",    "mtllib",   "l",        "p",  "vp",    "usemap",
    "maplib", "lod", "shadow_obj", "trace_obj", "c_interp", "d_interp", "mg", "bevel", "polygroup",
};

class ObjReader {
 public:
  explicit ObjReader(const SourceFile& file) : file_(file), text_(file.text) {}

  Expected<Mesh> read() {
    while (at_ < text_.size()) {
      const std::string_view keyword = next_token();
      if (!keyword.empty()) {
        if (auto done = statement(keyword); !done) return std::unexpected(done.error());
      }
      skip_line();
    }
    return finish();
  }

 private:
  /// The next token of the statement; empty at its end. A backslash at the end of a line continues it.
  std::string_view next_token() {
    for (;;) {
      while (at_ < text_.size() && (text_[at_] == ' ' || text_[at_] == '\t' || text_[at_] == '\r')) ++at_;
      if (at_ >= text_.size() || text_[at_] != '\\') break;
      std::size_t end = at_ + 1;
      if (end < text_.size() && text_[end] == '\r') ++end;
      if (end >= text_.size() || text_[end] != '\n') break;
      at_ = end + 1;
    }
    const std::size_t start = at_;
    while (at_ < text_.size() && !is_end(text_[at_])) ++at_;
    token_start_ = start;
    return text_.substr(start, at_ - start);
  }

  static bool is_end(char c) { return c == ' ' || c == '\t' || c == '\r' || c == '\n' || c == '#'; }

  void skip_line() {
    while (!next_token().empty()) {
    }
    const std::size_t end = text_.find('\n', at_);
    at_ = end == text_.npos ? text_.size() : end + 1;
  }

  std::unexpected<Error> wrong(std::string_view message) const {
    return fail(format_diagnostic({&file_, token_start_}, "error", message));
  }

  /// Reads at least `least` and at most `most` numbers, into `values`. Returns how many.
  Expected<int> numbers(std::string_view statement, int least, int most, std::array<double, 7>& values) {
    int count = 0;
    for (std::string_view token = next_token(); !token.empty(); token = next_token()) {
      if (count == most) return wrong(fmt::format("'{}' takes at most {} numbers", statement, most));
      const auto value = parse_number(token);
      if (!value) return wrong(value.error().message);
      values[std::size_t(count++)] = *value;
    }
    if (count < least)
      return wrong(fmt::format("'{}' takes at least {} numbers, not {}", statement, least, count));
    return count;
  }

  Expected<void> statement(std::string_view keyword) {
    std::array<double, 7> v{};
    if (keyword == "v") {
      // A fourth number is a weight that only rational curves use; three or four more are a colour.
      if (const auto count = numbers(keyword, 3, 7, v); !count) return std::unexpected(count.error());
      positions_.push_back({v[0], v[1], v[2]});
    } else if (keyword == "vn") {
      if (const auto count = numbers(keyword, 3, 3, v); !count) return std::unexpected(count.error());
      normals_.push_back({v[0], v[1], v[2]});
    } else if (keyword == "vt") {
      if (const auto count = numbers(keyword, 1, 3, v); !count) return std::unexpected(count.error());
      texcoords_.push_back({v[0], v[1]});
    } else if (keyword == "f" || keyword == "fo") {
      return face();
    } else if (std::find(kIgnoredStatements.begin(), kIgnoredStatements.end(), keyword) ==
               kIgnoredStatements.end()) {
      std::vector<std::string> known = kIgnoredStatements;
      known.insert(known.end(), {"v", "vt", "vn", "f"});
      return wrong(fmt::format("'{}' is not an OBJ statement of polygon meshes{}", keyword.substr(0, 40),
                               suggestion(keyword, known)));
    }
    return {};
  }

  Expected<std::int64_t> index(std::string_view text, std::size_t count, std::string_view what) const {
    const auto value = parse_integer(text);
    if (!value) return wrong(value.error().message);
    const auto size = std::int64_t(count);
    if (*value == 0 || *value > size || *value < -size) {
      return wrong(
          fmt::format("{} index {} is out of range: {} {} so far, counted from 1 (or -1 from the last)", what,
                      *value, size, size == 1 ? "is there" : "are there"));
    }
    return *value > 0 ? *value - 1 : size + *value;
  }

  Expected<void> face() {
    std::vector<std::uint32_t>& polygon = polygon_;
    polygon.clear();
    for (std::string_view token = next_token(); !token.empty(); token = next_token()) {
      std::array<std::string_view, 3> parts;
      std::size_t part = 0;
      for (std::string_view rest = token;;) {
        const std::size_t slash = rest.find('/');
        parts[part] = rest.substr(0, slash);
        if (slash == rest.npos) break;
        if (++part == 3)
          return wrong(fmt::format("'{}' is not a face corner: v, v/vt, v//vn or v/vt/vn", token));
        rest = rest.substr(slash + 1);
      }
      Corner corner;
      const auto position = index(parts[0], positions_.size(), "vertex");
      if (!position) return std::unexpected(position.error());
      corner.position = *position;
      if (!parts[1].empty()) {
        const auto texcoord = index(parts[1], texcoords_.size(), "texture coordinate");
        if (!texcoord) return std::unexpected(texcoord.error());
        corner.texcoord = *texcoord;
      }
      if (!parts[2].empty()) {
        const auto normal = index(parts[2], normals_.size(), "normal");
        if (!normal) return std::unexpected(normal.error());
        corner.normal = *normal;
      }
      polygon.push_back(vertex(corner));
    }
    if (polygon.size() < 3)
      return wrong(fmt::format("a face needs at least 3 corners, not {}", polygon.size()));
    for (std::size_t i = 1; i + 1 < polygon.size(); ++i) {
      mesh_.triangles.push_back({polygon[0], polygon[i], polygon[i + 1]});
    }
    return {};
  }

  std::uint32_t vertex(const Corner& corner) {
    const auto [entry, is_new] = vertices_.try_emplace(corner, std::uint32_t(corners_.size()));
    if (is_new) corners_.push_back(corner);
    return entry->second;
  }

  Expected<Mesh> finish() {
    if (corners_.size() > std::numeric_limits<std::uint32_t>::max()) {
      return fail(fmt::format("{}: more vertices than 32-bit indices reach", file_.path.string()));
    }
    const bool all_normals =
        std::all_of(corners_.begin(), corners_.end(), [](const Corner& c) { return c.normal >= 0; });
    const bool all_texcoords =
        std::all_of(corners_.begin(), corners_.end(), [](const Corner& c) { return c.texcoord >= 0; });
    mesh_.positions.reserve(corners_.size());
    for (const Corner& corner : corners_) {
      mesh_.positions.push_back(positions_[std::size_t(corner.position)]);
      if (all_normals) mesh_.normals.push_back(normals_[std::size_t(corner.normal)]);
      if (all_texcoords) mesh_.texcoords.push_back(texcoords_[std::size_t(corner.texcoord)]);
    }
    return std::move(mesh_);
  }

  const SourceFile& file_;
  std::string_view text_;
  std::size_t at_ = 0;
  std::size_t token_start_ = 0;
  std::vector<glm::dvec3> positions_;
  std::vector<glm::dvec3> normals_;
  std::vector<glm::dvec2> texcoords_;
  std::vector<Corner> corners_;
  std::unordered_map<Corner, std::uint32_t, CornerHash> vertices_;
  std::vector<std::uint32_t> polygon_;
  Mesh mesh_;
};

}  // namespace

Expected<Mesh> read_obj(const SourceFile& file) { return ObjReader(file).read(); }

}  // namespace penumbra
