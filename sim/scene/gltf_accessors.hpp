// The numbers of a glTF document's accessors, checked: of views or without one, sparse, floats or quantised.
#pragma once

#include <cstddef>
#include <cstdint>
#include <string>
#include <vector>

#include "scene/gltf_file.hpp"

namespace raypool {

inline constexpr uint64_t kLargestCount = uint64_t{1} << 31;  ///< of elements, and of what an index names
/// Types of components, as glTF numbers them.
inline constexpr int kByte = 5120, kUnsignedByte = 5121, kShort = 5122, kUnsignedShort = 5123, kUnsignedInt = 5125,
                     kFloat = 5126;

/// What an accessor must be to be used for something.
struct GltfForm {
  size_t components;
  std::vector<int> types;  ///< of a component, as glTF numbers them
  const char* rule;        ///< ends the sentence about one that is something else
};

/// Quantised positions and joints' weights are allowed whether or not the file names KHR_mesh_quantization.
extern const GltfForm kGltfPositions, kGltfIndices, kGltfJoints, kGltfWeights, kGltfMatrices, kGltfRotations,
    kGltfNormals, kGltfTexcoords, kGltfColors, kGltfOpaqueColors;

class GltfAccessors {
 public:
  /// Loads buffers of the file as they are needed.
  explicit GltfAccessors(GltfFile& file) : file_(file) {}

  /// The components of all elements, one after the other; of normalized integers what they stand for. These throw
  /// InputError naming the place in the document.
  std::vector<float> floats(const JsonPlace& accessor, const GltfForm& form);
  std::vector<uint32_t> whole_numbers(const JsonPlace& accessor, const GltfForm& form);

 private:
  /// As they are in the file, without gaps.
  struct Elements {
    int component = 0;
    bool normalized = false;
    std::string bytes;
  };
  Elements elements(const JsonPlace& accessor, const GltfForm& form);
  std::string view_bytes(const JsonPlace& owner, uint64_t count, uint64_t size, bool may_have_gaps);
  void replace(const JsonPlace& sparse, uint64_t count, uint64_t size, std::string& bytes);

  GltfFile& file_;
};

}  // namespace raypool
