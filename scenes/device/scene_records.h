// The records of all tables of a device scene under construction.
#pragma once

#include <vector>

#include "kernels/host/device_scene.h"

namespace penumbra {

struct SceneRecords {
#define TABLE_RECORDS(_, name, record, least, what) std::vector<record> name;
  SCENE_TABLES(TABLE_RECORDS, _)
#undef TABLE_RECORDS
};

/// Appends all tables to the scene's words. Each table begins at a cache line and is padded with zeros if
/// kernels read more records than it has. Each table is freed once it is stored.
void store(SceneRecords&& records, DeviceScene& scene);

}  // namespace penumbra
