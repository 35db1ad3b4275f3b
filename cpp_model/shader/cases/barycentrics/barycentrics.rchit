#version 460
#extension GL_EXT_ray_tracing : require

layout(set = 0, binding = 1, rgba32f) uniform writeonly image2D image;
hitAttributeEXT vec2 attributes;

void main() {
  const vec3 corners = vec3(1.0 - attributes.x - attributes.y, attributes);
  imageStore(image, ivec2(gl_LaunchIDEXT.xy), vec4(corners, 0.0));
}
