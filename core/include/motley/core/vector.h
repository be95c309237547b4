// Small vectors, quaternions and symmetric matrices over any scalar: float, double, or a bundle of lanes.
// Nothing here branches on a value, so the same code serves one constraint or a bundle of lanes.
#pragma once

#pragma GCC visibility push(default)
namespace motley {

template <class Real>
struct Vec2 {
    Real x{}, y{};
};

template <class Real>
struct Vec3 {
    Real x{}, y{}, z{};
};

/// Unit quaternion (x, y, z, w), w scalar, rotating body to world.
template <class Real>
struct Quat {
    Real x{}, y{}, z{}, w{};
};

/// Symmetric 2x2 matrix.
template <class Real>
struct Sym2 {
    Real xx{}, xy{}, yy{};
};

/// Symmetric 3x3 matrix.
template <class Real>
struct Sym3 {
    Real xx{}, xy{}, xz{}, yy{}, yz{}, zz{};
};

// clang-format off
template <class R> Vec2<R> operator+(const Vec2<R>& u, const Vec2<R>& v) { return {u.x + v.x, u.y + v.y}; }
template <class R> Vec2<R> operator-(const Vec2<R>& u, const Vec2<R>& v) { return {u.x - v.x, u.y - v.y}; }
template <class R> Vec2<R> operator-(const Vec2<R>& u) { return {-u.x, -u.y}; }
template <class R> Vec2<R> operator*(const R& s, const Vec2<R>& v) { return {s * v.x, s * v.y}; }
template <class R> Vec3<R> operator+(const Vec3<R>& u, const Vec3<R>& v) { return {u.x + v.x, u.y + v.y, u.z + v.z}; }
template <class R> Vec3<R> operator-(const Vec3<R>& u, const Vec3<R>& v) { return {u.x - v.x, u.y - v.y, u.z - v.z}; }
template <class R> Vec3<R> operator-(const Vec3<R>& u) { return {-u.x, -u.y, -u.z}; }
template <class R> Vec3<R> operator*(const R& s, const Vec3<R>& v) { return {s * v.x, s * v.y, s * v.z}; }
template <class R> R dot(const Vec2<R>& u, const Vec2<R>& v) { return u.x * v.x + u.y * v.y; }
template <class R> R dot(const Vec3<R>& u, const Vec3<R>& v) { return u.x * v.x + u.y * v.y + u.z * v.z; }
template <class R> Sym2<R> operator+(const Sym2<R>& m, const Sym2<R>& n) { return {m.xx + n.xx, m.xy + n.xy, m.yy + n.yy}; }
template <class R> Sym3<R> operator+(const Sym3<R>& m, const Sym3<R>& n)
{ return {m.xx + n.xx, m.xy + n.xy, m.xz + n.xz, m.yy + n.yy, m.yz + n.yz, m.zz + n.zz}; }
template <class R> Sym2<R> operator*(const R& s, const Sym2<R>& m) { return {s * m.xx, s * m.xy, s * m.yy}; }
template <class R> Sym3<R> operator*(const R& s, const Sym3<R>& m)
{ return {s * m.xx, s * m.xy, s * m.xz, s * m.yy, s * m.yz, s * m.zz}; }
// clang-format on

template <class R>
Vec3<R> cross(const Vec3<R>& u, const Vec3<R>& v)
{
    return {u.y * v.z - u.z * v.y, u.z * v.x - u.x * v.z, u.x * v.y - u.y * v.x};
}

/// The z component of the cross product of two vectors of the plane.
template <class R>
R cross(const Vec2<R>& u, const Vec2<R>& v)
{
    return u.x * v.y - u.y * v.x;
}

template <class R>
Vec2<R> operator*(const Sym2<R>& m, const Vec2<R>& v)
{
    return {m.xx * v.x + m.xy * v.y, m.xy * v.x + m.yy * v.y};
}

template <class R>
Vec3<R> operator*(const Sym3<R>& m, const Vec3<R>& v)
{
    return {m.xx * v.x + m.xy * v.y + m.xz * v.z, m.xy * v.x + m.yy * v.y + m.yz * v.z,
            m.xz * v.x + m.yz * v.y + m.zz * v.z};
}

template <class R>
R determinant(const Sym3<R>& m)
{
    return m.xx * (m.yy * m.zz - m.yz * m.yz) - m.xy * (m.xy * m.zz - m.yz * m.xz) +
           m.xz * (m.xy * m.yz - m.yy * m.xz);
}

/// Rotation of v by q: v + 2 w (u x v) + 2 u x (u x v), u the vector part.
template <class R>
Vec3<R> rotate(const Quat<R>& q, const Vec3<R>& v)
{
    const Vec3<R> u{q.x, q.y, q.z};
    const Vec3<R> t = cross(u, v);
    const Vec3<R> twice{t.x + t.x, t.y + t.y, t.z + t.z};
    return v + q.w * twice + cross(u, twice);
}

/// Hamilton product: the rotation q after the rotation p.
template <class R>
Quat<R> operator*(const Quat<R>& q, const Quat<R>& p)
{
    return {q.w * p.x + q.x * p.w + q.y * p.z - q.z * p.y, q.w * p.y - q.x * p.z + q.y * p.w + q.z * p.x,
            q.w * p.z + q.x * p.y - q.y * p.x + q.z * p.w, q.w * p.w - q.x * p.x - q.y * p.y - q.z * p.z};
}

template <class R>
Quat<R> conjugate(const Quat<R>& q)
{
    return {-q.x, -q.y, -q.z, q.w};
}

/// One Newton step towards unit length, which suffices for a quaternion that left it by rounding or by a
/// small rotation: |q|^2 = 1 + e becomes 1 - 3/4 e^2.
template <class R>
Quat<R> normalised(const Quat<R>& q)
{
    const R scale = R(1.5F) - R(0.5F) * (q.x * q.x + q.y * q.y + q.z * q.z + q.w * q.w);
    return {scale * q.x, scale * q.y, scale * q.z, scale * q.w};
}

/// R m R^T for the rotation R of q: takes a tensor from the body frame to the world frame.
template <class R>
Sym3<R> rotate_tensor(const Quat<R>& q, const Sym3<R>& m)
{
    // rotate() of the unit vectors, without the products with 0; adding 0 makes a zero positive, as it does there.
    const R x2 = q.x + q.x, y2 = q.y + q.y, z2 = q.z + q.z;
    const R xx = q.x * x2, yy = q.y * y2, zz = q.z * z2, xy = q.x * y2, xz = q.x * z2, yz = q.y * z2;
    const R wx = q.w * x2, wy = q.w * y2, wz = q.w * z2;
    const Vec3<R> ex{R(1) - (yy + zz), (R(0) + wz) + xy, (R(0) - wy) + xz};
    const Vec3<R> ey{(R(0) - wz) + xy, R(1) - (zz + xx), (R(0) + wx) + yz};
    const Vec3<R> ez = cross(ex, ey);
    // Rows of R in terms of the columns ex, ey, ez.
    const Vec3<R> r0{ex.x, ey.x, ez.x}, r1{ex.y, ey.y, ez.y}, r2{ex.z, ey.z, ez.z};
    const Vec3<R> m0 = m * r0, m1 = m * r1, m2 = m * r2;
    return {dot(r0, m0), dot(r0, m1), dot(r0, m2), dot(r1, m1), dot(r1, m2), dot(r2, m2)};
}

template <class To, class From>
Vec3<To> convert(const Vec3<From>& v)
{
    return {static_cast<To>(v.x), static_cast<To>(v.y), static_cast<To>(v.z)};
}

template <class To, class From>
Quat<To> convert(const Quat<From>& q)
{
    return {static_cast<To>(q.x), static_cast<To>(q.y), static_cast<To>(q.z), static_cast<To>(q.w)};
}

}  // namespace motley
#pragma GCC visibility pop
