#include "scenes/mitsuba/sky_reader.h"

#include <fmt/format.h>

#include <algorithm>

namespace penumbra::mitsuba {

void SkyReader::add(const PluginReader& plugin, const SkyParameters& sky, SkyPart part,
                    SceneDescription& scene) {
  const bool has_no_disk = part == SkyPart::kSun && sky.sun_radius_scale == 0.0f;  // a light, but not a sky
  const bool pair = first_ && first_->is != part && first_->is != SkyPart::kBoth && part != SkyPart::kBoth;
  const auto other = std::ranges::find_if(scene.emitters, [](const Emitter& e) { return is_sky(e); });
  const bool is_second = first_ ? !pair : other != scene.emitters.end();
  if (!has_no_disk && is_second)
    return plugin.wrong(fmt::format("{} is a second sky; a scene has one", plugin.title()));
  if (pair && !has_no_disk) {
    const bool is_sun = part == SkyPart::kSun;
    const SkyParameters& above = is_sun ? first_->parameters : sky;
    const Expected<SkyParameters> both = above.with_sun(is_sun ? sky : first_->parameters);
    if (!both) return plugin.wrong(both.error().message);
    Emitter made = std::move(both->emitters(SkyPart::kBoth).front());
    first_->is = SkyPart::kBoth;
    if (is_black(made)) return;
    if (first_->emitter)
      scene.emitters[*first_->emitter] = std::move(made);
    else
      scene.emitters.push_back(std::move(made));
    return;
  }
  if (!has_no_disk) first_ = Part{sky, part, std::nullopt};
  for (Emitter& made : sky.emitters(part)) {
    if (is_black(made)) continue;
    if (is_sky(made)) first_->emitter = scene.emitters.size();
    scene.emitters.push_back(std::move(made));
  }
}

}  // namespace penumbra::mitsuba
