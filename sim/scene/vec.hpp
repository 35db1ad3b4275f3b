// Three-component vectors: Vec3 (float) is what scenes are stored in, Vec3d (double) what they are computed in.
#pragma once

#include <algorithm>
#include <cmath>

namespace raypool {

template <typename T>
struct Vector3 {
  T x{}, y{}, z{};

  template <typename U>
  Vector3<U> as() const {
    return {static_cast<U>(x), static_cast<U>(y), static_cast<U>(z)};
  }
  T operator[](int axis) const { return axis == 0 ? x : axis == 1 ? y : z; }
  T& operator[](int axis) { return axis == 0 ? x : axis == 1 ? y : z; }
};

using Vec3 = Vector3<float>;
using Vec3d = Vector3<double>;

template <typename T>
Vector3<T> operator+(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x + b.x, a.y + b.y, a.z + b.z};
}
template <typename T>
Vector3<T> operator-(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.x - b.x, a.y - b.y, a.z - b.z};
}
template <typename T>
Vector3<T> operator*(const Vector3<T>& a, T b) {
  return {a.x * b, a.y * b, a.z * b};
}
template <typename T>
bool operator==(const Vector3<T>& a, const Vector3<T>& b) {
  return a.x == b.x && a.y == b.y && a.z == b.z;
}
template <typename T>
T dot(const Vector3<T>& a, const Vector3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <typename T>
Vector3<T> cross(const Vector3<T>& a, const Vector3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <typename T>
T length(const Vector3<T>& a) {
  return std::sqrt(dot(a, a));
}
/// Of the components, without their signs.
template <typename T>
T largest_of(const Vector3<T>& a) {
  return std::max({std::fabs(a.x), std::fabs(a.y), std::fabs(a.z)});
}
/// `a` must not be zero.
template <typename T>
Vector3<T> normalized(const Vector3<T>& a) {
  return a * (T{1} / length(a));
}

}  // namespace raypool
