// <medium> objects, with their phase functions.
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

  /// Reads `medium`, once. What is wrong with it is reported, once; where the scene's integrator does not see
  /// media, it is left out instead, and there is a warning anyway.
  void read(const Object& medium);

  /// Its index among the scene's media, which it is added to where it is new, or kNoMedium.
  int install(const Object& medium, SceneDescription& scene);

  /// Those that a shape names as its interior and its exterior.
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
  std::set<const Object*> reading_;  ///< blends of phase functions
};

}  // namespace penumbra::mitsuba
