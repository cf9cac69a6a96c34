// The functions of this folder that add cases, one file per topic. A new case is one entry in one of them.
#pragma once

#include "scheduler/stress/case.h"

namespace penumbra::stress {

void add_polygon_cases(std::vector<Case>& cases);
void add_lobe_cases(std::vector<Case>& cases);
void add_solid_angle_cases(std::vector<Case>& cases);
void add_projected_cases(std::vector<Case>& cases);
void add_bsdf_cases(std::vector<Case>& cases);
void add_mixture_cases(std::vector<Case>& cases);
void add_sampler_cases(std::vector<Case>& cases);
void add_intersection_cases(std::vector<Case>& cases);
void add_small_function_cases(std::vector<Case>& cases);
void add_render_light_cases(std::vector<Case>& cases);
void add_sky_and_beam_cases(std::vector<Case>& cases);
void add_render_cases(std::vector<Case>& cases);
void add_merge_cases(std::vector<Case>& cases);
void add_medium_cases(std::vector<Case>& cases);
void add_render_medium_cases(std::vector<Case>& cases);
void add_render_photon_cases(std::vector<Case>& cases);

}  // namespace penumbra::stress
