// As tutorials have them: buffers by their addresses, in a buffer that the instance's number is an index of.
#extension GL_EXT_buffer_reference2 : require
#extension GL_EXT_shader_explicit_arithmetic_types_int64 : require

struct Vertex {
  vec3 position;
  vec3 normal;
  vec2 texcoord;
};
struct Material {
  vec3 ambient;
  vec3 diffuse;
  float roughness;
  int texture_number;
};
struct Object {
  int first_texture;
  uint64_t vertices;
  uint64_t indices;
  uint64_t materials;
  uint64_t material_numbers;
};
struct Payload {
  uint right;  // a bit for each thing that is as it should be
  uint count;
};
struct Light {
  vec3 position;
  float distance;
  int kind;
};
