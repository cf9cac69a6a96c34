// [input] of a TinyRender scene: the OBJ file with its materials, as shapes.
#pragma once

#include "scenes/file_access.h"
#include "scenes/tinyrender/section.h"

namespace penumbra::tinyrender {

/// Reads the OBJ file that `objfile` names and its MTL files, each looked for beside the file that names it.
/// The faces of one object and one material become a shape:
///  - Kd is a diffuse surface, Kd with Ks and Ns a Phong one, on both sides; `illum 7` is diffuse whatever Ks
///    says, and `illum 5` a mirror that reflects Ks, or all without it; where Kd and Ks together reflect more
///    than all light in a channel they are scaled to 0.99 of it, as TinyRender does, with a warning;
///  - map_Kd, map_Ks and map_Ns are images that multiply these;
///  - Ke makes it a light that shines from its front; without Kd and Ks it reflects nothing. The front is
///  where
///    vertex normals point to, or without them where the corners run counterclockwise;
///  - vertex normals that are those of the faces leave it faceted; others are interpolated.
/// A face that is not flat is cut into flat triangles, triangles without area are left out, and a face that
/// crosses itself is cut as a fan, each with a warning that counts them. A light with a face that crosses
/// itself is an error: what it sends out is not defined.
void read_model(const Context& context, const FileAccess& files, SceneDescription& scene);

}  // namespace penumbra::tinyrender
