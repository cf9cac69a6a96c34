// Nori's XML scenes (Jakob's educational ray tracer and what courses made of it).
#pragma once

#include "scenes/scene_reader.h"

namespace penumbra::nori {

/// Whether a file is one: XML whose root is <scene>, with elements that only Nori has, or <test>.
bool is_scene(const std::filesystem::path& file);

/// Reads a Nori scene, all but `options.settings`: as the objects of Mitsuba that mean the same.
Expected<SceneDescription> read_scene(const std::filesystem::path& file, const ReadOptions& options);

}  // namespace penumbra::nori
