// Reads <medium> objects with their phase functions.
#pragma once

#include <map>
#include <optional>
#include <set>
#include <vector>

#include "scenes/mitsuba/plugin.h"
#include "scenes/scene_description.h"

namespace penumbra::mitsuba {

class MediumReader {
 public:
  explicit MediumReader(const Context& context) : context_(context) {}

  /// Reads `medium` on the first call. Problems are reported once. If the scene's integrator does not support
  /// media, the medium is left out, which a warning reports elsewhere.
  void read(const Object& medium);

  /// The index of the medium in the scene, to which it is added if it is new; or kNoMedium.
  int install(const Object& medium, SceneDescription& scene);

  /// Sets the media that a shape names as its interior and exterior.
  void install(PluginReader& plugin, Shape& shape, SceneDescription& scene);

 private:
  struct Entry {
    std::optional<ParticipatingMedium> medium;
    int index = kNoMedium;
  };
  using Lobes = std::vector<PhaseLobe>;
  std::optional<ParticipatingMedium> read_new(const Context& context, const Object& medium);
  std::optional<Lobes> read_phase(const Context& context, const Object& phase);
  std::optional<Lobes> read_blend(const Context& context, PluginReader& plugin);

  const Context& context_;
  std::map<const Object*, Entry> media_;
  std::set<const Object*> reading_;  ///< nested blends of phase functions that are being read
};

}  // namespace penumbra::mitsuba
