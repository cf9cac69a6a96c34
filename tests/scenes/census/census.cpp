#include "tests/scenes/census/census.h"

#include <fmt/format.h>
#include <gtest/gtest.h>

#include <fstream>
#include <map>
#include <string_view>

#include "scenes/names.h"
#include "tests/scenes/census/items.h"

namespace penumbra::census {
namespace {

std::string_view trimmed(std::string_view text) {
  while (text.starts_with(' ')) text.remove_prefix(1);
  while (text.ends_with(' ')) text.remove_suffix(1);
  return text;
}

std::vector<std::string> fields(std::string_view line) {
  std::vector<std::string> result;
  for (std::size_t at = 0; at <= line.size();) {
    const std::size_t bar = std::min(line.find('|', at), line.size());
    result.emplace_back(trimmed(line.substr(at, bar - at)));
    at = bar + 1;
  }
  return result;
}

bool is_word(char c) { return std::isalnum(static_cast<unsigned char>(c)) != 0 || c == '_'; }

/// With each fragment, "@name" at the start of a word or in brackets, in its place.
std::string filled_in(std::string_view text, const std::map<std::string, std::string>& fragments) {
  std::string result;
  for (std::size_t at = 0; at < text.size();) {
    if (text[at] != '@' || (at > 0 && text[at - 1] != ' ' && text[at - 1] != '(')) {
      result += text[at++];
      continue;
    }
    std::size_t end = at + 1;
    while (end < text.size() && is_word(text[end])) ++end;
    const std::string name(text.substr(at + 1, end - at - 1));
    const auto found = fragments.find(name);
    if (found == fragments.end()) ADD_FAILURE() << "no fragment @" << name;
    if (found != fragments.end()) result += found->second;
    at = end;
  }
  return result;
}

/// Numbers that some parameters need; others are 0.5, which most may be.
const std::map<std::string_view, std::string_view> kNumbers = {{"fov", "45"},
                                                               {"near_clip", "0.1"},
                                                               {"far_clip", "1000"},
                                                               {"focus_distance", "5"},
                                                               {"cutoff_angle", "20"},
                                                               {"beam_width", "15"},
                                                               {"int_ior", "1.5"},
                                                               {"ext_ior", "1"},
                                                               {"ext_eta", "1"},
                                                               {"sun_radius_scale", "2"},
                                                               {"shutter_open", "0.25"},
                                                               {"shutter_close", "1"},
                                                               {"gamma", "2.2"},
                                                               {"eta", "1.33"},
                                                               {"principal_point_offset_x", "0"}};
const std::map<std::string_view, std::string_view> kWhole = {
    {"max_depth", "5"}, {"shape_index", "0"}, {"fov", "45"}};
/// As to_world of lights and cameras is: no mirror, all directions alike.
constexpr std::string_view kPlace = "<rotate y='1' angle='30'/><translate x='1' y='2' z='3'/>";
constexpr std::string_view kMotion =
    "<transform time='0'><translate x='1'/></transform><transform time='1'><rotate y='1' "
    "angle='90'/><translate x='3'/></transform>";

/// What writes a row's items as XML.
class Writer {
 public:
  explicit Writer(std::string_view items) : items_(read_items(items)) {}

  std::string scene() {
    std::string xml;
    for (std::size_t count = 0; count < items_.size(); ++count) {
      const Item& item = items_[count];
      const std::string text = this->item(item, fmt::format(" id='item{}'", count));
      xml += text;
      // What a BSDF is counts where a shape has it.
      const bool shown_on_a_mesh = text.find("mesh_attribute") != text.npos;
      if (item.tag == "bsdf")
        xml += fmt::format("<shape type='{}'>{}<ref id='item{}'/></shape>\n",
                           shown_on_a_mesh ? "ply" : "rectangle",
                           shown_on_a_mesh ? "<string name='filename' value='mesh.ply'/>" : "", count);
      // The group that an instance shows is the last before it.
      if (item.tag == "shape" && item.type == "shapegroup") group_ = fmt::format("item{}", count);
    }
    return xml;
  }

 private:
  std::string item(const Item& item, std::string_view attributes = "") {
    std::string inside = item.type == "instance" ? fmt::format("<ref id='{}'/>", group_) : "";
    for (const Item& each : item.inside)
      inside += each.is_parameter ? parameter(item.type, each.tag, each.type, each.name) : this->item(each);
    return fmt::format("<{} type='{}'{}{}>{}</{}>\n", item.tag, item.type,
                       item.name.empty() ? "" : fmt::format(" name='{}'", item.name), attributes, inside,
                       item.tag);
  }

  static std::string parameter(const std::string& type, std::string_view kind, std::string_view name,
                               const std::string& given) {
    const auto element = [&](std::string_view tag, std::string_view value) {
      return fmt::format("<{} name='{}' value='{}'/>", tag, name, given.empty() ? value : given);
    };
    const auto looked_up = [&](const auto& table, std::string_view other) {
      const auto found = table.find(to_snake_case(name));
      return found != table.end() ? found->second : other;
    };
    if (kind == "i") return element("integer", looked_up(kWhole, "2"));
    if (kind == "f") return element("float", looked_up(kNumbers, "0.5"));
    if (kind == "b") return element("boolean", "true");
    if (kind == "rgb") return element("rgb", "0.5, 0.4, 0.3");
    if (kind == "spec") return element("spectrum", "0.5");
    if (kind == "table") return element("spectrum", "400:0.3, 550:0.5, 700:0.7");
    if (kind == "p") return element("point", name == "p1" ? "0, 2, 0" : "0, 0, 1");
    if (kind == "c") return element("color", "0.5, 0.4, 0.3");
    if (kind == "v") return element("vector", name == "size" ? "0.5, 0.5, 0.5" : "0, 0, 1");
    if (kind == "p2") return element("point", "0.5, 0.25");
    if (kind == "v2") return element("vector", "0.5, 0.25");
    if (kind == "anim") return fmt::format("<animation name='{}'>{}</animation>", name, kMotion);
    if (to_lower_case(name) == "filename") return element("string", file_of(type));
    if (!given.empty()) return element("string", given);
    return fmt::format("<transform name='{}'>{}</transform>", name,
                       to_snake_case(name) == "to_uv" ? "<scale x='2' y='3'/>" : kPlace);
  }

  static std::string_view file_of(const std::string& type) {
    if (type == "obj" || type == "ply" || type == "serialized")
      return type == "obj" ? "mesh.obj" : type == "ply" ? "mesh.ply" : "mesh.serialized";
    if (type == "sdfgrid") return "grid.vol";
    if (type == "gridvolume") return "smoke.vol";
    return type.ends_with("curve") ? "curve.txt" : "image.pfm";
  }

  std::vector<Item> items_;
  std::string group_;
};

}  // namespace

std::vector<Row> read_rows(const std::filesystem::path& file) {
  std::ifstream stream(file);
  EXPECT_TRUE(stream) << file;
  std::map<std::string, std::string> fragments;
  std::vector<Row> rows;
  for (std::string line; std::getline(stream, line);) {
    if (line.empty() || line.starts_with('#')) continue;
    if (line.starts_with('@')) {
      const std::size_t equals = line.find(" = ");
      fragments[line.substr(1, equals - 1)] = filled_in(line.substr(equals + 3), fragments);
      continue;
    }
    std::vector<std::string> parts = fields(line);
    if (parts.size() != 5) {
      ADD_FAILURE() << "not NAME | VERSION | FORK | VERDICT | ITEMS: " << line;
      return {};
    }
    rows.push_back(
        {parts[0], parts[1], parts[2] == "-" ? "" : parts[2], parts[3], filled_in(parts[4], fragments)});
  }
  return rows;
}

std::string nori_text(const Row& row) {
  return fmt::format("<scene>\n{}</scene>\n", Writer(row.items).scene());
}

std::string scene_text(const Row& row) {
  std::string items = Writer(row.items).scene();
  return fmt::format("<scene version='{}'>\n{}</scene>\n", row.version, items);
}

void expect_verdict(const Row& row, const Expected<SceneDescription>& scene, const std::string& text) {
  if (row.verdict == "loads") {
    EXPECT_TRUE(scene) << scene.error().message << "\n" << text;
    return;
  }
  ASSERT_FALSE(scene) << "it loads; the census says '" << row.verdict << "'";
  EXPECT_NE(scene.error().message.find(row.verdict), std::string::npos)
      << scene.error().message << "\n is not about " << row.verdict;
}

std::string grey_image(int width, int height) {
  std::string image = fmt::format("PF\n{} {}\n-1.0\n", width, height);
  const float grey = 0.5f;
  for (int i = 0; i < width * height * 3; ++i)
    image.append(reinterpret_cast<const char*>(&grey), sizeof grey);
  return image;
}

}  // namespace penumbra::census
