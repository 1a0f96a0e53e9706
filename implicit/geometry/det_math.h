#pragma once
// Functions that libm has too, made of + - * / alone, so that every platform gives the same bits (DESIGN.md,
// invariant 5).

namespace restroke {

inline constexpr double kPi = 3.141592653589793238462643383279502884;

/// Angle of (x, y) from the x axis in radians, in [-pi, pi]. (0, 0) gives 0, and y = -0 counts as +0. Within
/// 1e-15 of the true value for finite arguments whose larger one is not subnormal.
[[nodiscard]] constexpr double detAtan2(double y, double x) {
  // atan(k / 8), rounded to double.
  constexpr double kAtan[9] = {0,
                               0.12435499454676143503135484916387,
                               0.24497866312686415417208248121128,
                               0.35877067027057222039592006392647,
                               0.46364760900080611621425623146121,
                               0.55859931534356243597150821640167,
                               0.64350110879328438680280922871732,
                               0.71882999962162450541701415152590,
                               0.78539816339744830961566084581988};
  const double ax = x < 0 ? -x : x, ay = y < 0 ? -y : y;
  const bool steep = ay > ax;
  const double larger = steep ? ay : ax, smaller = steep ? ax : ay;
  if (larger == 0) return 0;
  const double t = smaller / larger;
  // atan t = atan c + atan r with c the nearest eighth and r = (t - c) / (1 + t c), at most 1/16 in size,
  // where seven terms of the series leave less than (1/16)^15 / 15 = 6e-20.
  const int k = (static_cast<int>(t * 16) + 1) / 2;
  const double c = k / 8.0;
  const double r = (t - c) / (1 + t * c), s = r * r;
  const double series =
      1 - s * (1 / 3. - s * (1 / 5. - s * (1 / 7. - s * (1 / 9. - s * (1 / 11. - s * (1 / 13.))))));
  double angle = kAtan[k] + r * series;
  if (steep) angle = kPi / 2 - angle;
  if (x < 0) angle = kPi - angle;
  return y < 0 ? -angle : angle;
}

}  // namespace restroke
