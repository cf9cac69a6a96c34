// Reads [input] of a TinyRender scene: the OBJ file and its materials, as shapes.
#pragma once

#include "scenes/file_access.h"
#include "scenes/tinyrender/section.h"

namespace penumbra::tinyrender {

/// Reads the OBJ file that `objfile` names and its MTL files. Each is searched in the folder of the file that
/// names it. The faces of one object and one material become a shape:
///   - Kd gives a diffuse surface, Kd with Ks and Ns a Phong surface, on both sides. With `illum 7` it is
///     diffuse whatever Ks says. With `illum 5` it is a mirror of reflectance Ks, or 1 without Ks. If Kd + Ks
///     exceeds 1 in a channel, both are scaled so that the sum is 0.99, as in TinyRender, with a warning.
///   - map_Kd, map_Ks and map_Ns are images that multiply these values.
///   - Ke makes the shape an area light that emits from its front. Without Kd and Ks it reflects nothing. The
///     front is the side to which vertex normals point, or without normals the side from which the corners
///     run counter-clockwise.
///   - Vertex normals that equal the face normals leave the mesh faceted. Others are interpolated.
/// A face that is not planar is cut into triangles, triangles without area are left out, and a face that
/// crosses itself is cut as a fan, each with a warning that counts them. It is an error if a face of a light
/// crosses itself, because its emission is not well defined.
void read_model(const Context& context, const FileAccess& files, SceneDescription& scene);

}  // namespace penumbra::tinyrender
