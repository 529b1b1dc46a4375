// Small fixed-size vectors and matrices, usable on host and device, in float or double.
#pragma once

#include <cmath>

#include "core/host_device.h"

namespace aligngs {

template <class T>
struct Vec2 {
  T x{}, y{};
};

/// A column vector of three numbers.
template <class T>
struct Vec3 {
  T x{}, y{}, z{};

  ALIGNGS_HD T& operator[](int i) { return i == 0 ? x : (i == 1 ? y : z); }
  ALIGNGS_HD const T& operator[](int i) const { return i == 0 ? x : (i == 1 ? y : z); }
  template <class U>
  ALIGNGS_HD Vec3<U> cast() const {
    return {static_cast<U>(x), static_cast<U>(y), static_cast<U>(z)};
  }
  ALIGNGS_HD Vec3& operator+=(const Vec3& b) {
    x += b.x;
    y += b.y;
    z += b.z;
    return *this;
  }
  ALIGNGS_HD Vec3& operator-=(const Vec3& b) {
    x -= b.x;
    y -= b.y;
    z -= b.z;
    return *this;
  }
  ALIGNGS_HD Vec3& operator*=(T s) {
    x *= s;
    y *= s;
    z *= s;
    return *this;
  }
};

template <class T>
ALIGNGS_HD inline Vec3<T> operator+(Vec3<T> a, const Vec3<T>& b) {
  return a += b;
}
template <class T>
ALIGNGS_HD inline Vec3<T> operator-(Vec3<T> a, const Vec3<T>& b) {
  return a -= b;
}
template <class T>
ALIGNGS_HD inline Vec3<T> operator-(const Vec3<T>& a) {
  return {-a.x, -a.y, -a.z};
}
template <class T>
ALIGNGS_HD inline Vec3<T> operator*(Vec3<T> a, T s) {
  return a *= s;
}
template <class T>
ALIGNGS_HD inline Vec3<T> operator*(T s, Vec3<T> a) {
  return a *= s;
}
template <class T>
ALIGNGS_HD inline T dot(const Vec3<T>& a, const Vec3<T>& b) {
  return a.x * b.x + a.y * b.y + a.z * b.z;
}
template <class T>
ALIGNGS_HD inline Vec3<T> cross(const Vec3<T>& a, const Vec3<T>& b) {
  return {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
}
template <class T>
ALIGNGS_HD inline T norm(const Vec3<T>& a) {
  using std::sqrt;
  return sqrt(dot(a, a));
}
/// a / |a|; the zero vector stays zero.
template <class T>
ALIGNGS_HD inline Vec3<T> normalized(const Vec3<T>& a) {
  const T n = norm(a);
  return n > T(0) ? a * (T(1) / n) : a;
}

/// A 3x3 matrix in row-major order: m[3 * row + column].
template <class T>
struct Mat3 {
  T m[9]{};

  ALIGNGS_HD T& operator()(int r, int c) { return m[3 * r + c]; }
  ALIGNGS_HD const T& operator()(int r, int c) const { return m[3 * r + c]; }
  ALIGNGS_HD Vec3<T> row(int r) const { return {m[3 * r], m[3 * r + 1], m[3 * r + 2]}; }
  ALIGNGS_HD Vec3<T> column(int c) const { return {m[c], m[3 + c], m[6 + c]}; }
  ALIGNGS_HD static Mat3 identity() { return {{T(1), 0, 0, 0, T(1), 0, 0, 0, T(1)}}; }
  template <class U>
  ALIGNGS_HD Mat3<U> cast() const {
    Mat3<U> r;
    for (int i = 0; i < 9; ++i) r.m[i] = static_cast<U>(m[i]);
    return r;
  }
};

template <class T>
ALIGNGS_HD inline Vec3<T> operator*(const Mat3<T>& a, const Vec3<T>& v) {
  return {a.m[0] * v.x + a.m[1] * v.y + a.m[2] * v.z, a.m[3] * v.x + a.m[4] * v.y + a.m[5] * v.z,
          a.m[6] * v.x + a.m[7] * v.y + a.m[8] * v.z};
}
template <class T>
ALIGNGS_HD inline Mat3<T> operator*(const Mat3<T>& a, const Mat3<T>& b) {
  Mat3<T> r;
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j) r(i, j) = dot(a.row(i), b.column(j));
  return r;
}
template <class T>
ALIGNGS_HD inline Mat3<T> transpose(const Mat3<T>& a) {
  return {{a.m[0], a.m[3], a.m[6], a.m[1], a.m[4], a.m[7], a.m[2], a.m[5], a.m[8]}};
}
/// transpose(a) * v without forming the transpose.
template <class T>
ALIGNGS_HD inline Vec3<T> transpose_times(const Mat3<T>& a, const Vec3<T>& v) {
  return {a.m[0] * v.x + a.m[3] * v.y + a.m[6] * v.z, a.m[1] * v.x + a.m[4] * v.y + a.m[7] * v.z,
          a.m[2] * v.x + a.m[5] * v.y + a.m[8] * v.z};
}
template <class T>
ALIGNGS_HD inline T determinant(const Mat3<T>& a) {
  return dot(a.row(0), cross(a.row(1), a.row(2)));
}

using Vec2f = Vec2<float>;
using Vec2d = Vec2<double>;
using Vec3f = Vec3<float>;
using Vec3d = Vec3<double>;
using Mat3f = Mat3<float>;
using Mat3d = Mat3<double>;

}  // namespace aligngs
