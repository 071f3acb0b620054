/// An 80-bit scalar type for laws: an oracle that shares neither rounding nor derivatives with the library's types.
#pragma once
#include <cmath>

namespace oracle {

struct Long {
  long double x;
  Long() = default;
  Long(double value) : x(value) {}
  explicit Long(long double value) : x(value) {}
  explicit operator double() const { return double(x); }
};

inline Long operator+(Long a, Long b) { return Long(a.x + b.x); }
inline Long operator-(Long a, Long b) { return Long(a.x - b.x); }
inline Long operator*(Long a, Long b) { return Long(a.x * b.x); }
inline Long operator/(Long a, Long b) { return Long(a.x / b.x); }
inline Long operator-(Long a) { return Long(-a.x); }
inline bool operator<(Long a, Long b) { return a.x < b.x; }
inline bool operator>(Long a, Long b) { return a.x > b.x; }
inline Long select(bool which, Long a, Long b) { return which ? a : b; }
inline Long abs(Long a) { return Long(std::fabs(a.x)); }
inline Long exp(Long a) { return Long(std::exp(a.x)); }
inline Long expm1(Long a) { return Long(std::expm1(a.x)); }
inline Long log(Long a) { return Long(std::log(a.x)); }
inline Long log1p(Long a) { return Long(std::log1p(a.x)); }
inline Long sqrt(Long a) { return Long(std::sqrt(a.x)); }

}  // namespace oracle
