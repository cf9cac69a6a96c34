#include "scenes/device/owner_book.h"

#include <fmt/format.h>

#include <algorithm>

#include "kernels/host/utf8.h"
#include "kernels/scene_types.h"
#include "scenes/names.h"

namespace penumbra {
namespace {

/// Manifests are JSON.
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

std::uint32_t OwnerBook::index_of(const std::string& name, std::vector<std::string>& names, Index& index) {
  const auto [entry, is_new] = index.try_emplace(well_formed(name), std::uint32_t(names.size()));
  if (is_new) names.push_back(entry->first);
  return entry->second;
}

std::string OwnerBook::material_name(const Shape& shape) const {
  if (!shape.material.empty()) return shape.material;
  const int bsdf = shape.front_bsdf != kBlackBsdf ? shape.front_bsdf : shape.back_bsdf;
  if (bsdf == kBlackBsdf) return "black";
  const std::string& name = scene_.bsdfs[std::size_t(bsdf)].name;
  return is_name(name) ? name : fmt::format("material-{}", bsdf + 1);
}

std::uint32_t OwnerBook::material_of(const Shape& shape) {
  return index_of(material_name(shape), names_.materials, materials_);
}

std::uint32_t OwnerBook::object_of(const PlacedGroup& place) {
  const ShapeInstance& instance = scene_.instances[place.instance];
  const std::string& group = scene_.groups[std::size_t(instance.group)].name;
  return index_of(is_name(instance.name) ? instance.name
                  : is_name(group)       ? group
                                         : fmt::format("instance-{}", place.instance + 1),
                  names_.objects, objects_);
}

int OwnerBook::number_of(OwnerNames::Owner owner) {
  const auto [entry, is_new] =
      numbers_.try_emplace({owner.object, owner.material}, int(names_.owners.size()) + 1);
  if (is_new) names_.owners.push_back(owner);
  return entry->second;
}

int OwnerBook::of_shape(std::size_t index) {
  const Shape& shape = scene_.shapes[index];
  const std::uint32_t object = index_of(is_name(shape.name) ? shape.name : fmt::format("shape-{}", index + 1),
                                        names_.objects, objects_);
  return number_of({object, material_of(shape)});
}

int OwnerBook::of_placed(const PlacedGroup& place, const Shape& shape) {
  const std::uint32_t object = object_of(place);
  return number_of({object, material_of(shape)});
}

int OwnerBook::first_of(const PlacedGroup& place) {
  const std::uint32_t object = object_of(place);
  const auto [entry, is_new] = firsts_.try_emplace({object, place.group}, int(names_.owners.size()) + 1);
  // Too many are an error of the device scene; no more memory than that takes.
  if (is_new && names_.owners.size() <= std::size_t(MAX_OWNERS))
    for (const Shape& shape : scene_.groups[std::size_t(place.group)].shapes)
      if (!emits(shape)) names_.owners.push_back({object, material_of(shape)});
  return entry->second;
}

}  // namespace penumbra
