// The camera of kernels/camera/camera.h. Positions are relative to the camera, so that differences of
// positions that are close to each other but far from the scene's centre are exact. Lengths are in the
// tables' unit. Directions are not normalised: their component along the viewing direction is 1, so that the
// point z d has depth z.
uniform vec3 camera_origin;  // relative to the scene's centre
uniform vec3 camera_x;  // to the left edge of the film, at depth 1
uniform vec3 camera_y;  // to the top edge
uniform vec3 camera_z;
uniform float near_clip;  // above 0
uniform float far_clip;
uniform ivec2 size;    // of the film, in pixels
uniform vec2 offset;  // from the pixels' centres, in pixels

// The direction through a pixel; row 0 is the film's top.
vec3 pixel_direction(ivec2 pixel) {
  vec2 from_centre = vec2(2 * pixel + 1 - size) + 2.0 * offset;
  return camera_z - camera_x * (from_centre.x / float(size.x)) - camera_y * (from_centre.y / float(size.y));
}

uniform mat3 to_film;  // maps to (z times x to the right, z times y downwards, z); the film is [-1, 1]
// The fraction of the viewport that the film covers. Large triangles that are clipped at the viewport's
// border have edges that are off by some pixels there.
uniform vec2 inside;

// Clip coordinates. The rasteriser uses them for coverage beyond the near plane; depth_value decides
// visibility.
vec4 project(vec3 position) {
  vec3 p = to_film * position;
  vec2 shift = 2.0 * offset / vec2(size) * p.z;
  return vec4(inside * (p.xy - shift), p.z - 2.0 * near_clip, p.z);
}

// The value in the depth buffer, largest in front: it has the same relative precision at every depth.
float depth_value(float inverse_depth) { return clamp(near_clip * inverse_depth, 0.0, 1.0); }
