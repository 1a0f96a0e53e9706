// The Booleans are those of change_line.h, in two passes as sizes are not known before: count, sum up, write.
// What is written goes to buffers of its own, which then change places with the model's.

#include "points/dexel/gl/gl_tri_dexel.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <bit>
#include <cstring>

#include "implicit/errors.h"
#include "points/dexel/gl/gl_dexel_shaders.h"
#include "points/dexel/gl/gl_dexel_state.h"

namespace restroke::points {

namespace {

using Use = GlDexelContext::State::Use;

constexpr std::size_t kFewLinesPerBand = std::size_t{1} << 14, kManyLinesPerBand = std::size_t{1} << 20;
constexpr std::size_t kBytesPerEnd = 16;
static_assert(sizeof(SpanEnd) == kBytesPerEnd, "ends are handed to OpenGL as they lie in memory");

// As the shader numbers them.
GLuint numberOf(DexelOperation operation) {
  return operation == DexelOperation::Union ? 0 : operation == DexelOperation::Subtraction ? 1 : 2;
}

// Of lines with at most so many ends: do the loops stay short? Of a line's ends each is given out or skipped
// once; of the tool's each pair goes round three loops, the last round of each included.
bool combinesAtOnce(std::size_t ends, std::size_t toolEnds) {
  return 17 * ends + 2 * toolEnds <= kMostRounds;
}

}  // namespace

GlTriDexel::Implementation::Implementation(std::shared_ptr<GlDexelContext::State> state,
                                           const DexelGrid& grid, Options options)
    : state_(std::move(state)), grid_(grid) {
  if (options.linesPerBand && (*options.linesPerBand < 1 || *options.linesPerBand > kMostLinesPerBand))
    throw InputError(fmt::format("a band shall have {} lines; it must be 1 to {}", *options.linesPerBand,
                                 kMostLinesPerBand));
  const Use use(*state_);
  for (int axis = 0; axis < 3; ++axis) {
    const int width = grid.width(axis), height = grid.height(axis);
    if (width > state_->widest())
      throw InputError(fmt::format("OpenGL: the grid has {} lines in a row; this driver's limit is {}", width,
                                   state_->widest()));
    if (width == 0 || height == 0) continue;
    const std::size_t lines = options.linesPerBand.value_or(
        std::clamp(static_cast<std::size_t>(width) * static_cast<std::size_t>(height) / 8, kFewLinesPerBand,
                   kManyLinesPerBand));
    const auto rows = static_cast<int>(std::clamp<std::size_t>(lines / static_cast<std::size_t>(width), 1,
                                                               static_cast<std::size_t>(state_->widest())));
    for (int row = 0; row < height; row += rows) {
      bands_.push_back({axis, row, std::min(rows, height - row), width, state_->newBuffer(),
                        state_->newBuffer(), state_->newBuffer()});
      clear(bands_.back());
    }
  }
  std::vector<float> points;
  for (int axis = 0; axis < 3; ++axis) {
    points.clear();
    for (int i = 0; i < grid.counts()[static_cast<std::size_t>(axis)]; ++i)
      points.push_back(grid.at(axis, i));
    coordinates_.push_back(state_->newBuffer());
    coordinates_.back().write(points.data(), points.size() * sizeof(float));
  }
  checkGlErrors("these dexels");
}

void GlTriDexel::Implementation::clear(GlBand& band) {
  band.offsets.fill((band.lines() + 1) * sizeof(GLuint), 0);
  band.ends.reserve(0);
  band.most = 0;
  band.longest = 0;
}

void GlTriDexel::Implementation::upload(const TriDexel& model) {
  RESTROKE_CHECK_EQ(grid_ == model.grid(), true);
  if (model.keepsHistory())
    throw InputError(
        "OpenGL: the model keeps which operations changed its lines, and OpenGL does not note them; it must "
        "be changed on the CPU");
  const Use use(*state_);
  operations_ = model.family(0).keepsOperations();
  std::vector<GLuint> offsets;
  LineEnds ends, line;
  for (GlBand& band : bands_) {
    const Dexels& dexels = model.family(band.axis);
    const std::size_t first = dexels.lineAt(0, band.row);
    offsets.assign(1, 0);
    ends.clear();
    band.longest = 0;
    for (std::size_t i = 0; i < band.lines(); ++i) {
      dexels.read(first + i, line);
      ends.insert(ends.end(), line.begin(), line.end());
      offsets.push_back(static_cast<GLuint>(ends.size()));
      band.longest = std::max(band.longest, line.size());
    }
    band.offsets.write(offsets.data(), offsets.size() * sizeof offsets[0]);
    band.ends.write(ends.data(), ends.size() * kBytesPerEnd);
    band.most = ends.size();
  }
  checkGlErrors("these dexels");
}

TriDexel GlTriDexel::Implementation::download() const {
  TriDexel model(grid_, {.operations = operations_});
  const Use use(*state_);
  std::vector<GLuint> offsets;
  LineEnds ends;
  for (const GlBand& band : bands_) {
    if (band.most == 0) continue;
    Dexels& dexels = model.family(band.axis);
    const std::size_t first = dexels.lineAt(0, band.row);
    offsets.resize(band.lines() + 1);
    band.offsets.read(offsets.data(), 0, offsets.size() * sizeof offsets[0]);
    ends.resize(offsets.back());
    band.ends.read(ends.data(), 0, ends.size() * kBytesPerEnd);
    for (std::size_t i = 0; i < band.lines(); ++i)
      if (offsets[i] < offsets[i + 1])
        dexels.write(first + i, std::span(ends).subspan(offsets[i], offsets[i + 1] - offsets[i]));
  }
  checkGlErrors("these dexels");
  return model;
}

void GlTriDexel::Implementation::apply(const Implementation& tool, DexelOperation operation, OperationId id) {
  RESTROKE_CHECK_EQ(grid_ == tool.grid_, true);
  RESTROKE_CHECK_EQ(state_ == tool.state_, true);
  const Use use(*state_);
  GlDexelContext::State::Scratch& scratch = state_->scratch();
  const auto& programs = state_->programs();
  RESTROKE_CHECK_EQ(bands_.size(), tool.bands_.size());
  for (std::size_t i = 0; i < bands_.size(); ++i) {
    GlBand& band = bands_[i];
    const GlBand& other = tool.bands_[i];
    RESTROKE_CHECK_EQ(other.lines(), band.lines());
    if (operation == DexelOperation::Union
            ? other.most == 0
            : band.most == 0 || (other.most == 0 && operation == DexelOperation::Subtraction))
      continue;
    const std::size_t lines = band.lines();
    // No operation makes more ends than both have: each border of a stretch is one of the tool's ends.
    std::size_t most = band.most + other.most;
    if (most * kBytesPerEnd > scratch.ends.capacity())
      most = std::size_t{band.offsets.readNumber(lines)} + other.offsets.readNumber(lines);
    scratch.ends.reserve(most * kBytesPerEnd);
    scratch.offsets.reserve((lines + 1) * sizeof(GLuint));
    scratch.groupSums.reserve(((lines + 255) / 256 + 1) * sizeof(GLuint));
    std::size_t longest = band.longest, toolLongest = other.longest;
    if (!combinesAtOnce(longest, toolLongest)) {
      longest = state_->longestOf(band);
      toolLongest = state_->longestOf(other);
    }
    const bool isLong = !combinesAtOnce(longest, toolLongest);
    const GlProgram& count = isLong ? state_->longLinePrograms().combineCount : programs.combineCount;
    const GlProgram& write = isLong ? state_->longLinePrograms().combineWrite : programs.combineWrite;
    band.offsets.bind(0);
    band.ends.bind(1);
    other.offsets.bind(2);
    other.ends.bind(3);
    scratch.offsets.bind(4);
    scratch.groupSums.bind(5);
    scratch.ends.bind(6);
    for (const GlProgram* program : {&count, &write}) {
      program->use();
      glUniform1ui(program->at("operation"), numberOf(operation));
      glUniform1ui(program->at("operationId"), static_cast<GLuint>(id));
    }
    const auto run = [&](const GlProgram& program) {
      if (isLong)
        state_->runInParts(program, lines, longest + toolLongest);
      else
        GlDexelContext::State::runOnLines(program, lines);
    };
    run(count);
    state_->scanGroups(lines);
    run(write);
    std::swap(band.offsets, scratch.offsets);
    std::swap(band.ends, scratch.ends);
    band.most = most;
    band.longest = longest + toolLongest;
  }
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  checkGlErrors("these dexels");
}

void GlTriDexel::Implementation::peel(const GlMesh::Implementation& mesh, const PeelOptions& options) {
  RESTROKE_CHECK_EQ(state_ == mesh.state(), true);
  const Use use(*state_);
  GlPeeler peeler(*state_, mesh, options);
  int axis = -1;
  for (GlBand& band : bands_) {
    clear(band);
    band.odd.fill((band.lines() + 31) / 32 * sizeof(GLuint), 0);
    const auto meets = [&](int a, int first, int last) {
      return grid_.at(a, first) <= peeler.bounds().max[a] && grid_.at(a, last) >= peeler.bounds().min[a];
    };
    const int u = (band.axis + 1) % 3, v = (band.axis + 2) % 3;
    if (peeler.bounds().empty() || !meets(u, 0, band.width - 1) ||
        !meets(v, band.row, band.row + band.rows - 1))
      continue;
    if (axis != band.axis) peeler.startFamily(grid_, axis = band.axis);
    peeler.fill(band, coordinates_[static_cast<std::size_t>(u)], coordinates_[static_cast<std::size_t>(v)]);
  }
  checkGlErrors("these dexels");
}

OddLines GlTriDexel::Implementation::oddLines() const {
  OddLines odd;
  const Use use(*state_);
  std::vector<GLuint> bits;
  for (const GlBand& band : bands_) {
    if (band.odd.capacity() == 0) continue;
    bits.resize((band.lines() + 31) / 32);
    band.odd.read(bits.data(), 0, bits.size() * sizeof bits[0]);
    for (std::size_t word = 0; word < bits.size(); ++word)
      for (GLuint rest = bits[word]; rest != 0; rest &= rest - 1) {
        const int line = static_cast<int>(32 * word) + std::countr_zero(rest);
        if (odd.count++ < OddLines::kPlaces)
          odd.first.push_back({band.axis, line % band.width, band.row + line / band.width});
      }
  }
  return odd;
}

std::size_t GlTriDexel::Implementation::endCount() const {
  const Use use(*state_);
  std::size_t count = 0;
  for (const GlBand& band : bands_) count += band.offsets.readNumber(band.lines());
  return count;
}

std::size_t GlTriDexel::Implementation::bytes() const {
  std::size_t bytes = 0;
  for (const GlBand& band : bands_)
    bytes += band.offsets.capacity() + band.ends.capacity() + band.odd.capacity();
  for (const GlBuffer& buffer : coordinates_) bytes += buffer.capacity();
  return bytes;
}

GlTriDexel::GlTriDexel(const GlDexelContext& context, const DexelGrid& grid, Options options)
    : implementation_(std::make_unique<Implementation>(context.state(), grid, options)) {}
GlTriDexel::~GlTriDexel() = default;
GlTriDexel::GlTriDexel(GlTriDexel&&) noexcept = default;
GlTriDexel& GlTriDexel::operator=(GlTriDexel&&) noexcept = default;

const DexelGrid& GlTriDexel::grid() const {
  return implementation_->grid();
}
void GlTriDexel::upload(const TriDexel& model) {
  implementation_->upload(model);
}
TriDexel GlTriDexel::download() const {
  return implementation_->download();
}
void GlTriDexel::apply(const GlTriDexel& tool, DexelOperation operation, OperationId id) {
  implementation_->apply(*tool.implementation_, operation, id);
}
void GlTriDexel::peel(const GlMesh& mesh, const PeelOptions& options) {
  implementation_->peel(mesh.implementation(), options);
}
OddLines GlTriDexel::oddLines() const {
  return implementation_->oddLines();
}
std::size_t GlTriDexel::endCount() const {
  return implementation_->endCount();
}
std::size_t GlTriDexel::bytes() const {
  return implementation_->bytes();
}

PeeledModel peel(const GlDexelContext& context, const TriangleMesh& mesh, const DexelGrid& grid,
                 const PeelOptions& options) {
  GlTriDexel model(context, grid);
  model.peel(GlMesh(context, mesh), options);
  return {model.download(), model.oddLines()};
}

}  // namespace restroke::points
