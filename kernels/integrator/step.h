// What the steps of all integrators share. LANES paths at a time go through short stages, each of which is a
// lane loop over records that stay in the L1 cache. A stage that the scene does not need is not called.
#ifndef PENUMBRA_STEP_H
#define PENUMBRA_STEP_H
#include "kernels/block/block_surface.h"
#include "kernels/bsdf/bsdf.h"
#include "kernels/bsdf/control_lanes.h"
#include "kernels/bsdf/material_tree.h"
#include "kernels/light/light.h"
#include "kernels/light/mis.h"
#include "kernels/motion/motion_layer.h"
#include "kernels/sampler/sampler.h"

PENUMBRA_NAMESPACE_BEGIN

// Stages that write many fields of paths copy the pointers to the fields first: otherwise OpenCL compilers
// assume that every store may change the pointers.

/// LANES paths during a step.
typedef struct {
  float u[STEP_DIMENSIONS * LANES];  ///< random numbers, DIM_* of lane j at DIM_* * LANES + j
  Surfaces surfaces;                 ///< where they scatter
  Closures closures;                 ///< their BSDFs at those surfaces
  ulong families;                    ///< of the closures
  FoundLights found;                 ///< the lights that their last rays hit
  Emissions emissions;               ///< the emission of those lights
  LightSamplings samplings;
  LightSamples lights;
  ControlLanes controls;  ///< control lobes of the closures, see request_lights
  BsdfValues values;      ///< BSDF values towards the lights
  BsdfSamples samples;    ///< samples of a next direction
  float eta[LANES];       ///< refractive index after that sample, relative to the one at the camera
  int inner[LANES];       ///< of the path's depth, how much is in interiors: see interiors.h
  int within[LANES];      ///< 1: it scatters inside a material, or goes in
} StepLanes;

FN float lane_number(const PRIVATE StepLanes* step, int dimension, int j) {
  return step->u[dimension * LANES + j];
}

/// Initialises a step.
FN void start_step(PRIVATE StepLanes* step) {
  for (int k = 0; k < STEP_DIMENSIONS * LANES; k++) step->u[k] = 0.0f;
  for (int j = 0; j < LANES; j++) store_closure(&step->closures, j, black_closure());
  for (int j = 0; j < LANES; j++) step->eta[j] = 1.0f;
  for (int j = 0; j < LANES; j++) step->inner[j] = step->within[j] = 0;
  // For scenes without tangents.
  const Surface nothing = surface_in_medium(make_vec3(0.0f, 0.0f, 0.0f));
  for (int j = 0; j < LANES; j++) store_surface_uv(&step->surfaces, j, nothing);
  for (int j = 0; j < LANES; j++) step->surfaces.instance[j] = -1;
  clear_light_samplings(&step->samplings);
}

/// Resolves the BSDFs of the paths' surfaces.
JIT_CALLED_FN void resolve_step_closures(const PRIVATE Scene* scene, PRIVATE StepLanes* step) {
  resolve_closures(scene, &step->surfaces, &step->closures);
  step->families = families_among(&step->closures);
}

/// Chooses lights and points on them.
FN void sample_step_lights(const PRIVATE Scene* scene, PRIVATE StepLanes* step) {
  sample_lights(scene, &step->surfaces, step->u + DIM_LIGHT_U * LANES, step->u + DIM_LIGHT_V * LANES,
                step->u + DIM_LIGHT_FINE * LANES, &step->samplings, &step->lights);
}

/// Whether samples of polygon lights use their closed form as control variate.
FN bool has_control(const PRIVATE Scene* scene) {
  return NEEDS(scene, POLYGONS) && scene->header.integrator.estimator != ESTIMATOR_SAMPLES;
}

/// Whether the control variate of some BSDFs differs from the BSDF (linearly transformed cosines).
FN bool has_lobe_control(const PRIVATE Scene* scene) { return NEEDS_LTC(scene) && has_control(scene); }

/// Whether light samples of polygons at a surface with this closure use the closed form as control variate.
FN bool is_controlled(const PRIVATE Scene* scene, Closure c, bool of_polygon) {
  const bool nearly = HAS(LTC) && (NEEDS_LTC(scene) & has_ltc_form(c));
  return has_control(scene) & (has_closed_form(c) | nearly) & of_polygon;
}

/// Whether no light passes along wi because the normals disagree about its side, see is_beneath. Surfaces
/// that let light through, the mirrors of panes among them, lose none: their mesh would be darker than the
/// smooth shape that it stands for. An open coat reflects whatever is above the geometric surface.
FN bool is_cut_off(const PRIVATE Scene* scene, Surface s, Closure c, vec3 wi) {
  bool through = lets_light_through(c);
  if (NEEDS(scene, PANES)) through = through | (pane_of(scene, s.material) > 0.0f);
  bool beneath = is_beneath(s, wi);
  if (NEEDS(scene, COAT_NORMALS)) beneath = has_open_coat(c) ? !(dot3(s.geometric, wi) > 0.0f) : beneath;
  return beneath & !through;
}

/// Requests the shadow ray of lane i's light sample. `arriving` is its contribution if it is unoccluded.
/// `controlled`: see is_controlled.
FN void request_shadow_ray(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, Surface s,
                           Closure c, LightSample light, vec3 arriving, bool lit, bool controlled) {
  const bool beneath = is_cut_off(scene, s, c, light.wi) & (scene->header.integrator.trace_shadows != 0);
  set_shadow_origin(paths, i, light.origin);
  set_shadow_direction(paths, i, light.toward);
  set_shadow_radiance(paths, i, arriving);
  set_shadow_tmax(paths, i, (lit & (controlled | !beneath)) ? light.tmax : -1.0f);
  set_shadow_skip(paths, i, s.primitive);
  if (NEEDS(scene, BENT)) set_shadow_share(paths, i, bump_shadow(s, light.wi));
  if (NEEDS(scene, POLYGONS))
    set_shadow_controlled(paths, i,
                          controlled ? (beneath ? CONTROL_BENEATH : CONTROL_IN_SIGHT) : CONTROL_NONE);
}

/// If the control variate differs from the BSDF, light samples are valid wherever the variate is above 0,
/// even if the BSDF's value is 0.
STAGE void admit_controls(const PRIVATE Scene* scene, PRIVATE StepLanes* RESTRICT step) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Closure c = load_closure(&step->closures, j);
      const LightSample light = load_light_sample(&step->lights, j);
      const bool counts = is_controlled(scene, c, light.of_polygon) & has_ltc_form(c) &
                          (dot3(LOAD_LANE_vec3(step->surfaces.shading, j), light.wi) > 0.0f);
      const float pdf = step->values.pdf[j];
      step->values.pdf[j] = counts ? max_f(pdf, 1e-30f) : pdf;
    }
}

/// The unoccluded contribution of shadow rays to the control variate. For exact closed forms it equals the
/// contribution to the path. Each light sample is one of `samples`; `path`: paths have a throughput.
STAGE void request_controls(const PRIVATE Scene* scene, const PRIVATE PathState* paths, int i, float samples,
                            bool path, const PRIVATE StepLanes* RESTRICT step) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const Surface s = load_surface(&step->surfaces, j);
      const LightSample light = load_light_sample(&step->lights, j);
      const vec3 value = control_value(load_control_lobes(&step->controls, j), to_frame(s.shading, s.wo),
                                       to_frame(s.shading, light.wi));
      const float weight = 1.0f / (samples * (light.pdf > 0.0f ? light.pdf : 1.0f));
      const vec3 one = make_vec3(1.0f, 1.0f, 1.0f);
      const vec3 carried = select3(path, get_throughput(paths, i + j), one);
      const vec3 arriving = mul(carried, scale(mul(value, light.radiance), weight));
      const bool own = has_ltc_form(load_closure(&step->closures, j));
      set_shadow_control(paths, i + j, select3(own, arriving, get_shadow_radiance(paths, i + j)));
    }
}

/// Multiplies the weights of sampled directions by the fraction that bumps let through.
STAGE void shade_samples(const PRIVATE Surfaces* RESTRICT surfaces, PRIVATE BsdfSamples* RESTRICT samples) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      const float share = bump_shadow(load_surface(surfaces, j), LOAD_LANE_vec3(samples->wi, j));
      const vec3 weight = LOAD_LANE_vec3(samples->weight, j);
      STORE_LANE_vec3(samples->weight, j, scale(weight, share));
    }
}

/// The same, if the scene has bumps.
FN void shade_bumps(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                    PRIVATE BsdfSamples* samples) {
  if (NEEDS(scene, BENT)) shade_samples(surfaces, samples);
}

/// Albedo, normal and depth of the camera rays' hits.
STAGE void record_layers(const PRIVATE Surfaces* RESTRICT surfaces, const PRIVATE Closures* RESTRICT closures,
                         const PRIVATE PathState* paths, int i, const PRIVATE SlotState* slots) {
  for (int j = 0; j < LANES; j++) {  // no lane loop: slots are scattered
    const Surface s = load_surface(surfaces, j);
    const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
    const int slot = get_slot(paths, i + j);
    set_slot_albedo(slots, slot, select3(is_hit(s), closure_albedo(load_closure(closures, j)), zero));
    set_slot_normal(slots, slot, select3(is_hit(s), s.shading, zero));
    set_slot_distance(slots, slot, is_hit(s) ? s.distance : 0.0f);
  }
}

/// Alpha: whether camera rays hit something. Beyond a fisheye's circle, where samples weigh nothing, it is 0.
STAGE void record_coverage(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                           const PRIVATE PathState* paths, int i, const PRIVATE SlotState* slots) {
  const float sky = scene->header.film.sky_coverage;
  for (int j = 0; j < LANES; j++) {  // no lane loop: slots are scattered
    const int slot = get_slot(paths, i + j);
    const bool beyond = NEEDS_PANORAMA(scene) && get_slot_filter_weight(slots, slot) == 0.0f;
    set_slot_coverage(slots, slot, surfaces->primitive[j] != NOTHING_HIT ? 1.0f : (beyond ? 0.0f : sky));
  }
}

/// The mattes that camera rays hit, or NO_MATTE. Kernels may be compiled for more than the scene has: without
/// the tables there are no mattes.
STAGE void record_mattes(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                         const PRIVATE PathState* paths, int i, const PRIVATE SlotState* slots) {
  for (int j = 0; j < LANES; j++) {  // no lane loop: slots are scattered
    const int primitive = surfaces->primitive[j];
    const bool known = (primitive >= 0) & (primitive < scene->header.tables.mattes.count);
    int matte = scene->mattes[known ? primitive : 0];
    const int instance = NEEDS(scene, INSTANCES) ? surfaces->instance[j] : -1;
    const bool placed = (instance >= 0) & (instance < scene->header.tables.instance_mattes.count);
    const int first = scene->instance_mattes[placed ? instance : 0];
    matte += placed ? first : 0;
    set_slot_matte(slots, get_slot(paths, i + j), known ? matte : NO_MATTE);
  }
}

/// World-space positions of the camera rays' hits.
STAGE void record_positions(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                            const PRIVATE PathState* paths, int i, const PRIVATE SlotState* slots) {
  const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f), center = scene->header.center;
  for (int j = 0; j < LANES; j++) {  // no lane loop: slots are scattered
    const Surface s = load_surface(surfaces, j);
    set_slot_position(slots, get_slot(paths, i + j), select3(is_hit(s), add(s.p, center), zero));
  }
}

/// Their texture coordinates. Those of a file that are not finite do not spoil the sample.
STAGE void record_uvs(const PRIVATE Surfaces* RESTRICT surfaces, const PRIVATE PathState* paths, int i,
                      const PRIVATE SlotState* slots) {
  const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
  for (int j = 0; j < LANES; j++) {
    const Surface s = load_surface(surfaces, j);
    const vec3 uv = make_vec3(s.u, s.v, 0.0f);
    set_slot_uv(slots, get_slot(paths, i + j), select3(is_hit(s) & is_finite3(uv), uv, zero));
  }
}

/// Their geometric normals, which face the camera as shading normals do.
STAGE void record_geometric_normals(const PRIVATE Surfaces* RESTRICT surfaces, const PRIVATE PathState* paths,
                                    int i, const PRIVATE SlotState* slots) {
  const vec3 zero = make_vec3(0.0f, 0.0f, 0.0f);
  for (int j = 0; j < LANES; j++) {
    const Surface s = load_surface(surfaces, j);
    set_slot_geometric_normal(slots, get_slot(paths, i + j), select3(is_hit(s), s.geometric, zero));
  }
}

/// The numbers of their shapes; 0: there is none. Kernels may be compiled for more than the scene has, see
/// record_mattes.
STAGE void record_shapes(const PRIVATE Scene* scene, const PRIVATE Surfaces* RESTRICT surfaces,
                         const PRIVATE PathState* paths, int i, const PRIVATE SlotState* slots) {
  for (int j = 0; j < LANES; j++) {
    const int primitive = surfaces->primitive[j];
    const bool known = (primitive >= 0) & (primitive < scene->header.tables.primitive_shapes.count);
    const int shape = scene->primitive_shapes[known ? primitive : 0];
    set_slot_shape(slots, get_slot(paths, i + j), known ? (float)shape : 0.0f);
  }
}

/// Writes what the film stores of the camera rays' hits.
FN void record_first_hits(const PRIVATE Scene* scene, const PRIVATE Surfaces* surfaces,
                          const PRIVATE Closures* closures, const PRIVATE PathState* paths, int i,
                          const PRIVATE SlotState* slots) {
  if (NEEDS(scene, LAYERS)) record_layers(surfaces, closures, paths, i, slots);
  if (NEEDS(scene, COVERAGE)) record_coverage(scene, surfaces, paths, i, slots);
  if (NEEDS(scene, MATTES)) record_mattes(scene, surfaces, paths, i, slots);
  if (NEEDS(scene, POSITION_LAYER)) record_positions(scene, surfaces, paths, i, slots);
  if (NEEDS(scene, UV_LAYER)) record_uvs(surfaces, paths, i, slots);
  if (NEEDS(scene, GEOMETRIC_NORMAL_LAYER)) record_geometric_normals(surfaces, paths, i, slots);
  if (NEEDS(scene, SHAPE_LAYER)) record_shapes(scene, surfaces, paths, i, slots);
  if (NEEDS(scene, MOTION_LAYER)) record_motion(scene, surfaces, paths, i, slots);
}

// For integrators whose samples all start at the surface that the camera ray hit: the surface is kept, and
// step k takes the k-th sample.

STAGE void keep_surfaces(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) keep_surface(paths, i + j, load_surface(surfaces, j));
}
STAGE void load_kept_surfaces(const PRIVATE PathState* paths, int i, PRIVATE Surfaces* RESTRICT surfaces) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) store_surface_hit(surfaces, j, kept_surface(paths, i + j));
}

/// Before a step requests rays: there are none yet. A path continues if a surface was hit and a step is left.
STAGE void begin_steps(const PRIVATE PathState* paths, int i, const PRIVATE Surfaces* RESTRICT surfaces,
                       bool is_last) {
  LANE_LOOP
    for (int j = 0; j < LANES; j++) {
      set_ray_tmax(paths, i + j, -1.0f);
      set_shadow_tmax(paths, i + j, -1.0f);
      set_alive(paths, i + j, (surfaces->primitive[j] >= 0) & !is_last);
    }
}

PENUMBRA_NAMESPACE_END
#endif
