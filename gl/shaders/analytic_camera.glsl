// The camera of kernels/camera/camera.h. Positions are relative to it: differences of positions that are close to each
// other but far from the scene's centre are exact. Lengths are in the tables' unit. Directions are not
// normalised: their component along the viewing direction is 1, so the point z d is at depth z.
uniform vec3 camera_origin;  // relative to the scene's centre
uniform vec3 camera_x;  // to the left edge of the film, at depth 1
uniform vec3 camera_y;  // to the top edge
uniform vec3 camera_z;
uniform float near_clip;  // above 0
uniform float far_clip;
uniform ivec2 size;    // of the film, in pixels
uniform vec2 offset;  // from the pixels' centres, in pixels

// Through a pixel; row 0 is the film's top.
vec3 pixel_direction(ivec2 pixel) {
  vec2 from_centre = vec2(2 * pixel + 1 - size) + 2.0 * offset;
  return camera_z - camera_x * (from_centre.x / float(size.x)) - camera_y * (from_centre.y / float(size.y));
}

uniform mat3 to_film;  // to (z times x to the right, z times y downwards, z) on a film of -1 ... 1
// The part of the viewport that the film is. Where large triangles are clipped at the viewport's border, their
// edges are off by some pixels.
uniform vec2 inside;

// Clip coordinates, of which the rasteriser takes what is covered and is beyond the near plane; what is in front
// is decided by depth_value.
vec4 project(vec3 position) {
  vec3 p = to_film * position;
  vec2 shift = 2.0 * offset / vec2(size) * p.z;
  return vec4(inside * (p.xy - shift), p.z - 2.0 * near_clip, p.z);
}

// What the depth buffer holds, the greatest in front: of equal relative precision at every depth.
float depth_value(float inverse_depth) { return clamp(near_clip * inverse_depth, 0.0, 1.0); }
