#include "scene/gltf_geometry.hpp"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <cmath>

#include "scene/gltf_surface.hpp"

namespace raypool {
namespace {

using Json = JsonPlace::Json;

constexpr uint64_t kMostTriangles = 100'000'000;
constexpr int kDeepest = 1000;
constexpr double kFar = kLargestCoordinate;

/// Of numbers, as they stand.
Json numbers(const JsonPlace& place, size_t count) {
  if (place.size() != count) place.fail(fmt::format("has {} numbers; give {}", place.size(), count));
  Json result = Json::array();
  for (size_t i = 0; i < count; ++i) result.push_back(place.at(i).number(-kFar, kFar));
  return result;
}

/// The members of a node that place it.
Json transform_json(const JsonPlace& place) {
  Json json = Json::object();
  if (const std::optional<JsonPlace> matrix = place.find("matrix")) {
    json["matrix"] = numbers(*matrix, 16);
    for (const size_t i : {3, 7, 11, 15}) {
      if (json["matrix"][i] != (i == 15 ? 1 : 0)) matrix->fail("must end each column in 0, the last one in 1");
    }
    return json;
  }
  for (const char* key : {"translation", "scale"}) {
    if (const std::optional<JsonPlace> vector = place.find(key)) json[key] = numbers(*vector, 3);
  }
  if (const std::optional<JsonPlace> rotation = place.find("rotation")) {
    Json q = numbers(*rotation, 4);
    double square = 0;
    for (const Json& part : q) square += part.get<double>() * part.get<double>();
    if (!(square > 0)) rotation->fail("is zero; it must be a unit quaternion, x, y, z, w");
    for (Json& part : q) part = part.get<double>() / std::sqrt(square);
    json["rotation"] = q;
  }
  return json;
}

Transform to_transform(const Vec3d& move, const std::array<double, 4>& q, const Vec3d& scale) {
  const double x = q[0], y = q[1], z = q[2], w = q[3];
  return {Vec3d{1 - 2 * (y * y + z * z), 2 * (x * y + z * w), 2 * (x * z - y * w)} * scale.x,
          Vec3d{2 * (x * y - z * w), 1 - 2 * (x * x + z * z), 2 * (y * z + x * w)} * scale.y,
          Vec3d{2 * (x * z + y * w), 2 * (y * z - x * w), 1 - 2 * (x * x + y * y)} * scale.z, move};
}

/// Sixteen numbers, column by column.
template <typename Numbers>
Transform of_matrix(const Numbers& m, size_t first) {
  const auto column = [&](size_t i) {
    return Vec3d{static_cast<double>(m[first + i]), static_cast<double>(m[first + i + 1]),
                 static_cast<double>(m[first + i + 2])};
  };
  return {column(0), column(4), column(8), column(12)};
}

Transform to_transform(const Json& json) {
  const auto list = [&](const char* key, std::vector<double> otherwise) {
    return json.contains(key) ? json[key].get<std::vector<double>>() : std::move(otherwise);
  };
  if (json.contains("matrix")) return of_matrix(list("matrix", {}), 0);
  const std::vector<double> t = list("translation", {0, 0, 0}), s = list("scale", {1, 1, 1}),
                            r = list("rotation", {0, 0, 0, 1});
  return to_transform({t[0], t[1], t[2]}, {r[0], r[1], r[2], r[3]}, {s[0], s[1], s[2]});
}

std::optional<JsonPlace> extension(const JsonPlace& place, const char* name) {
  const std::optional<JsonPlace> extensions = place.find("extensions");
  return extensions ? extensions->find(name) : std::nullopt;
}

bool is_hidden(const JsonPlace& node) {
  const std::optional<JsonPlace> visibility = extension(node, "KHR_node_visibility");
  const std::optional<JsonPlace> visible = visibility ? visibility->find("visible") : std::nullopt;
  return visible && !visible->flag();
}

}  // namespace

GltfGeometry::Written GltfGeometry::write(const void* elements, size_t count, const char* type, int component,
                                          size_t bytes) {
  json_buffers_.push_back({{"uri", std::to_string(document_.buffers.size())}, {"byteLength", bytes}});
  document_.buffers.emplace_back(static_cast<const char*>(elements), bytes);
  json_views_.push_back({{"buffer", json_buffers_.size() - 1}, {"byteOffset", 0}, {"byteLength", bytes}});
  json_accessors_.push_back(
      {{"bufferView", json_views_.size() - 1}, {"componentType", component}, {"count", count}, {"type", type}});
  return {json_accessors_.size() - 1, count};
}

/// Adds the targets, each by its weight.
void GltfGeometry::morph(const JsonPlace& place, const Pose& pose, const char* attribute,
                         std::vector<float>& positions) {
  const std::optional<JsonPlace> targets = place.find("targets");
  if (!targets || pose.weights.empty()) return;
  std::vector<double> sum(positions.begin(), positions.end());
  for (size_t i = 0; i < std::min(targets->size(), pose.weights.size()); ++i) {
    const std::optional<JsonPlace> target = targets->at(i).find(attribute);
    if (!target || pose.weights[i] == 0) continue;
    const std::vector<float> moves = accessors_.floats(target->in(root_, "accessors"), kGltfPositions);
    if (moves.size() != positions.size()) {
      target->fail(fmt::format("has {} elements for {} vertices; export the file again", moves.size() / 3,
                               positions.size() / 3));
    }
    for (size_t k = 0; k < sum.size(); ++k) sum[k] += pose.weights[i] * static_cast<double>(moves[k]);
  }
  for (size_t k = 0; k < sum.size(); ++k) positions[k] = static_cast<float>(sum[k]);
}

/// Puts each vertex where its joints have it, the mean of them by weight.
void GltfGeometry::bend(const JsonPlace& place, const std::vector<Transform>& joints, std::vector<float>& positions) {
  const JsonPlace attributes = place.at("attributes");
  const size_t count = positions.size() / 3;
  std::vector<Vec3d> sum(count), first(count);
  std::vector<double> total(count);
  for (size_t set = 0;; ++set) {
    const std::optional<JsonPlace> numbers = attributes.find(fmt::format("JOINTS_{}", set).c_str());
    if (!numbers) break;
    const JsonPlace shares = attributes.at(fmt::format("WEIGHTS_{}", set).c_str());
    const std::vector<uint32_t> joint = accessors_.whole_numbers(numbers->in(root_, "accessors"), kGltfJoints);
    const std::vector<float> weight = accessors_.floats(shares.in(root_, "accessors"), kGltfWeights);
    if (joint.size() != 4 * count || weight.size() != 4 * count) {
      numbers->fail(fmt::format("has {} elements, and its weights {}, for {} vertices; export the file again",
                                joint.size() / 4, weight.size() / 4, count));
    }
    for (size_t i = 0; i < joint.size(); ++i) {
      if (joint[i] >= joints.size()) {
        numbers->fail(fmt::format("has joint {}, which is out of range: the skin has {}; export the file again",
                                  joint[i], joints.size()));
      }
      const float* const p = &positions[i / 4 * 3];
      const Vec3d there = joints[joint[i]]({p[0], p[1], p[2]});
      if (i % 4 == 0 && set == 0) first[i / 4] = there;
      sum[i / 4] = sum[i / 4] + there * static_cast<double>(weight[i]);
      total[i / 4] += static_cast<double>(weight[i]);
    }
  }
  for (size_t i = 0; i < count; ++i) {
    const Vec3 p = (total[i] > 0 ? sum[i] * (1 / total[i]) : first[i]).as<float>();
    for (int axis = 0; axis < 3; ++axis) positions[3 * i + static_cast<size_t>(axis)] = p[axis];
  }
}

std::vector<float> GltfGeometry::surface_values(const JsonPlace& attribute, const GltfForm& form, size_t count) {
  std::vector<float> values = accessors_.floats(attribute.in(root_, "accessors"), form);
  if (values.size() != form.components * count) {
    attribute.fail(
        fmt::format("has {} elements for {} vertices; export the file again", values.size() / form.components, count));
  }
  return values;
}

GltfGeometry::Written GltfGeometry::surface_vertices(const JsonPlace& place, const Pose& pose, size_t count) {
  const JsonPlace attributes = place.at("attributes");
  const std::optional<JsonPlace> number = place.find("material");
  const GltfTexcoords texcoords = number ? gltf_texcoords(number->in(root_, "materials")) : GltfTexcoords();
  const std::string set = fmt::format("TEXCOORD_{}", texcoords.set);
  const std::optional<JsonPlace> normal = attributes.find("NORMAL"), texcoord = attributes.find(set.c_str()),
                                 color = attributes.find("COLOR_0");
  // Targets and joints are of the primitive.
  std::string key = pose.weights.empty() && pose.joints == nullptr ? "" : place.where() + pose.name;
  for (const std::optional<JsonPlace>& attribute : {attributes.find("POSITION"), normal, texcoord, color})
    key += attribute ? " " + attribute->in(root_, "accessors").where() : " -";
  key += fmt::format(" {} {} {} {} {}", texcoords.offset[0], texcoords.offset[1], texcoords.scale[0],
                     texcoords.scale[1], texcoords.rotation);
  const auto known = vertices_.find(key);
  if (known != vertices_.end()) return known->second;

  Surfaces& all = document_.surfaces;
  const size_t first = all.normals.size();
  if (first + count > kLargestCount)
    place.fail(fmt::format("brings the scene to more than {} vertices", kLargestCount));
  std::vector<float> normals(3 * count), uv(2 * count), rgba(4 * count, 1);
  if (normal) {
    normals = surface_values(*normal, kGltfNormals, count);
    morph(place, pose, "NORMAL", normals);
    if (pose.joints != nullptr) {
      std::vector<Transform> joints;
      for (const Transform& joint : *pose.joints) joints.push_back(joint.of_normals());
      bend(place, joints, normals);
    }
  }
  if (texcoord) uv = surface_values(*texcoord, kGltfTexcoords, count);
  if (color) {
    const bool opaque = color->in(root_, "accessors").at("type").text() == "VEC3";
    const std::vector<float> values = surface_values(*color, opaque ? kGltfOpaqueColors : kGltfColors, count);
    const size_t channels = opaque ? 3 : 4;
    for (size_t i = 0; i < values.size(); ++i) rgba[i / channels * 4 + i % channels] = values[i];
  }
  const auto check = [](const std::optional<JsonPlace>& attribute, const std::vector<float>& values, const char* what) {
    if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }))
      attribute->fail(fmt::format("has a {} that is infinite or no number; correct the mesh", what));
  };
  check(texcoord, uv, "texture coordinate");
  check(color, rgba, "colour");
  std::vector<float> numbers;
  for (size_t i = 0; i < count; ++i) {
    all.normals.push_back({normals[3 * i], normals[3 * i + 1], normals[3 * i + 2]});
    all.texcoords.push_back(texcoords({uv[2 * i], uv[2 * i + 1]}));
    Rgba mixed{};
    for (size_t k = 0; k < 4; ++k) mixed[k] = std::max(rgba[4 * i + k], 0.0f);
    all.colors.push_back(mixed);
    numbers.push_back(static_cast<float>((first + i) & 0xffff));
    numbers.push_back(static_cast<float>((first + i) >> 16));
  }
  const Written result = write(numbers.data(), count, "VEC2", kFloat, numbers.size() * sizeof(float));
  return vertices_.emplace(key, result).first->second;
}

GltfGeometry::Written GltfGeometry::positions(const JsonPlace& place, const Pose& pose) {
  const JsonPlace attributes = place.at("attributes"), position = attributes.at("POSITION");
  const JsonPlace accessor = position.in(root_, "accessors");
  const bool as_they_are = pose.joints == nullptr && (pose.weights.empty() || !place.find("targets"));
  const auto known = written_.find(accessor.where());
  if (as_they_are && known != written_.end()) return known->second;
  std::vector<float> values = accessors_.floats(accessor, kGltfPositions);
  morph(place, pose, "POSITION", values);
  if (pose.joints != nullptr) bend(place, *pose.joints, values);
  const auto far = std::find_if(values.begin(), values.end(), [](float value) { return !std::isfinite(value); });
  if (far != values.end()) {
    const auto i = static_cast<size_t>(far - values.begin()) / 3;
    position.fail(fmt::format("has vertex {} at ({}, {}, {}); coordinates must be finite: correct the mesh", i,
                              values[3 * i], values[3 * i + 1], values[3 * i + 2]));
  }
  const Written result = write(values.data(), values.size() / 3, "VEC3", kFloat, values.size() * sizeof(float));
  if (as_they_are) written_.emplace(accessor.where(), result);
  return result;
}

Json GltfGeometry::primitive(const JsonPlace& place, const Pose& pose, uint64_t& triangles) {
  constexpr uint64_t kTriangles = 4, kFan = 6;  // between them: strips
  const std::optional<JsonPlace> given_mode = place.find("mode"), material = place.find("material"),
                                 given_indices = place.find("indices");
  const JsonPlace attributes = place.at("attributes");
  if (pose.skinned && attributes.find("JOINTS_0").has_value() != *pose.skinned) return nullptr;
  const bool first_time = counted_.insert(place.where()).second;
  const uint64_t mode = given_mode ? given_mode->whole(0, kFan) : kTriangles;
  if (mode < kTriangles) {
    losses_.lines += first_time;
    return nullptr;
  }
  const Written vertices = positions(place, pose);
  Json json = {{"attributes", {{"POSITION", vertices.accessor}}}, {"mode", mode}};
  if (surfaces_) json["attributes"]["TEXCOORD_0"] = surface_vertices(place, pose, vertices.count).accessor;
  size_t corners = vertices.count;
  if (given_indices) {
    const auto [list, largest] = indices(given_indices->in(root_, "accessors"));
    if (largest >= vertices.count) {
      given_indices->fail(fmt::format("has index {}, which is out of range: there are {} vertices; correct the mesh",
                                      largest, vertices.count));
    }
    corners = list.count;
    json["indices"] = list.accessor;
  }
  if (corners < 3 || (mode == kTriangles && corners % 3 != 0)) {
    place.fail(fmt::format("has {} corners, which make no triangles; {}", corners,
                           mode == kTriangles ? "give a multiple of three" : "give at least three"));
  }
  triangles += mode == kTriangles ? corners / 3 : corners - 2;
  if (material) {
    material->in(root_, "materials");
    const size_t index = material->whole(0, kLargestCount);
    json["material"] = index;
    used_.resize(std::max(used_.size(), index + 1));
    used_[index] = true;
  }
  if (surfaces_) return json;
  losses_.vertex_colours += first_time && attributes.find("COLOR_0");
  losses_.vertex_normals += first_time && attributes.find("NORMAL");
  return json;
}

std::pair<GltfGeometry::Written, uint32_t> GltfGeometry::indices(const JsonPlace& accessor) {
  const auto known = indices_.find(accessor.where());
  if (known != indices_.end()) return known->second;
  const std::vector<uint32_t> values = accessors_.whole_numbers(accessor, kGltfIndices);
  const Written list = write(values.data(), values.size(), "SCALAR", kUnsignedInt, values.size() * sizeof(uint32_t));
  return indices_.emplace(accessor.where(), std::make_pair(list, *std::max_element(values.begin(), values.end())))
      .first->second;
}

GltfGeometry::TriangleMesh GltfGeometry::mesh(const JsonPlace& place, const Pose& pose) {
  const std::string key = place.where() + pose.name;
  const auto known = meshes_.find(key);
  if (known != meshes_.end()) return known->second;
  TriangleMesh result;
  const JsonPlace list = place.at("primitives");
  Json primitives = Json::array();
  for (size_t i = 0; i < list.size(); ++i) {
    Json json = primitive(list.at(i), pose, result.triangles);
    if (!json.is_null()) primitives.push_back(std::move(json));
  }
  if (!primitives.empty()) {
    result.index = json_meshes_.size();
    json_meshes_.push_back({{"primitives", std::move(primitives)}});
  }
  meshes_.emplace(key, result);
  return result;
}

Transform GltfGeometry::place_of(size_t node) {
  const JsonPlace nodes = root_.at("nodes");
  if (!parents_) {
    parents_.emplace(nodes.size());
    for (size_t i = 0; i < nodes.size(); ++i) {
      const std::optional<JsonPlace> children = nodes.at(i).find("children");
      for (size_t k = 0; children && k < children->size(); ++k)
        (*parents_)[children->at(k).whole(0, nodes.size() - 1)] = i;
    }
  }
  Transform result = to_transform(transform_json(nodes.at(node)));
  int depth = 0;
  for (std::optional<size_t> above = (*parents_)[node]; above; above = (*parents_)[*above]) {
    if (++depth > kDeepest)
      nodes.at(node).fail(fmt::format("has more than {} nodes above it, or is its own ancestor", kDeepest));
    result = to_transform(transform_json(nodes.at(*above))) * result;
  }
  return result;
}

/// [joint] From where its vertices are in the mesh to where they are in the scene.
const std::vector<Transform>& GltfGeometry::joints_of(const JsonPlace& skin) {
  const auto known = skins_.find(skin.where());
  if (known != skins_.end()) return known->second;
  const JsonPlace list = skin.at("joints");
  const std::optional<JsonPlace> inverse = skin.find("inverseBindMatrices");
  std::vector<float> matrices;
  if (inverse) {
    matrices = accessors_.floats(inverse->in(root_, "accessors"), kGltfMatrices);
    if (matrices.size() < 16 * list.size()) {
      inverse->fail(
          fmt::format("has {} matrices for {} joints; export the file again", matrices.size() / 16, list.size()));
    }
  }
  std::vector<Transform> result;
  for (size_t i = 0; i < list.size(); ++i) {
    list.at(i).in(root_, "nodes");
    const Transform joint = place_of(list.at(i).whole(0, kLargestCount));
    result.push_back(inverse ? joint * of_matrix(matrices, 16 * i) : joint);
  }
  return skins_.emplace(skin.where(), std::move(result)).first->second;
}

/// Of EXT_mesh_gpu_instancing, in the node; empty: it has none.
std::vector<Transform> GltfGeometry::instances(const JsonPlace& node) {
  const std::optional<JsonPlace> instancing = extension(node, "EXT_mesh_gpu_instancing");
  const std::optional<JsonPlace> attributes = instancing ? instancing->find("attributes") : std::nullopt;
  if (!attributes) return {};
  std::optional<size_t> count;
  const auto read = [&](const char* key, const GltfForm& form) {
    const std::optional<JsonPlace> place = attributes->find(key);
    if (!place) return std::vector<float>();
    std::vector<float> values = accessors_.floats(place->in(root_, "accessors"), form);
    const size_t elements = values.size() / form.components;
    if (elements != count.value_or(elements))
      place->fail(fmt::format("has {} elements, and another attribute {}; export the file again", elements, *count));
    count = elements;
    if (!std::all_of(values.begin(), values.end(), [](float value) { return std::isfinite(value); }))
      place->fail("has a number that is infinite or none; export the file again");
    return values;
  };
  const std::vector<float> move = read("TRANSLATION", kGltfPositions), turn = read("ROTATION", kGltfRotations),
                           scale = read("SCALE", kGltfPositions);
  const auto vector = [](const std::vector<float>& values, size_t i, double otherwise) {
    return values.empty() ? Vec3d{otherwise, otherwise, otherwise}
                          : Vec3{values[3 * i], values[3 * i + 1], values[3 * i + 2]}.as<double>();
  };
  std::vector<Transform> result;
  for (size_t i = 0; i < count.value_or(0); ++i) {
    std::array<double, 4> q = {0, 0, 0, 1};
    for (size_t k = 0; k < 4 && !turn.empty(); ++k) q[k] = static_cast<double>(turn[4 * i + k]);
    const double norm = std::sqrt(q[0] * q[0] + q[1] * q[1] + q[2] * q[2] + q[3] * q[3]);
    if (!(norm > 0))
      attributes->at("ROTATION").fail(fmt::format("has a zero as rotation {}; export the file again", i));
    for (double& part : q) part /= norm;
    result.push_back(to_transform(vector(move, i, 0), q, vector(scale, i, 1)));
  }
  return result;
}

void GltfGeometry::add_content(const JsonPlace& place, GltfNode& node, bool hidden) {
  if (const std::optional<JsonPlace> name = place.find("name")) node.name = name->text();
  if (const std::optional<JsonPlace> index = place.find("camera")) {
    index->in(root_, "cameras");
    node.camera = index->whole(0, kLargestCount);
  }
  const std::optional<JsonPlace> light = extension(place, "KHR_lights_punctual");
  losses_.hidden += hidden && (light || place.find("mesh"));
  if (hidden || !light) return;
  const JsonPlace index = light->at("light");
  index.in(root_.at("extensions").at("KHR_lights_punctual"), "lights");
  node.light = index.whole(0, kLargestCount);
}

/// Has the node draw the mesh, once or at each instance.
void GltfGeometry::use(const TriangleMesh& drawn, const GltfNode& node, const JsonPlace& place, Json& json) {
  if (!drawn.index) return;
  json["mesh"] = *drawn.index;
  triangles_ += drawn.triangles * std::max<uint64_t>(1, node.instances.size());
  if (triangles_ > kMostTriangles)
    place.fail(fmt::format("brings the scene to {} triangles; {} are the most", triangles_, kMostTriangles));
}

/// What of the node's mesh has a skin is put into a node of its own, below this one.
void GltfGeometry::add_mesh(const JsonPlace& place, size_t number, Json& json) {
  const std::optional<JsonPlace> index = place.find("mesh"), skin = place.find("skin");
  if (!index) return;
  const JsonPlace source = index->in(root_, "meshes");
  document_.nodes[number].instances = instances(place);
  Pose pose;
  const std::optional<JsonPlace> own = place.find("weights"), weights = own ? own : source.find("weights");
  for (size_t i = 0; weights && i < weights->size(); ++i) {
    pose.weights.push_back(weights->at(i).number(-kFar, kFar));
    pose.name += fmt::format(" {}", pose.weights.back());
  }
  if (std::all_of(pose.weights.begin(), pose.weights.end(), [](double weight) { return weight == 0; })) {
    pose.weights.clear();
    pose.name.clear();
  }
  if (!skin) {
    use(mesh(source, pose), document_.nodes[number], place, json);
    return;
  }
  const JsonPlace joints = skin->in(root_, "skins");
  Pose rigid = pose;
  rigid.skinned = false;
  rigid.name += " rigid";
  use(mesh(source, rigid), document_.nodes[number], place, json);
  pose.skinned = true;
  pose.joints = &joints_of(joints);
  pose.name += " " + joints.where();
  const size_t below = document_.nodes.size();
  document_.nodes.emplace_back();
  document_.nodes[below].skinned = true;
  document_.nodes[below].instances = document_.nodes[number].instances;
  json_nodes_.push_back({{"name", std::to_string(below)}});
  use(mesh(source, pose), document_.nodes[below], place, json_nodes_[below]);
  json["children"].push_back(below);
}

/// Returns its index in the geometry.
size_t GltfGeometry::add_node(const JsonPlace& place, size_t index, int depth, bool hidden) {
  if (!reached_.insert(index).second) {
    place.fail("is the child of two nodes, or its own ancestor; nodes must form trees: export the file again");
  }
  if (depth > kDeepest) place.fail(fmt::format("has more than {} nodes above it; flatten the scene", kDeepest));
  const size_t number = document_.nodes.size();
  document_.nodes.emplace_back();
  json_nodes_.push_back(nullptr);
  hidden = hidden || is_hidden(place);
  Json json = transform_json(place);
  document_.nodes[number].transform = to_transform(json);
  json["name"] = std::to_string(number);
  json["children"] = Json::array();
  add_content(place, document_.nodes[number], hidden);
  if (!hidden) add_mesh(place, number, json);
  const std::optional<JsonPlace> children = place.find("children");
  for (size_t i = 0; children && i < children->size(); ++i) {
    const JsonPlace child = children->at(i), target = child.in(root_, "nodes");
    json["children"].push_back(add_node(target, child.whole(0, kLargestCount), depth + 1, hidden));
  }
  if (json["children"].empty()) json.erase("children");
  json_nodes_[number] = std::move(json);
  return number;
}

/// The scene that the file names, or else its first one; without any, all nodes that are children of none.
void GltfGeometry::add_scene() {
  const std::optional<JsonPlace> scenes = root_.find("scenes"), chosen = root_.find("scene");
  if (scenes && scenes->size() > 0) {
    const JsonPlace scene = chosen ? chosen->in(root_, "scenes") : scenes->at(size_t{0});
    if (scenes->size() > 1)
      document_.warnings.push_back(fmt::format("{} alone is drawn, of {} scenes", scene.where(), scenes->size()));
    const std::optional<JsonPlace> nodes = scene.find("nodes");
    for (size_t i = 0; nodes && i < nodes->size(); ++i) {
      const JsonPlace node = nodes->at(i), target = node.in(root_, "nodes");
      roots_.push_back(add_node(target, node.whole(0, kLargestCount), 0, false));
    }
    return;
  }
  const std::optional<JsonPlace> nodes = root_.find("nodes");
  std::vector<bool> is_child(nodes ? nodes->size() : 0);
  for (size_t i = 0; i < is_child.size(); ++i) {
    const std::optional<JsonPlace> children = nodes->at(i).find("children");
    for (size_t k = 0; children && k < children->size(); ++k)
      is_child[children->at(k).whole(0, is_child.size() - 1)] = true;
  }
  for (size_t i = 0; i < is_child.size(); ++i) {
    if (!is_child[i]) roots_.push_back(add_node(nodes->at(i), i, 0, false));
  }
}

Json GltfGeometry::json() {
  if (triangles_ == 0) {
    throw InputError(fmt::format("{}: the scene has no triangles{}; nothing can be rendered", file_.path(),
                                 losses_.hidden > 0  ? ", only hidden nodes"
                                 : losses_.lines > 0 ? ", only points or lines"
                                                     : ""));
  }
  Json json = {{"asset", {{"version", "2.0"}}}, {"scene", 0}, {"scenes", {{{"nodes", roots_}}}}};
  json["nodes"] = std::move(json_nodes_);
  json["meshes"] = std::move(json_meshes_);
  json["accessors"] = std::move(json_accessors_);
  json["bufferViews"] = std::move(json_views_);
  json["buffers"] = std::move(json_buffers_);
  json["materials"] = Json::array();
  for (size_t i = 0; i < document_.materials.size(); ++i) json["materials"].push_back({{"name", std::to_string(i)}});
  return json;
}

}  // namespace raypool
