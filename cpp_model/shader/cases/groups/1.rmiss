#version 460
#extension GL_EXT_ray_tracing : require

layout(location = 0) rayPayloadInEXT vec4 first;

void main() { first = first.wxyz * vec4(0.5, 1.0, 1.5, 1.0); }
