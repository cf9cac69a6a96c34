// Shows the estimates of `penumbra render --estimate`.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scheduler/estimate/render_estimate.h"

namespace penumbra {

/// How many cores of workers fill a link of 1 Gbit/s to the scheduler with their results.
double cores_of_a_gigabit(const RenderEstimate& estimate);

std::string estimate_text(const RenderEstimate& estimate);
/// With the members plan, measured and estimate.
nlohmann::ordered_json estimate_json(const RenderEstimate& estimate);

/// A line with a figure's name.
std::string estimate_line(const char* name, const std::string& text);
/// "480 x 270 pixels", "20% of 480 x 270 pixels"
std::string measured_image_text(const MeasuredWork& measured);
/// "7200 core-seconds, 2.00 core-hours"
std::string core_time_text(double core_seconds);

}  // namespace penumbra
