// From each kind of object of Nori's, and of the courses' forks, to Mitsuba's that means the same.
#pragma once

#include <optional>

#include "scenes/nori/object_edit.h"

namespace penumbra::nori {

/// Checkerboards, images and constants, by whatever name.
void translate_texture(const Translation& t, mitsuba::Object& texture);
/// The parameter that names an image file, by its own name or by the file's; null where there is none.
mitsuba::Parameter* image_name(mitsuba::Object& object);
/// What the object holds as textures that are constant becomes parameters; strings that name image files
/// become textures.
void settle_textures(const Translation& t, mitsuba::Object& object);

/// With its normal or bump map around it, if it has one.
void translate_bsdf(const Translation& t, mitsuba::Object& bsdf);
/// The same for a map that the shape holds, about its BSDF.
void bend_bsdf_of(const Translation& t, mitsuba::Object& shape);

/// A light of the scene, or with `shape` of that.
void translate_emitter(const Translation& t, mitsuba::Object& emitter, const mitsuba::Object* shape);
/// Whether it lights the scene from all directions.
bool is_environment(const mitsuba::Object& emitter);

void translate_camera(const Translation& t, mitsuba::Object& camera);
void translate_sampler(const Translation& t, mitsuba::Object& sampler);
void translate_filter(const Translation& t, mitsuba::Object& filter);

void translate_integrator(const Translation& t, mitsuba::Object& integrator);
/// What integrators make of the scene that have a light and materials of their own (`simple`, `material`).
void apply_integrator(const Translation& t, mitsuba::Object& scene);

void translate_medium(const Translation& t, mitsuba::Object& medium);
void translate_phase(const Translation& t, mitsuba::Object& phase);
/// Media that the scene holds: about the camera, or inside a shape of their own that light passes through.
void place_media(const Translation& t, mitsuba::Object& scene);

}  // namespace penumbra::nori
