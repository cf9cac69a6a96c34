// Reads Nori's XML scenes (Jakob's educational ray tracer and its forks for courses).
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::nori {

/// Whether a file is a Nori scene: XML whose root is <test>, or a <scene> with elements that only Nori has.
bool is_scene(const std::filesystem::path& file);

/// Reads a Nori scene by converting it to the equivalent Mitsuba objects. `options.settings` are not applied
/// here.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::nori
