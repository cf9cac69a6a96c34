#include "scheduler/denoise/flicker.h"

#include <cmath>

#include "scheduler/denoise/layers.h"
#include "scheduler/denoise/motion.h"

namespace penumbra {

Expected<double> flicker(const FramePair& images, const FramePair& reference, double epsilon) {
  Planes radiance[4];
  const Image* const all[] = {&images.frame, &images.next, &reference.frame, &reference.next};
  for (std::size_t k = 0; k < 4; ++k) {
    const auto rgb = all[k]->beauty_channels();
    if (!rgb) return fail("a frame has no channels R, G, B");
    if (all[k]->data != images.frame.data) return fail("frames have different sizes");
    radiance[k] = planes_of(*all[k], *rgb);
  }
  const auto have_motion = [](const FramePair& pair) {
    return has_motion(pair.frame) && has_motion(pair.next);
  };
  if (!have_motion(reference) && !have_motion(images))
    return fail("frames lack the layer motion (--layers motion)");
  const FramePair& seen = have_motion(reference) ? reference : images;
  const SeenPoints points = seen_points(seen.frame);
  PointTracker tracker(points, TimeDirection::kAfter);
  tracker.follow(points, seen_points(seen.next));
  double sum = 0;
  std::size_t count = 0;
  for (std::size_t i = 0; i < tracker.positions().size(); ++i) {
    const auto& at = tracker.positions()[i];
    if (!at) continue;
    for (int c = 0; c < 3; ++c) {
      const double a = radiance[0].plane(c)[i], b = radiance[2].plane(c)[i];
      const double change = (value_at(radiance[1], c, *at) - a) - (value_at(radiance[3], c, *at) - b);
      const double relative = change * change / (b * b + epsilon);
      if (!std::isfinite(relative)) continue;
      sum += relative;
      ++count;
    }
  }
  if (count == 0) return fail("no point is seen in both frames");
  return sum / double(count);
}

}  // namespace penumbra
