// Translates the objects of Nori and its forks to the equivalent Mitsuba objects.
#pragma once

#include <optional>

#include "scenes/nori/object_edit.h"

namespace penumbra::nori {

/// Translates checkerboards, images and constants, whatever they are called.
void translate_texture(const Translation& t, mitsuba::Object& texture);
/// The parameter that names an image file, recognised by its own name or by the file's extension; null if
/// there is none.
mitsuba::Parameter* image_name(mitsuba::Object& object);
/// Converts nested constant textures to parameters, and strings that name image files to textures.
void settle_textures(const Translation& t, mitsuba::Object& object);

/// Translates a BSDF and wraps it in its normal or bump map, if it has one.
void translate_bsdf(const Translation& t, mitsuba::Object& bsdf);
/// Wraps a shape's BSDF in the normal or bump map that the shape holds.
void bend_bsdf_of(const Translation& t, mitsuba::Object& shape);

/// Turns a parallelogram, a corner and two sides, into a rectangle.
void translate_parallelogram(const Translation& t, mitsuba::Object& shape);

/// Translates an emitter of the scene, or of `shape` if that is given.
void translate_emitter(const Translation& t, mitsuba::Object& emitter, const mitsuba::Object* shape);
/// Whether the emitter illuminates the scene from all directions.
bool is_environment(const mitsuba::Object& emitter);

void translate_camera(const Translation& t, mitsuba::Object& camera);
void translate_sampler(const Translation& t, mitsuba::Object& sampler);
void translate_filter(const Translation& t, mitsuba::Object& filter);

void translate_integrator(const Translation& t, mitsuba::Object& integrator);
/// Handles integrators that define a light and materials of their own (`simple`, `material`): adds these to
/// the scene.
void apply_integrator(const Translation& t, mitsuba::Object& scene);

void translate_medium(const Translation& t, mitsuba::Object& medium);
void translate_phase(const Translation& t, mitsuba::Object& phase);
/// Places the media that the scene holds: around the camera, or inside an index-matched shape of their own.
void place_media(const Translation& t, mitsuba::Object& scene);

}  // namespace penumbra::nori
