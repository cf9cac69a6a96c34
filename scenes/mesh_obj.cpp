#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <limits>
#include <map>
#include <optional>

#include "scenes/mesh_reader.h"
#include "scenes/names.h"
#include "scenes/number.h"
#include "scenes/statement_scanner.h"

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
    "s",          "l",         "p",        "vp",       "usemap", "maplib", "lod",
    "shadow_obj", "trace_obj", "c_interp", "d_interp", "mg",     "bevel",  "polygroup",
};

std::string_view first_line(std::string_view text) { return text.substr(0, text.find('\n')); }

/// A group while it grows.
class OpenGroup {
 public:
  ObjGroup result;
  std::vector<Corner> corners;  ///< the corner from which each vertex was made

  /// The vertex of the corner, which is new if there is no equal one.
  std::uint32_t vertex(const Corner& corner) {
    if (2 * (corners.size() + 1) > places_.size()) {
      places_.assign(std::max<std::size_t>(16, 2 * places_.size()), kFree);
      for (std::size_t i = 0; i < corners.size(); ++i) place_of(corners[i]) = std::uint32_t(i);
    }
    std::uint32_t& place = place_of(corner);
    if (place == kFree) {
      place = std::uint32_t(corners.size());
      corners.push_back(corner);
    }
    return place;
  }

 private:
  static constexpr std::uint32_t kFree = std::numeric_limits<std::uint32_t>::max();
  /// A hash table of vertices, at most half full: a node for each vertex takes as long as its text.
  std::vector<std::uint32_t> places_;

  std::uint32_t& place_of(const Corner& corner) {
    std::size_t at = CornerHash{}(corner) & (places_.size() - 1);
    while (places_[at] != kFree && !(corners[places_[at]] == corner)) at = (at + 1) & (places_.size() - 1);
    return places_[at];
  }
};

class ObjReader {
 public:
  /// Reads all faces into one group, or into one group per object and material.
  ObjReader(const SourceFile& file, bool by_group) : scanner_(file), file_(file), by_group_(by_group) {}

  Expected<ObjModel> read() {
    while (!scanner_.at_end()) {
      const std::string_view keyword = scanner_.token();
      if (!keyword.empty()) {
        if (auto done = statement(keyword); !done) return std::unexpected(done.error());
      }
      scanner_.next();
    }
    return finish();
  }

 private:
  Expected<void> statement(std::string_view keyword) {
    std::array<double, 7> v{};
    if (keyword == "v") {
      // A fourth number is a weight of rational curves, which are ignored. Three or four further numbers are
      // a colour.
      const auto count = scanner_.numbers(keyword, 3, 7, v);
      if (!count) return std::unexpected(count.error());
      if (*count >= 6) {
        colours_.resize(positions_.size() + 1, glm::vec3(1.0f));
        colours_.back() = glm::vec3(v[3], v[4], v[5]);
      }
      positions_.push_back({v[0], v[1], v[2]});
    } else if (keyword == "vn") {
      if (const auto count = scanner_.numbers(keyword, 3, 3, v); !count)
        return std::unexpected(count.error());
      normals_.push_back({v[0], v[1], v[2]});
    } else if (keyword == "vt") {
      if (const auto count = scanner_.numbers(keyword, 1, 3, v); !count)
        return std::unexpected(count.error());
      texcoords_.push_back({v[0], v[1]});
    } else if (keyword == "f" || keyword == "fo") {
      return face();
    } else if (keyword == "o" || keyword == "g") {
      object_ = scanner_.rest();
      group_ = nullptr;
      return check_name("name of an object", object_);
    } else if (keyword == "usemtl") {
      const std::string_view name = scanner_.rest();
      material_ = {std::string(name), scanner_.location()};
      group_ = nullptr;
      return check_name("name of a material", name);
    } else if (keyword == "mtllib") {
      const std::string_view name = scanner_.rest();
      model_.libraries.push_back({std::string(name), scanner_.location()});
    } else if (std::find(kIgnoredStatements.begin(), kIgnoredStatements.end(), keyword) ==
               kIgnoredStatements.end()) {
      std::vector<std::string> known = kIgnoredStatements;
      known.insert(known.end(), {"v", "vt", "vn", "f", "g", "o", "usemtl", "mtllib"});
      if (unknown_++ == 0)
        first_unknown_ = scanner_
                             .wrong(fmt::format("'{}' is not an OBJ statement of polygon meshes{}",
                                                keyword.substr(0, 40), suggestion(keyword, known)))
                             .error();
    }
    return {};
  }

  Expected<void> check_name(std::string_view kind, std::string_view name) const {
    if (const auto checked = check_name_length(kind, name); !checked)
      return scanner_.wrong(checked.error().message);
    return {};
  }

  /// `may_follow`: what it counts may come after the face, or not at all (see drop_absent).
  Expected<std::int64_t> index(std::string_view text, std::size_t count, std::string_view what,
                               bool may_follow) const {
    const auto value = parse_integer(text);
    if (!value) return scanner_.wrong(value.error().message);
    const auto size = std::int64_t(count);
    if (may_follow && *value > size) return *value - 1;
    if (*value == 0 || *value > size || *value < -size) {
      return scanner_.wrong(
          fmt::format("{} index {} is out of range: {} {} so far, counted from 1 (or -1 from the last)", what,
                      *value, size, size == 1 ? "is there" : "are there"));
    }
    return *value > 0 ? *value - 1 : size + *value;
  }

  Expected<Corner> corner(std::string_view token) const {
    std::array<std::string_view, 3> parts;
    std::size_t part = 0;
    for (std::string_view rest = token;;) {
      const std::size_t slash = rest.find('/');
      parts[part] = rest.substr(0, slash);
      if (slash == rest.npos) break;
      if (++part == 3)
        return scanner_.wrong(fmt::format("'{}' is not a face corner: v, v/vt, v//vn or v/vt/vn", token));
      rest = rest.substr(slash + 1);
    }
    Corner result;
    const auto position = index(parts[0], positions_.size(), "vertex", false);
    if (!position) return std::unexpected(position.error());
    result.position = *position;
    if (!parts[1].empty()) {
      const auto texcoord = index(parts[1], texcoords_.size(), "texture coordinate", true);
      if (!texcoord) return std::unexpected(texcoord.error());
      result.texcoord = *texcoord;
    }
    if (!parts[2].empty()) {
      const auto normal = index(parts[2], normals_.size(), "normal", true);
      if (!normal) return std::unexpected(normal.error());
      result.normal = *normal;
    }
    return result;
  }

  Expected<void> face() {
    const SourceLocation location = scanner_.location();
    OpenGroup& group = open_group(location);
    polygon_.clear();
    outline_.clear();
    bool is_textured = true;
    for (std::string_view token = scanner_.token(); !token.empty(); token = scanner_.token()) {
      const auto read = corner(token);
      if (!read) return std::unexpected(read.error());
      polygon_.push_back(group.vertex(*read));
      outline_.push_back(positions_[std::size_t(read->position)]);
      is_textured = is_textured && read->texcoord >= 0;
    }
    ObjGroup& result = group.result;
    if (!is_textured) note(result.faces.untextured, location, "");
    const auto done = cut_face(outline_, polygon_, location, "", result.mesh.triangles, result.faces);
    if (!done) return fail(format_diagnostic(location, "error", done.error().message));
    return {};
  }

  /// The group that a face at `location` belongs to.
  OpenGroup& open_group(SourceLocation location) {
    if (group_ != nullptr) return *group_;
    const auto [entry, is_new] = by_name_.try_emplace(by_group_ ? std::pair(object_, material_.name)
                                                                : std::pair<std::string, std::string>());
    group_ = &entry->second;
    if (is_new) {
      order_.push_back(group_);
      group_->result.object = object_;
      group_->result.material = material_;
      group_->result.location = location;
    }
    return *group_;
  }

  /// Corners go without what the file does not have.
  void drop_absent(std::int64_t Corner::*index, std::size_t count, std::string_view what) {
    std::size_t dropped = 0;
    for (OpenGroup* group : order_) {
      for (Corner& corner : group->corners) {
        if (corner.*index < std::int64_t(count)) continue;
        corner.*index = -1;
        ++dropped;
      }
    }
    if (dropped > 0)
      model_.warnings.push_back(fmt::format("{} {} {} that the file does not have, and {} without", dropped,
                                            dropped == 1 ? "vertex names a" : "vertices name a", what,
                                            dropped == 1 ? "goes" : "go"));
  }

  Expected<ObjModel> finish() {
    // Nothing but statements that are unknown is no OBJ file.
    if (first_unknown_ && positions_.empty()) return std::unexpected(*first_unknown_);
    if (first_unknown_)
      model_.warnings.push_back(fmt::format("{} {} ignored, the first of them: {}", unknown_,
                                            unknown_ == 1 ? "statement is" : "statements are",
                                            first_line(first_unknown_->message)));
    drop_absent(&Corner::texcoord, texcoords_.size(), "texture coordinate");
    drop_absent(&Corner::normal, normals_.size(), "normal");
    for (OpenGroup* group : order_) {
      if (group->corners.size() > std::numeric_limits<std::uint32_t>::max()) {
        return fail(fmt::format("{}: more vertices than 32-bit indices reach", file_.path.string()));
      }
      fill_vertices(*group);
      model_.groups.push_back(std::move(group->result));
    }
    return std::move(model_);
  }

  void fill_vertices(OpenGroup& group) const {
    const std::vector<Corner>& corners = group.corners;
    Mesh& mesh = group.result.mesh;
    const bool has_normals = std::ranges::any_of(corners, [](const Corner& c) { return c.normal >= 0; });
    const bool has_texcoords = std::ranges::any_of(corners, [](const Corner& c) { return c.texcoord >= 0; });
    if (!has_texcoords) group.result.faces.untextured = {};
    mesh.positions.reserve(corners.size());
    for (const Corner& each : corners) {
      mesh.positions.push_back(positions_[std::size_t(each.position)]);
      if (!colours_.empty())
        mesh.colours.push_back(std::size_t(each.position) < colours_.size()
                                   ? colours_[std::size_t(each.position)]
                                   : glm::vec3(1.0f));
      if (has_normals)
        mesh.normals.push_back(each.normal >= 0 ? normals_[std::size_t(each.normal)] : glm::dvec3(0.0));
      if (has_texcoords)
        mesh.texcoords.push_back(each.texcoord >= 0 ? texcoords_[std::size_t(each.texcoord)]
                                                    : glm::dvec2(0.0));
    }
  }

  StatementScanner scanner_;
  const SourceFile& file_;
  const bool by_group_;
  std::vector<glm::dvec3> positions_;
  /// May be shorter than the vertices: ends with the last one that has a colour.
  std::vector<glm::vec3> colours_;
  std::vector<glm::dvec3> normals_;
  std::vector<glm::dvec2> texcoords_;
  std::string object_;
  ObjName material_;
  std::map<std::pair<std::string, std::string>, OpenGroup> by_name_;  ///< by object and material
  std::vector<OpenGroup*> order_;
  std::size_t unknown_ = 0;  ///< statements
  std::optional<Error> first_unknown_;
  OpenGroup* group_ = nullptr;  ///< of the next face, once there has been one
  std::vector<std::uint32_t> polygon_;
  std::vector<glm::dvec3> outline_;
  ObjModel model_;
};

}  // namespace

Expected<MeshFile> read_obj(const SourceFile& file) {
  auto model = ObjReader(file, false).read();
  if (!model) return std::unexpected(model.error());
  if (model->groups.empty()) return MeshFile{};
  ObjGroup& all = model->groups.front();
  return MeshFile{std::move(all.mesh), std::move(all.faces), false, std::move(model->warnings)};
}

Expected<ObjModel> read_obj_groups(const SourceFile& file) { return ObjReader(file, true).read(); }

}  // namespace penumbra
