// What a render was asked to do: everything that its pixels depend on, and nothing else. It goes into the
// EXR, where it repeats the render, so how many workers and threads there were, the time and the host have no
// place here.
#pragma once

#include <cstdint>
#include <optional>
#include <string>
#include <string_view>
#include <utility>
#include <vector>

#include "scenes/scene_description.h"
#include "scheduler/image/image.h"
#include "worker/device.h"

namespace penumbra {

/// The film's crop is what was rendered, and the sampler's number of samples what its sequences are made for.
struct RenderRecord : RenderSettings {
  std::string scene;                  ///< as named by the user
  std::uint64_t scene_hash = 0;       ///< SceneDescription::contents_hash
  std::vector<std::string> defines;   ///< -D name=value
  std::vector<std::string> settings;  ///< --set key=value
  bool lenient = false;
  std::string dialect;  ///< --dialect; empty: what the scene file tells
  /// Only so many of them are rendered; nothing: all.
  std::optional<std::uint32_t> stop_after;
  /// Only the first so many units, of `tile` and `samples_per_pass`, pass by pass and tile by tile; nothing:
  /// all.
  std::optional<std::uint64_t> stop_after_units;
  std::uint32_t samples_per_pass = 16;
  std::optional<double> target_error;  ///< of each tile
  bool adaptive = false;               ///< see SampleAllocation
  int tile = 0;  ///< pixels along a side; matters with the last two, and with stop_after_units
  bool feature_layers = true;
  bool cryptomatte = false;
  bool embree = false;  ///< else the portable intersector
  Backend backend = Backend::kNative;
  std::string isa;  ///< Embree's choices depend on the instruction set; empty where it makes no difference
};

/// The command that renders the same bytes again, quoted for a POSIX shell. Without `with_crop` it is the
/// command for the whole film.
std::string repeat_command(const RenderRecord& record, bool with_crop);

/// Name and value of every setting, for people and for metadata; names are those of `--set` or of the command
/// line's options, and values what these take, numbers as numbers.
std::vector<std::pair<std::string, MetadataValue>> record_entries(const RenderRecord& record);

/// What of a render is in its image.
struct RenderedSamples {
  bool complete = true;               ///< all that was asked for
  bool has_gaps = false;              ///< pixels may lack samples that come before others that they have
  std::uint64_t least = 0, most = 0;  ///< of a pixel
  std::string_view backends = {};     ///< what computed them: native, opencl, or both; empty: as was asked
  bool ended_by_tile = false;         ///< each tile has come to the target error, its share, or all samples
  std::optional<std::uint64_t> units_in_order = {};  ///< see Merge
  std::size_t scene_warnings = 0;                    ///< of its reader: what is not as the file says

  /// Whether some command renders the same image: every pixel has the first samples, equally many, or as many
  /// as its tile's results ask for, or as many as the first units of all have.
  [[nodiscard]] bool repeatable() const {
    return !has_gaps && (least == most || ended_by_tile || units_in_order);
  }
};

/// The record of what was rendered, where that may be less than what was to be. Its command repeats the image
/// if any does; else it renders every pixel as far as the image's furthest.
RenderRecord record_of_rendered(RenderRecord record, const RenderedSamples& rendered);

/// Metadata of the EXR, all named penumbra:…; `film_hash` is FilmAccumulator::hash(). The scene is named
/// without its folder, so that the same render is the same file wherever it is, and identified by its hash.
/// penumbra:scene_warnings is how many there were, if any. An image that misses samples is marked
/// penumbra:incomplete = 1; if no command renders it again, there is penumbra:nearest_command instead of
/// penumbra:command. penumbra:rendered_by is what a backend came to that the command leaves open.
std::vector<std::pair<std::string, MetadataValue>> record_metadata(const RenderRecord& record,
                                                                   std::uint64_t film_hash,
                                                                   const RenderedSamples& rendered);

/// The hash as 16 hexadecimal digits.
std::string hash_text(std::uint64_t hash);

}  // namespace penumbra
