// Images that are to be merged: what renders they are of, and whether they belong together.
#pragma once

#include <cstdint>
#include <filesystem>
#include <string>
#include <utility>
#include <vector>

#include "kernels/host/error.h"
#include "scheduler/image/image.h"

namespace penumbra {

/// A render whose samples are in an image. An image has one, a merged image several.
struct MergedRender {
  std::uint32_t seed = 0;
  std::string command;  ///< that repeats it, or the nearest one
  friend auto operator<=>(const MergedRender&, const MergedRender&) = default;
};

struct MergeSource {
  std::filesystem::path file;
  Image header;                       ///< without values
  std::vector<MergedRender> renders;  ///< by ascending seed
  double weight = 0;                  ///< its samples per pixel, as asked for
};

/// Of an image's header. Errors, which name what is missing: layers without which statistics cannot be
/// merged, metadata that tell the render; a denoised image.
Expected<MergeSource> merge_source(const std::filesystem::path& file, Image header);

/// Sorts the sources by seed. Errors, with the names of two files: they differ in scene, settings, camera,
/// film or crop, have a seed in common (equal seeds are equal samples: every render begins with the first),
/// or are fewer than two. Sources may differ in seed, samples, passes, backend and file format.
Expected<void> check_sources(std::vector<MergeSource>& sources);

/// The metadata of the merged image: what all sources have in common; `penumbra:seeds`, and
/// `penumbra:merged`, the command of each render on a line of its own; `penumbra:spp` is the sum, and
/// `penumbra:incomplete` is 1 if a source is incomplete. Metadata of Cryptomatte stay.
std::vector<std::pair<std::string, MetadataValue>> merged_metadata(const std::vector<MergeSource>& sources);

/// The seeds of the renders: "1, 2".
std::string seeds_text(const std::vector<MergedRender>& renders);
/// The renders of all sources, by seed.
std::vector<MergedRender> all_renders(const std::vector<MergeSource>& sources);

}  // namespace penumbra
