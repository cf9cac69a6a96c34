#version 330 core
// Rectangles in pixels of the target; y grows downwards.

layout(location = 0) in vec2 position;
layout(location = 1) in vec3 colour;
uniform vec2 target_size;

flat out vec3 vertex_colour;

void main() {
  vec2 unit = position / target_size;
  gl_Position = vec4(2.0 * unit.x - 1.0, 1.0 - 2.0 * unit.y, 0.0, 1.0);
  vertex_colour = colour;
}
