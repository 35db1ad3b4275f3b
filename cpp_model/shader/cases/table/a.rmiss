#version 460
#extension GL_GOOGLE_include_directive : require
#extension GL_EXT_ray_tracing : require
#include "common.glsl"

layout(shaderRecordEXT, std430) buffer Record { uint right; } record;
layout(location = 0) rayPayloadInEXT Payload payload;

void main() { payload.right = record.right; }
