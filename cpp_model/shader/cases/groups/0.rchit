#version 460
#extension GL_EXT_ray_tracing : require

layout(location = 0) rayPayloadInEXT vec4 first;
hitAttributeEXT vec2 attributes;

void main() { first = vec4(attributes, 0.25 + 0.5 * 0.0, float(gl_PrimitiveID + 0)); }
