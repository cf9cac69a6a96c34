#include "scenes/device/matte_book.h"

#include <fmt/format.h>

#include <algorithm>

#include "kernels/host/text.h"
#include "kernels/scene_types.h"
#include "scenes/names.h"

namespace penumbra {
namespace {

/// The name as valid UTF-8, because manifests are JSON.
std::string well_formed(const std::string& name) {
  std::string text;
  for (std::size_t at = 0; at < name.size();) {
    const std::size_t length = character_length(name, at);
    text += length > 0 ? name.substr(at, length) : "?";
    at += std::max<std::size_t>(length, 1);
  }
  return text;
}

bool is_name(const std::string& name) { return !name.empty() && !is_place_name(name); }

}  // namespace

std::uint32_t MatteBook::index_of(const std::string& name, std::vector<std::string>& names, Index& index) {
  const auto [entry, is_new] = index.try_emplace(well_formed(name), std::uint32_t(names.size()));
  if (is_new) names.push_back(entry->first);
  return entry->second;
}

std::string MatteBook::material_name(const Shape& shape) const {
  if (!shape.material.empty()) return shape.material;
  const int bsdf = shape.front_bsdf != kBlackBsdf ? shape.front_bsdf : shape.back_bsdf;
  if (bsdf == kBlackBsdf) return "black";
  const std::string& name = scene_.bsdfs[std::size_t(bsdf)].name;
  return is_name(name) ? name : fmt::format("material-{}", bsdf + 1);
}

std::uint32_t MatteBook::material_of(const Shape& shape) {
  return index_of(material_name(shape), names_.materials, materials_);
}

std::uint32_t MatteBook::object_of(const PlacedGroup& place) {
  const ShapeInstance& instance = scene_.instances[place.instance];
  const std::string& group = scene_.groups[std::size_t(instance.group)].name;
  return index_of(is_name(instance.name) ? instance.name
                  : is_name(group)       ? group
                                         : fmt::format("instance-{}", place.instance + 1),
                  names_.objects, objects_);
}

int MatteBook::number_of(MatteNames::Matte matte) {
  const auto [entry, is_new] =
      numbers_.try_emplace({matte.object, matte.material}, int(names_.mattes.size()) + 1);
  if (is_new) names_.mattes.push_back(matte);
  return entry->second;
}

int MatteBook::of_shape(std::size_t index) {
  const Shape& shape = scene_.shapes[index];
  const std::uint32_t object = index_of(is_name(shape.name) ? shape.name : fmt::format("shape-{}", index + 1),
                                        names_.objects, objects_);
  return number_of({object, material_of(shape)});
}

int MatteBook::of_placed(const PlacedGroup& place, const Shape& shape) {
  const std::uint32_t object = object_of(place);
  return number_of({object, material_of(shape)});
}

int MatteBook::first_of(const PlacedGroup& place) {
  const std::uint32_t object = object_of(place);
  const auto [entry, is_new] = firsts_.try_emplace({object, place.group}, int(names_.mattes.size()) + 1);
  // Too many mattes are an error reported later. The list does not grow further than that check needs.
  if (is_new && names_.mattes.size() <= std::size_t(MAX_MATTES))
    for (const Shape& shape : scene_.groups[std::size_t(place.group)].shapes)
      if (!emits(shape)) names_.mattes.push_back({object, material_of(shape)});
  return entry->second;
}

}  // namespace penumbra
