#include <fmt/format.h>

#include <algorithm>
#include <utility>
#include <vector>

#include "scenes/nori/translate.h"

namespace penumbra::nori {

using mitsuba::Child;
using mitsuba::Object;
using mitsuba::Parameter;

namespace {

struct Renaming {
  std::vector<std::string_view> from;
  const char* to;
};

/// A BSDF with all names that forks have for it (see plain_name).
struct BsdfRow {
  std::vector<std::string_view> names;
  const char* ours;
  std::vector<Renaming> parameters = {};
};
const std::vector<BsdfRow>& rows() {
  static const std::vector<BsdfRow> all = {
      {{"diffuse", "lambertian", "lambert", "matte"},
       "diffuse",
       {{{"albedo", "color", "diffuse", "kd", "base_color", "texture", ""}, "reflectance"}}},
      {{"mirror", "perfectmirror"}, "conductor"},
      {{"dielectric", "glass"}, "dielectric"},
      {{"roughdielectric", "microfacetdielectric", "roughglass"}, "roughdielectric"},
      {{"thindielectric"}, "thindielectric"},
      {{"microfacet"}, "microfacet", {{{"albedo", "texture", ""}, "kd"}}},
      {{"conductor"}, "conductor", {{{"material_name"}, "material"}}},
      {{"roughconductor", "microfacetconductor"}, "roughconductor", {{{"material_name"}, "material"}}},
      {{"plastic", "dielectriccoateddiffuse"}, "plastic", {{{"albedo", "kd"}, "diffuse_reflectance"}}},
      {{"roughplastic"}, "roughplastic", {{{"albedo", "kd"}, "diffuse_reflectance"}}},
      {{"phong"},
       "phong",
       {{{"kd", "albedo", "diffuse"}, "diffuse_reflectance"},
        {{"ks", "specular"}, "specular_reflectance"},
        {{"n"}, "exponent"}}},
      {{"disney", "disneybsdf", "disneybrdf", "disneyprincipled", "principledbrdf"},
       "disney",
       {{{"albedo", "color", "basecolor", "diffuse", "base", "texture", ""}, "base_color"},
        {{"metalness", "metal"}, "metallic"},
        {{"spec_tint"}, "specular_tint"},
        {{"anisotropy"}, "anisotropic"},
        {{"flatness"}, "subsurface"},  // of the thin model, the same mixture
        {{"clear_coat"}, "clearcoat"},
        {{"clear_coat_gloss"}, "clearcoat_gloss"}}},
      {{"null", "nullbsdf", "none", "passthrough", "transparent"}, "null"},
      {{"twosided"}, "twosided"},
      {{"mask", "opacity"}, "mask"},
      {{"blend", "blendbsdf", "mix", "mixbsdf"}, "blendbsdf"},
      {{"normalmap", "normalmapping"}, "normalmap"},
      {{"bumpmap", "bump"}, "bumpmap"}};
  return all;
}

/// Clamps the numbers of Disney's BSDF to [0, 1].
void clamp_numbers(const Translation& t, Object& bsdf) {
  for (Parameter& parameter : bsdf.parameters) {
    const std::optional<double> number = number_of(parameter);
    if (!number || (*number >= 0.0 && *number <= 1.0) || parameter.name == "eta") continue;
    const double clamped = std::clamp(*number, 0.0, 1.0);
    t.report.warn(parameter.value_location,
                  fmt::format("{} is in [0, 1]; {} counts as {}", parameter.name, *number, clamped));
    parameter.value = clamped;
  }
}

/// Forks that have `spec_trans` mean different glass by it.
void reject_transmission(const Translation& t, Object& bsdf) {
  const auto given = take_any(bsdf, {"spec_trans", "specular_transmission"});
  if (!given || number_of(*given) == 0.0) return;
  t.report.unsupported(given->location,
                       fmt::format("{} of Nori's Disney BSDF is read if it is 0; <bsdf type=\"principled\"> "
                                   "is one that transmits light",
                                   given->name),
                       "it counts as 0");
}

/// Wraps the BSDF, which keeps its address, in a map.
void bend(const Translation& t, Object& bsdf, Child map) {
  const bool bump = map.name.starts_with("bump");
  Object& inside = t.new_object("bsdf", "", bsdf.location);
  inside = std::move(bsdf);
  bsdf = Object{};
  bsdf.tag = "bsdf";
  bsdf.type = bump ? "bumpmap" : "normalmap";
  bsdf.location = bsdf.type_location = map.location;
  map.name.clear();
  if (map.object->type == "bitmap") set(*map.object, "raw", true);
  bsdf.children.push_back(std::move(map));
  add_child(bsdf, inside);
}

std::optional<Child> take_map(Object& object) {
  return take_child(object, "texture",
                    {"normal", "normals", "normalmap", "normal_map", "bump", "bumpmap", "bump_map"});
}

}  // namespace

void translate_bsdf(const Translation& t, Object& bsdf) {
  settle_textures(t, bsdf);
  const std::string plain = plain_name(bsdf.type);
  const auto row = std::ranges::find_if(
      rows(), [&](const BsdfRow& each) { return std::ranges::find(each.names, plain) != each.names.end(); });
  if (row == rows().end()) return;  // one of Mitsuba's, or unknown; its reader reports that
  const bool is_disney = std::string_view(row->ours) == "disney";
  if (row->ours != std::string_view("normalmap") && row->ours != std::string_view("bumpmap"))
    for (const Renaming& renaming : row->parameters)
      for (const std::string_view from : renaming.from) rename(bsdf, {from}, renaming.to);
  bsdf.type = row->ours;
  if (is_disney) reject_transmission(t, bsdf);
  if (is_disney) clamp_numbers(t, bsdf);
  if (bsdf.type == "normalmap" || bsdf.type == "bumpmap") {
    for (Child& child : bsdf.children) {
      if (child.object->tag != "texture") continue;
      child.name.clear();
      if (child.object->type == "bitmap") set(*child.object, "raw", true);
    }
    return;
  }
  if (auto map = take_map(bsdf)) bend(t, bsdf, std::move(*map));
}

void bend_bsdf_of(const Translation& t, Object& shape) {
  settle_textures(t, shape);
  auto map = take_map(shape);
  if (!map) return;
  Object& bsdf = *find_child(shape, "bsdf")->object;
  if (bsdf.type == "normalmap" || bsdf.type == "bumpmap")
    return t.report.warn(map->location, "its BSDF has a normal or bump map already; this one is ignored");
  bend(t, bsdf, std::move(*map));
}

}  // namespace penumbra::nori
