#pragma once
// Sines, cosines and powers whose bits are the same everywhere: + - * / only, where libm's differ between
// platforms. Accurate to a few units in the last place.

#include <bit>
#include <cstdint>

namespace restroke {

struct SineCosine {
  double sine = 0, cosine = 1;
};

/// Of an angle in turns (1 is a full circle); any finite number below 2^40.
[[nodiscard]] inline SineCosine sineCosineOfTurns(double turns) {
  // To the nearest quarter turn; then the Taylor series of |x| <= pi / 4, whose next terms are below 2^-56.
  const double quarters = turns * 4;
  const auto whole = static_cast<std::int64_t>(quarters + (quarters < 0 ? -0.5 : 0.5));
  const double x = (quarters - static_cast<double>(whole)) * 1.5707963267948966, y = x * x;
  const double sine =
      x * (1 + y * (-1.0 / 6 + y * (1.0 / 120 + y * (-1.0 / 5040 +
                                                     y * (1.0 / 362880 + y * (-1.0 / 39916800 +
                                                                              y * (1.0 / 6227020800.0 -
                                                                                   y / 1307674368000.0)))))));
  const double cosine =
      1 + y * (-1.0 / 2 +
               y * (1.0 / 24 +
                    y * (-1.0 / 720 +
                         y * (1.0 / 40320 +
                              y * (-1.0 / 3628800 + y * (1.0 / 479001600.0 + y * (-1.0 / 87178291200.0 +
                                                                                  y / 20922789888000.0)))))));
  switch (whole & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

/// x^e for x >= 0 and |e| <= 64; 0^e is 0 for e > 0. Relative error below 1e-14 where the result is a normal
/// number; smaller results may be 0.
[[nodiscard]] inline double powerOf(double x, double e) {
  if (!(x > 0)) return x == 0 ? (e > 0 ? 0.0 : 1.0) : x;
  if (e == 1) return x;
  if (e == 2) return x * x;
  auto bits = std::bit_cast<std::uint64_t>(x);
  if (bits >> 52 == 0) return 0;  // subnormal
  auto exponent = static_cast<std::int64_t>(bits >> 52) - 1023;
  bits = (bits & 0x000FFFFFFFFFFFFFull) | 0x3FF0000000000000ull;
  auto m = std::bit_cast<double>(bits);  // 1 to 2
  if (m > 1.4142135623730951) {
    m *= 0.5;
    ++exponent;
  }
  // ln m = 2 artanh t, |t| < 0.172.
  const double t = (m - 1) / (m + 1), y = t * t;
  const double series =
      1 + y * (1.0 / 3 +
               y * (1.0 / 5 +
                    y * (1.0 / 7 +
                         y * (1.0 / 9 +
                              y * (1.0 / 11 + y * (1.0 / 13 + y * (1.0 / 15 + y * (1.0 / 17 + y / 19))))))));
  const double log2 = static_cast<double>(exponent) + 2 * t * series * 1.4426950408889634;
  const double power = log2 * e;
  if (power < -1000) return 0;
  if (power > 1000) return std::bit_cast<double>(std::uint64_t{0x7FF0000000000000ull});
  const auto whole = static_cast<std::int64_t>(power + (power < 0 ? -0.5 : 0.5));
  const double f = (power - static_cast<double>(whole)) * 0.6931471805599453;
  // e^f, |f| < 0.347.
  const double result =
      1 +
      f * (1 + f * (1.0 / 2 +
                    f * (1.0 / 6 +
                         f * (1.0 / 24 +
                              f * (1.0 / 120 +
                                   f * (1.0 / 720 +
                                        f * (1.0 / 5040 +
                                             f * (1.0 / 40320 +
                                                  f * (1.0 / 362880 +
                                                       f * (1.0 / 3628800 +
                                                            f * (1.0 / 39916800 + f / 479001600.0)))))))))));
  return result * std::bit_cast<double>(static_cast<std::uint64_t>(whole + 1023) << 52);
}

}  // namespace restroke
