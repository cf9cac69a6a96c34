#include "scheduler/stress/cases/cases.h"

namespace penumbra::stress {

std::vector<Case> all_cases() {
  std::vector<Case> cases;
  for (const auto add :
       {add_polygon_cases, add_lobe_cases, add_solid_angle_cases, add_projected_cases, add_bsdf_cases,
        add_mixture_cases, add_sampler_cases, add_intersection_cases, add_small_function_cases,
        add_medium_cases, add_render_medium_cases, add_render_photon_cases, add_render_light_cases,
        add_sky_and_beam_cases, add_render_cases, add_merge_cases})
    add(cases);
  return cases;
}

}  // namespace penumbra::stress
