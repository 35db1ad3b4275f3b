#version 460
#extension GL_EXT_ray_tracing : require

layout(location = 0) rayPayloadInEXT vec3 seen;
hitAttributeEXT vec2 attributes;

void main() { seen = vec3(1.0 - attributes.x - attributes.y, attributes.x, attributes.y); }
