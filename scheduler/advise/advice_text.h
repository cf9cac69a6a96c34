// Shows advice.
#pragma once

#include <nlohmann/json_fwd.hpp>
#include <string>

#include "scheduler/advise/advice.h"

namespace penumbra {

/// A line: "auto: ppm, caustics only; path would take 14 times the work".
std::string choice_line(const Advice& advice);
/// A row for each candidate.
std::string advice_table(const Advice& advice);
/// "--integrator ppm --set integrator.caustics_only=true"; empty for the scene's own settings.
std::string choice_options(const Technique& choice);
/// With the members candidates, chosen, options.
nlohmann::ordered_json advice_json(const Advice& advice);

}  // namespace penumbra
