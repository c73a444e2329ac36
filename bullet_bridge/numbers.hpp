// Numbers of C as Bullet's vectors, and back.
#ifndef BULLET_BRIDGE_NUMBERS_HPP
#define BULLET_BRIDGE_NUMBERS_HPP

#include <algorithm>
#include <cmath>
#include <cstdint>

#include <LinearMath/btMatrix3x3.h>

namespace shiver
{
inline btVector3 vector(const double v[3])
{
    return btVector3(v[0], v[1], v[2]);
}

inline btMatrix3x3 matrix(const double m[9])
{
    return btMatrix3x3(m[0], m[1], m[2], m[3], m[4], m[5], m[6], m[7], m[8]);
}

// 1/m, a power of two, which changes no bit, in which the smaller of two bodies (the other one, of a body and a point) has a size of 1
// to 2. Bullet takes a simplex whose triple product is below 1e-8, whatever its unit, for flat: in others GJK ends too early.
inline double simplex_unit(double first, double second)
{
    const double least = std::min(first, second), size = least > 0.0 ? least : std::max(first, second);
    return size > 0.0 ? std::ldexp(1.0, -std::ilogb(size)) : 1.0;
}

inline void store(const btVector3 &v, double out[3])
{
    for (int i = 0; i < 3; i++) out[i] = v[i];
}

inline bool finite(const double *values, int64_t count)
{
    return std::all_of(values, values + count, [](double value) { return std::isfinite(value); });
}
} // namespace shiver

#endif
