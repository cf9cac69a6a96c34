#include "scheduler/advise/work.h"

#include <algorithm>
#include <cmath>

namespace penumbra {
namespace {

constexpr double kSmall = 64;                           // scenes of so few primitives are searched whole
constexpr double kDeeper = 0.09, kShadowDeeper = 0.04;  // for each doubling of the primitives
constexpr double kShadowRay = 0.25;
// A photon is also sorted into its map.
constexpr double kPhotonOverVertex = 1.6;
// Looking up photons: on surfaces those near a point, in media those along a ray.
constexpr double kLookup = 0.1, kLookupInMedia = 1.3;
// The closed forms of polygon lights.
constexpr double kClosedForm = 1.5, kPolygon = 0.15;

}  // namespace

WorkWeights work_weights(const SceneHeader& header) {
  const double primitives = double(header.tables.triangles.count) + double(header.tables.quadrics.count);
  const double depth = std::log2(std::max(1.0, primitives / kSmall));
  WorkWeights weights{.vertex = 1 + kDeeper * depth, .shadow_ray = kShadowRay + kShadowDeeper * depth};
  weights.photon_ray = kPhotonOverVertex * (weights.vertex + weights.shadow_ray);
  if (header.integrator.photons != PHOTONS_NONE)
    weights.vertex += (header.features & FEATURE_MEDIA) != 0u ? kLookupInMedia : kLookup;
  if (header.integrator.estimator != ESTIMATOR_SAMPLES)
    weights.vertex += kClosedForm + kPolygon * double(header.tables.polygons.count);
  return weights;
}

double path_work(const TracedRays& traced, const WorkWeights& weights) {
  return double(traced.rays) * weights.vertex + double(traced.shadow_rays) * weights.shadow_ray;
}

double photon_work(const TracedRays& traced, const WorkWeights& weights) {
  return double(traced.photon_rays) * weights.photon_ray;
}

}  // namespace penumbra
