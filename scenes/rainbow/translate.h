// Translates the plugins of Rainbow to the equivalent ones of Mitsuba.
#pragma once

#include "scenes/mitsuba/object_tree.h"
#include "scenes/reader_report.h"

namespace penumbra::rainbow {

void translate(mitsuba::ObjectTree& tree, ReaderReport& report);

}  // namespace penumbra::rainbow
