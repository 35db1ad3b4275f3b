#version 460
#extension GL_EXT_ray_tracing : require

layout(location = 3) rayPayloadInEXT int second;

void main() { second = 7; }
