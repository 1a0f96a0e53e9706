// Point-to-plane registration after Chen and Medioni, Object modelling by registration of multiple range
// images (1992), with the normal of a match half way between those of its two points, after Rusinkiewicz, A
// symmetric objective function for ICP (2019): the distance is then zero whenever both lie on one arc of any
// curvature, so that two independent samplings of a curved surface do not pull the motion to one side. Ours
// has a scale, too.
//
// Solved with ceres::TinySolver, which lives in headers alone: libceres is not linked (README, Licence).

#include "retarget/alignment/fit.h"

#include <ceres/tiny_solver.h>
#include <ceres/tiny_solver_autodiff_function.h>

#include <Eigen/Eigenvalues>

namespace restroke::retarget::alignment {

namespace {

constexpr int kUnknowns = 7;  // half the turn's vector, logarithm of the scale, shift in radii

struct Residuals {
  std::span<const Match> matches;
  StepFrame frame;

  [[nodiscard]] int NumResiduals() const { return static_cast<int>(matches.size()); }  // NOLINT: Ceres' name

  template <typename T>
  bool operator()(const T* unknowns, T* residuals) const {
    using std::exp;
    const T &a = unknowns[0], &b = unknowns[1], &c = unknowns[2];
    // Cayley's formula: rows of the rotation, scaled.
    const T aa = a * a, bb = b * b, cc = c * c;
    const T factor = exp(unknowns[3]) / (1.0 + aa + bb + cc);
    const T m[9] = {
        factor * (1.0 + aa - bb - cc), factor * 2.0 * (a * b - c),    factor * 2.0 * (a * c + b),
        factor * 2.0 * (a * b + c),    factor * (1.0 - aa + bb - cc), factor * 2.0 * (b * c - a),
        factor * 2.0 * (a * c - b),    factor * 2.0 * (b * c + a),    factor * (1.0 - aa - bb + cc)};
    const double inverse = 1.0 / frame.radius;
    for (std::size_t k = 0; k < matches.size(); ++k) {
      const Match& match = matches[k];
      const DVec3 x = (match.from - frame.center) * inverse, y = (match.to - frame.center) * inverse;
      const DVec3 n = std::sqrt(match.weight) * match.normal;
      residuals[k] = n.x * (m[0] * x.x + m[1] * x.y + m[2] * x.z + unknowns[4]) +
                     n.y * (m[3] * x.x + m[4] * x.y + m[5] * x.z + unknowns[5]) +
                     n.z * (m[6] * x.x + m[7] * x.y + m[8] * x.z + unknowns[6]) - dot(n, y);
    }
    return true;
  }
};

}  // namespace

Similarity fittingStep(std::span<const Match> matches, const StepFrame& frame, int iterations) {
  if (matches.empty()) return {};
  using Function = ceres::TinySolverAutoDiffFunction<Residuals, Eigen::Dynamic, kUnknowns>;
  const Residuals residuals{matches, frame};
  const Function function(residuals);
  ceres::TinySolver<Function> solver;
  solver.options.max_num_iterations = iterations;
  Eigen::Matrix<double, kUnknowns, 1> u = Eigen::Matrix<double, kUnknowns, 1>::Zero();
  solver.Solve(function, &u);
  if (!u.allFinite()) return {};
  const DVec3 half(u[0], u[1], u[2]);
  const double size = length(half);
  Similarity step;
  if (size > 0) step.rotation = rotationAbout(half / size, size);
  step.scale = std::exp(u[3]);
  // center + radius * (scale R (p - center) / radius + shift)
  const DVec3 shift(u[4], u[5], u[6]);
  step.translation = frame.center + frame.radius * shift - step.scale * turned(step.rotation, frame.center);
  return step;
}

double firmnessOf(std::span<const Match> matches, const StepFrame& frame) {
  using Hessian = Eigen::Matrix<double, kUnknowns, kUnknowns>;
  Hessian sum = Hessian::Zero();
  double weights = 0;
  for (const Match& match : matches) {
    const DVec3 x = (match.from - frame.center) / frame.radius, n = match.normal, turn = cross(x, n);
    Eigen::Matrix<double, kUnknowns, 1> row;
    row << turn.x, turn.y, turn.z, dot(x, n), n.x, n.y, n.z;
    sum += match.weight * row * row.transpose();
    weights += match.weight;
  }
  if (!(weights > 0)) return 0;
  const Eigen::SelfAdjointEigenSolver<Hessian> solver(sum / weights, Eigen::EigenvaluesOnly);
  return std::fmax(0.0, solver.eigenvalues()[0]);
}

}  // namespace restroke::retarget::alignment
