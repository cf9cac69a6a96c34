#version 330 core

flat in vec3 vertex_colour;
out vec4 colour;

void main() { colour = vec4(vertex_colour, 1.0); }
