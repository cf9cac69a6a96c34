// The tables of a device scene that the analytic pass needs, as texture buffers.
#pragma once

#include "gl/gl_objects.h"
#include "kernels/host/device_scene.h"

namespace penumbra {

/// Packed as gl/shaders/analytic_tables.glsl and analytic_shade.frag read them. Lengths are divided by
/// `unit`, a power of two about the scene's size, which changes no digit and lets single precision reach
/// scenes of any size.
struct AnalyticTables {
  BufferTexture triangles, quadrics, vertex_normals, materials, lights, polygons, polygon_corners;
  BufferTexture control_lobes;  ///< of the materials, FEATURE_LTC
  float unit = 1;
};

/// The context current; an error says which table does not fit.
Expected<AnalyticTables> make_analytic_tables(const DeviceScene& scene);

}  // namespace penumbra
