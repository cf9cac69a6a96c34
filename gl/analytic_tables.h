// The tables of a device scene for the analytic pass, as texture buffers.
#pragma once

#include "gl/gl_objects.h"
#include "kernels/host/device_scene.h"

namespace penumbra {

/// Packed as gl/shaders/analytic_tables.glsl and analytic_shade.frag read them. Lengths are divided by
/// `unit`, a power of two about the scene's size. This loses no digits and lets single precision handle
/// scenes of any size.
struct AnalyticTables {
  BufferTexture triangles, quadrics, vertex_normals, materials, lights, polygons, polygon_corners;
  BufferTexture control_lobes;  ///< of the materials, with FEATURE_LTC
  float unit = 1;
};

/// The context must be current. Errors: a table is too large.
Expected<AnalyticTables> make_analytic_tables(const DeviceScene& scene);

}  // namespace penumbra
