// What is kept of a render's request: everything on which its pixels depend, and nothing else. It is stored
// in the EXR so that the render can be repeated. Therefore it does not contain the number of workers and
// threads, the time or the host.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scheduler/image/image.h"
#include "scheduler/render/render_option.h"

namespace penumbra {

/// A request of which nothing is open any more, with the settings of its scene, on which the pixels depend
/// too. What the settings hold too, such as the crop window and the number of samples, counts as it is there.
struct RenderRecord : RenderSettings, RenderRequest {
  std::uint64_t scene_hash = 0;  ///< SceneDescription::contents_hash

  RenderRecord() {
    plan = {};
    scene.intersector = "portable";
  }
};

/// The command that renders the same bytes again, quoted for a POSIX shell. Without `with_crop` it renders
/// the whole film.
std::string repeat_command(const RenderRecord& record, bool with_crop);

/// Names and values of all settings, for display and metadata. Names are those of `--set` or of command-line
/// options, and values are in the same form; numbers are numbers.
std::vector<std::pair<std::string, MetadataValue>> record_entries(const RenderRecord& record);

/// Which samples of a render are in its image.
struct RenderedSamples {
  bool complete = true;               ///< everything requested was rendered
  bool has_gaps = false;              ///< some pixels may lack earlier samples than others that they have
  std::uint64_t least = 0, most = 0;  ///< per pixel
  /// The backends that computed them: native, opencl, or both; empty: as requested.
  std::string_view backends = {};
  /// Each tile has reached the target error, its allocated samples, or all samples.
  bool ended_by_tile = false;
  std::optional<std::uint64_t> units_in_order = {};  ///< see Merge
  std::size_t scene_warnings = 0;  ///< number of the reader's warnings that the scene is not as the file says

  /// Whether some command renders the same image. Then every pixel has its first samples: equally many, or as
  /// many as its tile's results require, or as many as the first units of the image contain.
  [[nodiscard]] bool repeatable() const {
    return !has_gaps && (least == most || ended_by_tile || units_in_order);
  }
};

/// The record of what was actually rendered, which may be less than requested. Its command repeats the image
/// if that is possible; otherwise it renders all pixels with the largest number of samples of any pixel.
RenderRecord record_of_rendered(RenderRecord record, const RenderedSamples& rendered);

/// The EXR's metadata, all named penumbra:…. `film_hash` is FilmAccumulator::hash(). The scene is named
/// without its folder, so that the same render gives the same file anywhere, and it is identified by its
/// hash. penumbra:scene_warnings is the number of warnings, if any. An image that lacks samples is marked
/// penumbra:incomplete = 1. If no command reproduces it, there is penumbra:nearest_command instead of
/// penumbra:command. penumbra:rendered_by is the backend that was used, if the command leaves it open.
std::vector<std::pair<std::string, MetadataValue>> record_metadata(const RenderRecord& record,
                                                                   std::uint64_t film_hash,
                                                                   const RenderedSamples& rendered);

}  // namespace penumbra
