// Ju, Losasso, Schaefer, Warren, "Dual contouring of Hermite data", SIGGRAPH 2002, section 2: minimise the
// squared distances to the tangent planes, through an eigendecomposition whose small eigenvalues are dropped,
// from the mean of the crossings. Where the minimum leaves the cell we minimise over each of the cell's
// faces, edges and corners instead and take the best, which is the constrained minimum (the error is convex).

#include "points/isosurface/qef.h"

#include <algorithm>
#include <cmath>

namespace restroke::points {

/// Eigenvalues and -vectors of a symmetric matrix.
struct QefEigen {
  std::array<double, 3> value{};
  std::array<DVec3, 3> vector{DVec3(1, 0, 0), DVec3(0, 1, 0), DVec3(0, 0, 1)};
};

namespace {

using Eigen3 = QefEigen;

// Matrices are decomposed side by side: the roots and quotients of one alone would wait for each other.
constexpr std::size_t kLanes = Qef::kBatch;
struct Lanes {
  double of[kLanes];
};

// One rotation, of those matrices whose element (p, q) is not 0 yet.
void rotate(Lanes (&a)[3][3], Lanes (&v)[3][3], int p, int q) {
  Lanes c, s, turns;
  for (std::size_t l = 0; l < kLanes; ++l) {
    const double apq = a[p][q].of[l];
    const double theta = (a[q][q].of[l] - a[p][p].of[l]) / (2 * apq);
    const double t = (theta >= 0 ? 1.0 : -1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
    c.of[l] = 1 / std::sqrt(t * t + 1);
    s.of[l] = t * c.of[l];
    turns.of[l] = apq;
  }
  const auto turn = [&](Lanes& first, Lanes& second) {
    for (std::size_t l = 0; l < kLanes; ++l) {
      const double x = first.of[l], y = second.of[l];
      const double fresh = c.of[l] * x - s.of[l] * y, other = s.of[l] * x + c.of[l] * y;
      first.of[l] = turns.of[l] != 0 ? fresh : x;
      second.of[l] = turns.of[l] != 0 ? other : y;
    }
  };
  for (int k = 0; k < 3; ++k) turn(a[k][p], a[k][q]);
  for (int k = 0; k < 3; ++k) turn(a[p][k], a[q][k]);
  for (std::size_t l = 0; l < kLanes; ++l) {
    a[p][q].of[l] = turns.of[l] != 0 ? 0 : a[p][q].of[l];
    a[q][p].of[l] = turns.of[l] != 0 ? 0 : a[q][p].of[l];
  }
  for (auto& row : v) turn(row[p], row[q]);
}

// Cyclic Jacobi rotations (Golub, Van Loan, "Matrix computations", section 8.5): + - * / sqrt only. Each
// sweep squares what is left off the diagonal; 10 are more than double precision can use.
void eigenOf(const std::array<double, 6>* const (&m)[kLanes], Eigen3 (&out)[kLanes]) {
  constexpr int kEntry[3][3] = {{0, 1, 2}, {1, 3, 4}, {2, 4, 5}};
  Lanes a[3][3], v[3][3];
  for (int i = 0; i < 3; ++i)
    for (int j = 0; j < 3; ++j)
      for (std::size_t l = 0; l < kLanes; ++l) {
        a[i][j].of[l] = (*m[l])[static_cast<std::size_t>(kEntry[i][j])];
        v[i][j].of[l] = i == j ? 1 : 0;
      }
  for (int sweep = 0; sweep < 10; ++sweep) {
    bool done = true;
    for (std::size_t l = 0; l < kLanes; ++l)
      done = done && a[0][1].of[l] == 0 && a[0][2].of[l] == 0 && a[1][2].of[l] == 0;
    if (done) break;
    rotate(a, v, 0, 1);
    rotate(a, v, 0, 2);
    rotate(a, v, 1, 2);
  }
  for (std::size_t l = 0; l < kLanes; ++l)
    for (int i = 0; i < 3; ++i) {
      out[l].value[static_cast<std::size_t>(i)] = a[i][i].of[l];
      out[l].vector[static_cast<std::size_t>(i)] = {v[0][i].of[l], v[1][i].of[l], v[2][i].of[l]};
    }
}

// The same of one matrix, bit for bit.
Eigen3 eigenOf(const std::array<double, 6>& m) {
  double a[3][3] = {{m[0], m[1], m[2]}, {m[1], m[3], m[4]}, {m[2], m[4], m[5]}};
  double v[3][3] = {{1, 0, 0}, {0, 1, 0}, {0, 0, 1}};
  for (int sweep = 0; sweep < 10; ++sweep) {
    if (a[0][1] == 0 && a[0][2] == 0 && a[1][2] == 0) break;
    for (int p = 0; p < 2; ++p)
      for (int q = p + 1; q < 3; ++q) {
        if (a[p][q] == 0) continue;
        const double theta = (a[q][q] - a[p][p]) / (2 * a[p][q]);
        const double t = (theta >= 0 ? 1.0 : -1.0) / (std::fabs(theta) + std::sqrt(theta * theta + 1));
        const double c = 1 / std::sqrt(t * t + 1), s = t * c;
        for (int k = 0; k < 3; ++k) {
          const double kp = a[k][p], kq = a[k][q];
          a[k][p] = c * kp - s * kq;
          a[k][q] = s * kp + c * kq;
        }
        for (int k = 0; k < 3; ++k) {
          const double pk = a[p][k], qk = a[q][k];
          a[p][k] = c * pk - s * qk;
          a[q][k] = s * pk + c * qk;
        }
        a[p][q] = a[q][p] = 0;
        for (auto& row : v) {
          const double kp = row[p], kq = row[q];
          row[p] = c * kp - s * kq;
          row[q] = s * kp + c * kq;
        }
      }
  }
  Eigen3 out;
  for (int i = 0; i < 3; ++i) {
    out.value[static_cast<std::size_t>(i)] = a[i][i];
    out.vector[static_cast<std::size_t>(i)] = {v[0][i], v[1][i], v[2][i]};
  }
  return out;
}

DVec3 times(const std::array<double, 6>& m, DVec3 x) {
  return {m[0] * x.x + m[1] * x.y + m[2] * x.z, m[1] * x.x + m[3] * x.y + m[4] * x.z,
          m[2] * x.x + m[4] * x.y + m[5] * x.z};
}

}  // namespace

void Qef::add(DVec3 p, DVec3 n) {
  const double d = dot(n, p);
  a_[0] += n.x * n.x;
  a_[1] += n.x * n.y;
  a_[2] += n.x * n.z;
  a_[3] += n.y * n.y;
  a_[4] += n.y * n.z;
  a_[5] += n.z * n.z;
  b_ += n * d;
  c_ += d * d;
  sum_ += p;
  normals_ += n;
  ++count_;
}

double Qef::errorAt(DVec3 x) const {
  return std::max(0.0, dot(x, times(a_, x)) - 2 * dot(b_, x) + c_);
}

// In all directions. Eigenvalues up to `least` count as none.
Qef::Minimum Qef::solveFree(const QefEigen& eigen, double& least) const {
  least = kRankRatio * std::max({eigen.value[0], eigen.value[1], eigen.value[2]});
  Minimum out{mean(), 0};
  const DVec3 residual = b_ - times(a_, out.position);
  for (std::size_t i = 0; i < 3; ++i)
    if (eigen.value[i] > least) {
      out.position += eigen.vector[i] * (dot(eigen.vector[i], residual) / eigen.value[i]);
      ++out.rank;
    }
  return out;
}

Qef::Minimum Qef::solve(const Fixed& fixed, double half, double least) const {
  // The mean moved onto the bounds; from there in the free directions.
  Minimum out{mean(), 0};
  std::array<double, 6> a = a_;
  std::size_t free = 0, lastFree = 0;
  for (std::size_t i = 0; i < 3; ++i) {
    if (fixed[i] != 0) {
      out.position[static_cast<int>(i)] = fixed[i] * half;
    } else {
      ++free;
      lastFree = i;
    }
  }
  DVec3 residual = b_ - times(a_, out.position);
  constexpr std::array<std::array<std::size_t, 3>, 3> kEntry{{{0, 1, 2}, {1, 3, 4}, {2, 4, 5}}};
  if (free == 1) {
    const double value = a[kEntry[lastFree][lastFree]];
    if (value > least)
      out.position[static_cast<int>(lastFree)] += residual[static_cast<int>(lastFree)] / value;
  }
  if (free < 2) return out;
  for (std::size_t i = 0; i < 3; ++i) {
    if (fixed[i] == 0) continue;
    for (std::size_t j = 0; j < 3; ++j) a[kEntry[i][j]] = 0;
    residual[static_cast<int>(i)] = 0;
  }
  const Eigen3 eigen = eigenOf(a);
  for (std::size_t i = 0; i < 3; ++i)
    if (eigen.value[i] > least) {
      out.position += eigen.vector[i] * (dot(eigen.vector[i], residual) / eigen.value[i]);
      ++out.rank;
    }
  return out;
}

Qef::Minimum Qef::minimum() const {
  double least = 0;
  return solveFree(eigenOf(a_), least);
}

Qef::Minimum Qef::minimumWithin(double half) const {
  return minimumWithin(eigenOf(a_), half);
}

void Qef::minimaWithin(double half, const Batch& batch, std::array<Minimum, kBatch>& out) {
  const std::array<double, 6>* matrices[kBatch];
  for (std::size_t i = 0; i < kBatch; ++i) matrices[i] = &batch[i]->a_;
  Eigen3 eigen[kBatch];
  eigenOf(matrices, eigen);
  for (std::size_t i = 0; i < kBatch; ++i) out[i] = batch[i]->minimumWithin(eigen[i], half);
}

Qef::Minimum Qef::minimumWithin(const QefEigen& eigen, double half) const {
  const auto within = [&](DVec3 p) {
    return std::fabs(p.x) <= half && std::fabs(p.y) <= half && std::fabs(p.z) <= half;
  };
  double least = 0;
  const Minimum free = solveFree(eigen, least);
  if (within(free.position)) return free;
  Minimum best{mean(), free.rank};
  for (int i = 0; i < 3; ++i) best.position[i] = std::clamp(best.position[i], -half, half);
  double error = errorAt(best.position);
  for (int x = -1; x <= 1; ++x)
    for (int y = -1; y <= 1; ++y)
      for (int z = -1; z <= 1; ++z) {
        if (x == 0 && y == 0 && z == 0) continue;
        const DVec3 p = solve({x, y, z}, half, least).position;
        if (!within(p) || !(errorAt(p) < error)) continue;
        error = errorAt(p);
        best.position = p;
      }
  return best;
}

}  // namespace restroke::points
