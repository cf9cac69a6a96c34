// The records of every table of a device scene, while it is built.
#pragma once

#include <vector>

#include "kernels/host/device_scene.h"

namespace penumbra {

struct SceneRecords {
#define TABLE_RECORDS(_, name, record, least, what) std::vector<record> name;
  SCENE_TABLES(TABLE_RECORDS, _)
#undef TABLE_RECORDS
};

/// Appends all tables to the scene's words. Each begins at a cache line; where kernels read more records than
/// there are, zeros follow them. A table of the records is gone once the scene has it.
void store(SceneRecords&& records, DeviceScene& scene);

}  // namespace penumbra
