// Layered depth-normal images (C. Wang, Y.-S. Leung, Y. Chen, Solid Modeling of Polyhedral Objects by Layered
// Depth-Normal Images on the GPU, Computer-Aided Design 42, 2010) by peeling (C. Everitt, Interactive
// Order-Independent Transparency, 2001) or by lists of fragments. We differ in what decides: there the
// rasteriser and a depth buffer, here the shader's own predicate in double, and the order of depth and
// triangle, so that nothing at equal depths is lost.

#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "implicit/errors.h"
#include "points/dexel/gl/gl_dexel_shaders.h"
#include "points/dexel/gl/gl_dexel_state.h"
#include "points/dexel/gl/gl_drawing.h"
#include "points/dexel/gl/gl_sort_shaders.h"

namespace restroke::points {

namespace {

// Beyond, differences could overflow float32.
constexpr double kFarthest = 1e30;
constexpr std::size_t kBytesPerEnd = 16, kBytesPerFragment = 8;

template <class Run>
void inBatches(std::size_t triangles, const Run& run) {
  for (std::size_t first = 0; first < triangles; first += kTrianglesPerBatch)
    run(first, std::min(kTrianglesPerBatch, triangles - first));
}

void runOnTriangles(const GlProgram& program, std::size_t triangles) {
  glUniform1ui(program.at("triangleCount"), static_cast<GLuint>(triangles));
  glDispatchCompute(static_cast<GLuint>((triangles + 255) / 256), 1, 1);
}

void validate(const PoseMatrix& pose) {
  for (const double x : pose)
    if (!std::isfinite(x))
      throw InputError(fmt::format("the pose has the element {}; all 16 must be finite", x));
  for (std::size_t k = 0; k < 4; ++k)
    if (pose[12 + k] != (k == 3 ? 1.0 : 0.0))
      throw InputError(fmt::format("the pose's last row is {} {} {} {}; it must be 0 0 0 1", pose[12],
                                   pose[13], pose[14], pose[15]));
}

// Box of the posed corners of a box, and what rounding may add.
Box posedBox(const Box& box, const PoseMatrix& pose) {
  if (box.empty()) return box;
  Box posed;
  for (int corner = 0; corner < 8; ++corner) {
    const DVec3 p(static_cast<double>(corner & 1 ? box.max.x : box.min.x),
                  static_cast<double>(corner & 2 ? box.max.y : box.min.y),
                  static_cast<double>(corner & 4 ? box.max.z : box.min.z));
    Point low, high;
    for (int k = 0; k < 3; ++k) {
      const double* const row = &pose[static_cast<std::size_t>(4 * k)];
      const double terms[4] = {row[0] * p.x, row[1] * p.y, row[2] * p.z, row[3]};
      const double sum = terms[0] + terms[1] + terms[2] + terms[3];
      const double slack =
          1e-6 * (std::fabs(terms[0]) + std::fabs(terms[1]) + std::fabs(terms[2]) + std::fabs(terms[3]));
      if (!(std::fabs(sum) + slack <= kFarthest))
        throw InputError(
            fmt::format("the mesh reaches to the coordinate {:.6g} in its pose; at most {:.6g} can be drawn",
                        sum, kFarthest));
      low[k] = static_cast<float>(sum - slack);
      high[k] = static_cast<float>(sum + slack);
    }
    posed.add({low, high});
  }
  return posed;
}

}  // namespace

GlPeeler::GlPeeler(GlDexelContext::State& state, const GlMesh::Implementation& mesh,
                   const PeelOptions& options)
    : state_(state), triangleCount_(mesh.triangleCount()), method_(options.method) {
  validate(options.pose);
  bounds_ = posedBox(mesh.bounds(), options.pose);
  auto& scratch = state_.scratch();
  scratch.posed.reserve(triangleCount_ * kBytesPerTriangle);
  scratch.normals.reserve(triangleCount_ * sizeof(GLuint));
  scratch.places.reserve(triangleCount_ * kBytesPerPolygon);
  const GlProgram& program = state_.programs().pose;
  program.use();
  glUniform4dv(program.at("pose"), 3, options.pose.data());
  inBatches(triangleCount_, [&](std::size_t first, std::size_t count) {
    mesh.triangles().bindPart(0, first * kBytesPerTriangle, count * kBytesPerTriangle);
    scratch.posed.bindPart(1, first * kBytesPerTriangle, count * kBytesPerTriangle);
    scratch.normals.bindPart(2, first * sizeof(GLuint), count * sizeof(GLuint));
    runOnTriangles(program, count);
  });
}

void GlPeeler::startFamily(const DexelGrid& grid, int axis) {
  const int u = (axis + 1) % 3, v = (axis + 2) % 3;
  auto& scratch = state_.scratch();
  const GlProgram& program = state_.programs().hull;
  program.use();
  glUniform2i(program.at("axes"), u, v);
  glUniform2d(program.at("firstLine"), static_cast<double>(grid.at(u, 0)),
              static_cast<double>(grid.at(v, 0)));
  glUniform1d(program.at("cell"), grid.cell());
  glUniform2i(program.at("lineCounts"), grid.width(axis), grid.height(axis));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  inBatches(triangleCount_, [&](std::size_t first, std::size_t count) {
    scratch.posed.bindPart(0, first * kBytesPerTriangle, count * kBytesPerTriangle);
    scratch.places.bindPart(1, first * kBytesPerPolygon, count * kBytesPerPolygon);
    runOnTriangles(program, count);
  });
  glMemoryBarrier(GL_VERTEX_ATTRIB_ARRAY_BARRIER_BIT | GL_SHADER_STORAGE_BARRIER_BIT);
}

void GlPeeler::draw(const GlProgram& program) const {
  auto& scratch = state_.scratch();
  program.use();
  glUniform2f(program.at("size"), static_cast<float>(band_->width), static_cast<float>(band_->rows));
  glUniform1f(program.at("firstRow"), static_cast<float>(band_->row));
  glUniform1ui(program.at("firstRowOfBand"), static_cast<GLuint>(band_->row));
  glUniform1ui(program.at("width"), static_cast<GLuint>(band_->width));
  glUniform3i(program.at("axes"), band_->axis, (band_->axis + 1) % 3, (band_->axis + 2) % 3);
  columns_->bind(1);
  rows_->bind(2);
  glBindFramebuffer(GL_FRAMEBUFFER, scratch.framebuffer);
  glFramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_WIDTH, band_->width);
  glFramebufferParameteri(GL_FRAMEBUFFER, GL_FRAMEBUFFER_DEFAULT_HEIGHT, band_->rows);
  glViewport(0, 0, band_->width, band_->rows);
  glDisable(GL_DEPTH_TEST);
  // Polygons are convex but for the rounding of their corners; where that turns a piece around, it goes.
  glEnable(GL_CULL_FACE);
  glBindVertexArray(scratch.vertexArray);
  glBindBuffer(GL_ARRAY_BUFFER, scratch.places.name());
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  const GLint firstTriangle = program.at("firstTriangle");
  inBatches(triangleCount_, [&](std::size_t first, std::size_t count) {
    glUniform1ui(firstTriangle, static_cast<GLuint>(first));
    scratch.posed.bindPart(0, first * kBytesPerTriangle, count * kBytesPerTriangle);
    glVertexAttribPointer(0, 2, GL_FLOAT, GL_FALSE, 2 * sizeof(float),
                          reinterpret_cast<const void*>(first * kBytesPerPolygon));
    glDrawElements(GL_TRIANGLES, static_cast<GLsizei>(count * kElementsPerTriangle), GL_UNSIGNED_INT,
                   nullptr);
  });
}

// scratch.counts, with a place for the last offset and one more behind it, becomes offsets, scratch.cursors a
// copy of them.
void GlPeeler::offsetsOfCounts(std::size_t lines) {
  auto& scratch = state_.scratch();
  scratch.cursors.reserve(lines * sizeof(GLuint));
  scratch.groupSums.reserve(((lines + 255) / 256 + 1) * sizeof(GLuint));
  scratch.counts.bind(4);
  scratch.groupSums.bind(5);
  GlDexelContext::State::runOnLines(state_.programs().scanCounts, lines);
  state_.scanGroups(lines);
  scratch.cursors.bind(6);
  GlDexelContext::State::runOnLines(state_.programs().offsets, lines);
  fragments_ = state_.countedOf(lines);
  longest_ = std::max<std::size_t>(kFewFragments, scratch.counts.readNumber(lines + 1));
  scratch.fragments.reserve(fragments_ * kBytesPerFragment);
}

void GlPeeler::sortFragments(std::size_t lines) {
  auto& scratch = state_.scratch();
  scratch.counts.bind(0);
  scratch.fragments.bind(1);
  const auto tellLongest = [&](const GlProgram& program) {
    program.use();
    glUniform1ui(program.at("longest"), static_cast<GLuint>(std::min(longest_, kFragmentsPerChunk)));
  };
  if (longest_ <= kFragmentsPerChunk) {
    tellLongest(state_.programs().sort);
    GlDexelContext::State::runOnLines(state_.programs().sort, lines);
    return;
  }
  const auto& programs = state_.longLinePrograms();
  const std::size_t chunks = fragments_ / kFragmentsPerChunk + lines;  // as kTakeChunk counts them
  tellLongest(programs.sortChunks);
  GlDexelContext::State::runOnItems(programs.sortChunks, lines, chunks);
  scratch.merged.reserve(fragments_ * kBytesPerFragment);
  for (std::size_t run = kFragmentsPerChunk; run < longest_; run *= 2) {
    programs.merge.use();
    glUniform1ui(programs.merge.at("run"), static_cast<GLuint>(run));
    scratch.fragments.bind(1);
    scratch.merged.bind(2);
    GlDexelContext::State::runOnItems(programs.merge, lines, chunks);
    std::swap(scratch.fragments, scratch.merged);
  }
}

void GlPeeler::gatherFragments(const GlBand& band) {
  auto& scratch = state_.scratch();
  const std::size_t lines = band.lines();
  scratch.counts.fill((lines + 2) * sizeof(GLuint), 0);
  scratch.counts.bind(3);
  draw(state_.programs().countFragments);
  offsetsOfCounts(lines);
  scratch.cursors.bind(3);
  scratch.fragments.bind(4);
  draw(state_.programs().gatherFragments);
  sortFragments(lines);
}

void GlPeeler::peelLayers(const GlBand& band) {
  auto& scratch = state_.scratch();
  const auto& programs = state_.programs();
  const std::size_t lines = band.lines(), bytes = lines * kBytesPerFragment;
  auto& layers = scratch.layers;
  const auto layerAt = [&](std::size_t i) -> GlBuffer& {
    if (i == layers.size()) layers.push_back(state_.newBuffer());
    return layers[i];
  };
  // Before all fragments is the layer 0, all zeros: no finite number's order is so small.
  layerAt(0).fill(bytes, 0);
  scratch.counts.fill((lines + 2) * sizeof(GLuint), 0);
  std::size_t count = 0;
  for (;;) {
    layerAt(count + 1).fill(bytes, std::numeric_limits<GLuint>::max());
    layers[count].bind(3);
    layers[count + 1].bind(4);
    draw(programs.nearestDepth);
    draw(programs.nearestTriangle);
    scratch.numbers.fill(sizeof(GLuint), 0);
    layers[count + 1].bind(3);
    scratch.counts.bind(4);
    scratch.numbers.bind(5);
    GlDexelContext::State::runOnLines(programs.takeLayer, lines);
    if (scratch.numbers.readNumber(0) == 0) break;
    ++count;
  }
  offsetsOfCounts(lines);
  scratch.counts.bind(0);
  scratch.fragments.bind(1);
  for (std::size_t i = 0; i < count; ++i) {
    layers[i + 1].bind(3);
    programs.placeLayer.use();
    glUniform1ui(programs.placeLayer.at("number"), static_cast<GLuint>(i));
    GlDexelContext::State::runOnLines(programs.placeLayer, lines);
  }
  layers.clear();  // as many as there are layers: too much to keep
}

void GlPeeler::fill(GlBand& band, const GlBuffer& columns, const GlBuffer& rows) {
  band_ = &band;
  columns_ = &columns;
  rows_ = &rows;
  if (method_ == PeelMethod::Layers)
    peelLayers(band);
  else
    gatherFragments(band);
  auto& scratch = state_.scratch();
  const std::size_t lines = band.lines();
  band.ends.reserve(fragments_ * kBytesPerEnd);
  scratch.counts.bind(0);
  scratch.fragments.bind(1);
  scratch.normals.bind(2);
  band.odd.bind(3);
  band.offsets.bind(4);
  scratch.groupSums.bind(5);
  band.ends.bind(6);
  // An item looks at each fragment once, and the loop over those at one depth ends once for each depth.
  const bool isLong = 18 * longest_ > kMostRounds;
  const auto run = [&](const GlProgram& program) {
    if (isLong)
      state_.runInParts(program, lines, longest_);
    else
      GlDexelContext::State::runOnLines(program, lines);
  };
  run(isLong ? state_.longLinePrograms().pairCount : state_.programs().pairCount);
  state_.scanGroups(lines);
  run(isLong ? state_.longLinePrograms().pairWrite : state_.programs().pairWrite);
  band.most = fragments_;
  band.longest = longest_;
}

}  // namespace restroke::points
