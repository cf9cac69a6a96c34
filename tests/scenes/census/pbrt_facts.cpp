#include <fmt/format.h>
#include <gtest/gtest.h>

#include <map>
#include <string>
#include <string_view>
#include <tuple>

#include "tests/scenes/census/census.h"
#include "tests/scenes/census/items.h"

namespace penumbra::census {
namespace {

/// Numbers that some parameters need; others are 0.5, which most may be.
const std::map<std::string_view, std::string_view> kPbrtNumbers = {{"fov", "40"},
                                                                   {"iso", "150"},
                                                                   {"whitebalance", "5000"},
                                                                   {"focaldistance", "10"},
                                                                   {"maxcomponentvalue", "10"},
                                                                   {"eta", "1.5"},
                                                                   {"phimax", "90"},
                                                                   {"zmin", "-1"},
                                                                   {"zmax", "1"},
                                                                   {"shutteropen", "0"},
                                                                   {"shutterclose", "1"},
                                                                   {"cropwindow", "0.25 0.75 0.25 0.75"},
                                                                   {"screenwindow", "-1 1 -0.5 0.5"}};

class PbrtWriter {
 public:
  std::string scene(const std::vector<Item>& items) {
    std::string view, world;
    for (const Item& item : items) {
      const bool of_view = item.tag == "Camera" || item.tag == "Film" || item.tag == "Sampler" ||
                           item.tag == "Integrator" || item.tag == "PixelFilter" || item.tag == "Accelerator";
      (of_view ? view : world) += of_view ? directive(item) : in_world(item);
    }
    return view + "WorldBegin\n" + world;
  }

 private:
  static constexpr std::string_view kQuad =
      "Shape \"trianglemesh\" \"integer indices\" [0 1 2 0 2 3] \"point3 P\" [0 0 0 1 0 0 1 1 0 0 1 0]\n";

  std::string in_world(const Item& item) {
    if (item.tag == "Texture") {
      texture_ = fmt::format("texture{}", ++count_);
      const std::string kind = item.name.empty() ? "spectrum" : item.name;
      // Its own textures are those before it.
      const std::string inside = parameters(item);
      last_ = texture_;
      return fmt::format("Texture \"{}\" \"{}\" \"{}\"{}\n", texture_, kind, item.type, inside);
    }
    if (item.tag == "Material" && item.type == "mix")
      return fmt::format(
          "MakeNamedMaterial \"a{0}\" \"string type\" \"diffuse\"\nMakeNamedMaterial \"b{0}\" \"string "
          "type\" "
          "\"conductor\"\nMaterial \"mix\" \"string materials\" [\"a{0}\" \"b{0}\"]{1}\n{2}",
          ++count_, parameters(item), kQuad);
    // What a material is counts where a shape has it.
    if (item.tag == "Material") return directive(item) + std::string(kQuad);
    if (item.tag == "AreaLightSource")
      return fmt::format("AttributeBegin\n{}{}AttributeEnd\n", directive(item), kQuad);
    if (item.tag == "MakeNamedMedium") {
      const std::string name = fmt::format("medium{}", ++count_);
      return fmt::format(
          "MakeNamedMedium \"{0}\" \"string type\" \"{1}\"{2}\nAttributeBegin\nMediumInterface \"{0}\" \"\"\n"
          "Material \"interface\"\nShape \"sphere\"\nAttributeEnd\n",
          name, item.type, parameters(item));
    }
    if (item.tag == "Object")
      return fmt::format("ObjectBegin \"o{0}\"\n{1}ObjectEnd\nObjectInstance \"o{0}\"\n", ++count_, kQuad);
    if (item.tag == "ColorSpace") return fmt::format("ColorSpace \"{}\"\n", item.type);
    if (item.tag == "ActiveTransform")
      return "ActiveTransform EndTime\nTranslate 1 0 0\nActiveTransform All\n";
    return directive(item);
  }

  std::string directive(const Item& item) {
    return fmt::format("{} \"{}\"{}\n", item.tag, item.type, parameters(item, item.tag));
  }

  std::string parameters(const Item& item, std::string_view directive = "") {
    std::string text;
    if (item.type == "trianglemesh" || item.type == "bilinearmesh" || item.type == "loopsubdiv")
      text += " \"point3 P\" [0 0 0 1 0 0 0 1 0 1 1 0] \"integer indices\" [0 1 2" +
              std::string(item.type == "bilinearmesh" ? " 3]" : "]");
    if (item.type == "curve") text += " \"point3 P\" [0 0 0 1 0 0 2 1 0 3 1 0]";
    for (const Item& each : item.inside) {
      const auto& [kind, name, given] = std::tie(each.tag, each.type, each.name);
      const auto put = [&](std::string_view type, std::string_view value) {
        text += fmt::format(" \"{} {}\" [{}]", type, name, value);
      };
      const auto known = kPbrtNumbers.find(name);
      if (kind == "f")
        put("float", known != kPbrtNumbers.end() ? known->second : "0.5");
      else if (kind == "i")
        put("integer", "4");
      else if (kind == "one")
        put("integer", "1");
      else if (kind == "b")
        put("bool", "false");
      else if (kind == "rgb")
        put("rgb", "0.5 0.4 0.3");
      else if (kind == "blackbody")
        put("blackbody", "5500");
      else if (kind == "table")
        put("spectrum", "200 0.2 900 0.2");
      else if (kind == "p")
        put("point3", "1 2 3");
      else if (kind == "portal")
        put("point3", "0 0 0 1 0 0 1 1 0 0 1 0");
      else if (kind == "uv")
        put("point2", "0 0 1 0 1 1 0 1");
      else if (kind == "n")
        put("normal", "0 0 1 0 0 1 0 0 1 0 0 1");
      else if (kind == "tex")
        put("texture", fmt::format("\"{}\"", last_));
      else if (kind == "spectrum")
        put("spectrum", fmt::format("\"{}\"", given.empty() ? "metal.spd" : given));
      else if (!given.empty())
        put("string", fmt::format("\"{}\"", given));
      else
        put("string", fmt::format("\"{}\"", item.type == "plymesh" || item.type == "loopsubdiv" ? "mesh.ply"
                                            : directive == "LightSource"                        ? "sky.pfm"
                                            : item.type == "measured"                           ? "metal.bsdf"
                                                                      : "image.pfm"));
    }
    return text;
  }

  int count_ = 0;
  std::string texture_, last_;
};

}  // namespace

std::string pbrt_text(const Row& row) { return PbrtWriter().scene(read_items(row.items)); }

}  // namespace penumbra::census
