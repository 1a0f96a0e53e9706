#include <epoxy/gl.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "implicit/errors.h"
#include "points/dexel/gl/gl_dexel_shaders.h"
#include "points/dexel/gl/gl_dexel_state.h"
#include "points/dexel/gl/gl_drawing.h"
#include "points/dexel/gl/gl_peeling_shaders.h"
#include "points/dexel/gl/gl_sort_shaders.h"

namespace restroke::points {

namespace {

std::string text(std::initializer_list<const char*> pieces) {
  std::string all = kDexelHead;
  for (const char* piece : pieces) all += piece;
  return all;
}

constexpr const char* kWrites = "#define WRITES\n";
constexpr const char* kSecond = "#define SECOND\n";
constexpr const char* kPartsDefined = "#define PARTS\n";
constexpr const char* kChunks = "#define CHUNKS\n";

GlProgram compute(std::initializer_list<const char*> pieces) {
  return GlProgram(text(pieces));
}

}  // namespace

GlDexelContext::State::State() {
  const EglContext::Current current(context_);
  GLint64 block = 0;
  glGetInteger64v(GL_MAX_SHADER_STORAGE_BLOCK_SIZE, &block);
  memory_ = std::make_shared<GlMemory>(static_cast<std::size_t>(block));
  GLint viewport[2] = {}, framebuffer[2] = {};
  glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
  glGetIntegerv(GL_MAX_FRAMEBUFFER_WIDTH, &framebuffer[0]);
  glGetIntegerv(GL_MAX_FRAMEBUFFER_HEIGHT, &framebuffer[1]);
  widest_ = std::min({viewport[0], viewport[1], framebuffer[0], framebuffer[1]});
  driver_ = glDriver();
  const auto drawing = [](std::initializer_list<const char*> pieces) {
    return GlProgram(text({kPeelVertexMain}), text(pieces));
  };
  programs_ = {
      .scanCounts = compute({kLineItems, kScan, kScanCountsMain}),
      .scanGroups = compute({kLineItems, kScan, kScanGroupsMain}),
      .offsets = compute({kLineItems, kTakeOffset, kOffsetsMain}),
      .combineCount = compute({kLineItems, kScan, kCombine}),
      .combineWrite = compute({kWrites, kLineItems, kTakeOffset, kBaseOf, kCombine}),
      .pose = compute({kPoseMain}),
      .hull = compute({kHullMain}),
      .countFragments = drawing({kPeelFragment, kCountFragmentsMain}),
      .gatherFragments = drawing({kPeelFragment, kGatherFragmentsMain}),
      .nearestDepth = drawing({kPeelFragment, kLayerMain}),
      .nearestTriangle = drawing({kSecond, kPeelFragment, kLayerMain}),
      .takeLayer = compute({kLineItems, kTakeLayerMain}),
      .placeLayer = compute({kLineItems, kPlaceLayerMain}),
      .sort = compute({kLineItems, kSortHead, kSortMain}),
      .pairCount = compute({kLineItems, kScan, kPairMain}),
      .pairWrite = compute({kWrites, kLineItems, kTakeOffset, kBaseOf, kPairMain}),
  };
  const auto buffer = [&] { return newBuffer(); };
  scratch_ = std::make_unique<Scratch>(Scratch{.offsets = buffer(),
                                               .ends = buffer(),
                                               .groupSums = buffer(),
                                               .posed = newBuffer(GlBuffer::Seen::InParts),
                                               .places = newBuffer(GlBuffer::Seen::InParts),
                                               .normals = buffer(),
                                               .counts = buffer(),
                                               .cursors = buffer(),
                                               .fragments = buffer(),
                                               .numbers = buffer(),
                                               .merged = buffer(),
                                               .states = buffer(),
                                               .layers = {}});
  makeDrawing();
  checkGlErrors("the programs for dexels");
}

void GlDexelContext::State::makeDrawing() {
  // The same for each batch of triangles: seven corners, and five triangles about the first of them.
  std::vector<std::uint32_t> elements;
  elements.reserve(kTrianglesPerBatch * kElementsPerTriangle);
  for (std::uint32_t triangle = 0; triangle < kTrianglesPerBatch; ++triangle)
    for (std::uint32_t corner = 1; corner + 1 < kCornersPerTriangle; ++corner)
      for (const std::uint32_t k : {0u, corner, corner + 1})
        elements.push_back(triangle * static_cast<std::uint32_t>(kCornersPerTriangle) + k);
  glGenFramebuffers(1, &scratch_->framebuffer);
  glGenVertexArrays(1, &scratch_->vertexArray);
  glGenBuffers(1, &scratch_->elements);
  glBindVertexArray(scratch_->vertexArray);
  glBindBuffer(GL_ELEMENT_ARRAY_BUFFER, scratch_->elements);
  glBufferData(GL_ELEMENT_ARRAY_BUFFER, static_cast<GLsizeiptr>(elements.size() * sizeof elements[0]),
               elements.data(), GL_STATIC_DRAW);
  glEnableVertexAttribArray(0);
}

GlDexelContext::State::Use::Use(State& state) : lock_(state.mutex_), current_(state.context_) {
  state.memory_->deleteWhatIsSetAside();
}

const GlDexelContext::State::LongLinePrograms& GlDexelContext::State::longLinePrograms() {
  if (!longLinePrograms_) {
    longLinePrograms_ = std::make_unique<const LongLinePrograms>(LongLinePrograms{
        .longest = compute({kLineItems, kLongestMain}),
        .sortChunks = compute({kChunks, kLineItems, kSortHead, kTakeChunk, kSortMain}),
        .merge = compute({kLineItems, kSortHead, kTakeChunk, kMergeMain}),
        .combineCount = compute({kPartsDefined, kLineItems, kParts, kScan, kCombine}),
        .combineWrite = compute({kPartsDefined, kWrites, kLineItems, kParts, kTakeOffset, kBaseOf, kCombine}),
        .pairCount = compute({kPartsDefined, kLineItems, kParts, kScan, kPairMain}),
        .pairWrite = compute({kPartsDefined, kWrites, kLineItems, kParts, kTakeOffset, kBaseOf, kPairMain}),
    });
    checkGlErrors("the programs for long dexels");
  }
  return *longLinePrograms_;
}

void GlDexelContext::State::runInParts(const GlProgram& program, std::size_t lines, std::size_t work) {
  scratch_->states.reserve(lines * kBytesPerState);
  scratch_->states.bind(7);
  program.use();
  const GLint goesOn = program.at("goesOn");
  // A part may begin with what the last one ended with.
  for (std::size_t done = 0; done <= work + 1; done += kWorkPerPart - 1) {
    glUniform1ui(goesOn, done > 0 ? 1 : 0);
    runOnLines(program, lines);
  }
}

std::size_t GlDexelContext::State::longestOf(const GlBand& band) {
  scratch_->numbers.fill(sizeof(GLuint), 0);
  band.offsets.bind(0);
  scratch_->numbers.bind(5);
  runOnLines(longLinePrograms().longest, band.lines());
  return scratch_->numbers.readNumber(0);
}

void GlDexelContext::State::runOnItems(const GlProgram& program, std::size_t lines, std::size_t items) {
  constexpr std::size_t kGroup = 256;
  program.use();
  glUniform1ui(program.at("lineCount"), static_cast<GLuint>(lines));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glDispatchCompute(static_cast<GLuint>((items + kGroup - 1) / kGroup), 1, 1);
}

void GlDexelContext::State::scanGroups(std::size_t lines) {
  scratch_->groupSums.bind(5);
  const GlProgram& program = programs_.scanGroups;
  program.use();
  glUniform1ui(program.at("lineCount"), static_cast<GLuint>(lines));
  glMemoryBarrier(GL_SHADER_STORAGE_BARRIER_BIT);
  glDispatchCompute(1, 1, 1);
}

std::size_t GlDexelContext::State::countedOf(std::size_t lines) const {
  return scratch_->groupSums.readNumber((lines + 255) / 256);
}

GlDexelContext::GlDexelContext() : state_(std::make_shared<State>()) {}

const std::string& GlDexelContext::driver() const {
  return state_->driver();
}

GlMesh::Implementation::Implementation(std::shared_ptr<GlDexelContext::State> state, const TriangleMesh& mesh)
    : state_(std::move(state)),
      triangleCount_(mesh.triangles.size()),
      triangles_(state_->newBuffer(GlBuffer::Seen::InParts)) {
  if (triangleCount_ > kMostGlTriangles)
    throw InputError(fmt::format("the mesh has {} triangles; {} at most can be drawn into dexels",
                                 triangleCount_, kMostGlTriangles));
  std::vector<float> corners;
  corners.reserve(9 * triangleCount_);
  for (std::size_t t = 0; t < triangleCount_; ++t)
    for (const std::uint32_t v : mesh.triangles[t]) {
      RESTROKE_CHECK_LT(v, mesh.vertices.size());
      for (int k = 0; k < 3; ++k) {
        const float x = mesh.vertices[v][k];
        if (!std::isfinite(x))
          throw InputError(
              fmt::format("a corner of triangle {} has the coordinate {}; coordinates must be finite", t, x));
        corners.push_back(x);
      }
    }
  bounds_ = boundsOf(mesh);
  const GlDexelContext::State::Use use(*state_);
  triangles_.write(corners.data(), corners.size() * sizeof(float));
  checkGlErrors("this mesh");
}

GlMesh::GlMesh(const GlDexelContext& context, const TriangleMesh& mesh)
    : implementation_(std::make_unique<Implementation>(context.state(), mesh)) {}
GlMesh::~GlMesh() = default;
GlMesh::GlMesh(GlMesh&&) noexcept = default;
GlMesh& GlMesh::operator=(GlMesh&&) noexcept = default;

}  // namespace restroke::points
