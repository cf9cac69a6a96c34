// The panel's list of workers.
#pragma once

#include "gl/view_model.h"

namespace penumbra {

void draw_workers(DisplaySettings& settings, const ViewStatus& status);

}  // namespace penumbra
