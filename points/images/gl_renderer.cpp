// The passes of cpu_renderer.cpp on the graphics card: nearest discs into a depth buffer, a sum over the
// discs close behind them, then shading. The depth buffer is 32-bit float, cleared to 0 (infinitely far) and
// filled with near / depth, which is what a plane makes linear on the screen and what float32 stores with the
// same relative precision near and far.

#include "points/images/gl_renderer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <limits>
#include <mutex>
#include <type_traits>
#include <vector>

#include "implicit/errors.h"
#include "points/images/egl_context.h"
#include "points/images/gl_program.h"
#include "points/images/gl_shaders.h"

namespace restroke::points {
namespace {

/// Textures of one size, drawn into together.
class Target {
 public:
  struct Layer {
    GLenum attachment, internal, format;
  };

  /// Makes or keeps the textures. The size is in pixels.
  void prepare(int width, int height, std::span<const Layer> layers) {
    if (!framebuffer_) glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    if (width == width_ && height == height_ && layers.size() == textures_.size()) return;
    release();
    glGenFramebuffers(1, &framebuffer_);
    glBindFramebuffer(GL_FRAMEBUFFER, framebuffer_);
    textures_.resize(layers.size());
    glGenTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
    for (std::size_t i = 0; i < layers.size(); ++i) {
      glBindTexture(GL_TEXTURE_2D, textures_[i]);
      glTexImage2D(GL_TEXTURE_2D, 0, static_cast<GLint>(layers[i].internal), width, height, 0,
                   layers[i].format, GL_FLOAT, nullptr);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MIN_FILTER, GL_NEAREST);
      glTexParameteri(GL_TEXTURE_2D, GL_TEXTURE_MAG_FILTER, GL_NEAREST);
      glFramebufferTexture2D(GL_FRAMEBUFFER, layers[i].attachment, GL_TEXTURE_2D, textures_[i], 0);
    }
    width_ = width;
    height_ = height;
    if (glCheckFramebufferStatus(GL_FRAMEBUFFER) != GL_FRAMEBUFFER_COMPLETE || glGetError() != GL_NO_ERROR) {
      release();
      throw InputError(
          fmt::format("OpenGL: the driver cannot draw into an image of {} x {} pixels", width, height));
    }
  }
  [[nodiscard]] GLuint texture(std::size_t i) const { return textures_[i]; }

 private:
  void release() {
    glDeleteTextures(static_cast<GLsizei>(textures_.size()), textures_.data());
    glDeleteFramebuffers(1, &framebuffer_);
    textures_.clear();
    framebuffer_ = 0;
    width_ = height_ = 0;
  }

  GLuint framebuffer_ = 0;
  std::vector<GLuint> textures_;
  int width_ = 0, height_ = 0;
};

constexpr Target::Layer kDepthLayer = {GL_DEPTH_ATTACHMENT, GL_DEPTH_COMPONENT32F, GL_DEPTH_COMPONENT};
constexpr Target::Layer kColorLayers[2] = {{GL_COLOR_ATTACHMENT0, GL_RGBA32F, GL_RGBA},
                                           {GL_COLOR_ATTACHMENT1, GL_RGBA32F, GL_RGBA}};

void setVector(GLint place, DVec3 v) {
  glUniform3f(place, static_cast<float>(v.x), static_cast<float>(v.y), static_cast<float>(v.z));
}

/// Side of the square of samples: as many as wanted, or the next square number.
int scaleFor(int samples) {
  int scale = 1;
  while (scale * scale < samples) ++scale;
  return scale;
}

}  // namespace

class GlRenderer::Implementation {
 public:
  Implementation() {
    const EglContext::Current current(context_);
    const std::string head = kGlslVersion + lookConstants(Look{});
    depth_ = GlProgram(head + kDiscVertexShader, head + kDiscFragmentHead + kDepthFragmentShader);
    blend_ = GlProgram(head + kDiscVertexShader, head + kDiscFragmentHead + kBlendFragmentShader);
    shade_ = GlProgram(head + kScreenVertexShader, head + kShadeFragmentShader);
    makeArrays();
    driver_ = glDriver();
    GLint viewport[2] = {};
    glGetIntegerv(GL_MAX_TEXTURE_SIZE, &largest_);
    glGetIntegerv(GL_MAX_VIEWPORT_DIMS, viewport);
    largest_ = std::min({largest_, viewport[0], viewport[1]});
  }

  DepthImage renderDepth(std::span<const Surfel> surfels, const Camera& camera) {
    validateForImage(camera, "depth image");
    const std::lock_guard lock(mutex_);
    const EglContext::Current current(context_);
    const int width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
    checkSize(width, height);
    upload({.surfels = surfels});
    const std::array layers = {kDepthLayer};
    depthTarget_.prepare(width, height, layers);
    glDrawBuffer(GL_NONE);
    glReadBuffer(GL_NONE);
    drawDepth(camera, width, height, surfels.size());
    DepthImage image;
    image.width = camera.width;
    image.height = camera.height;
    image.depth.resize(std::size_t{camera.width} * camera.height);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_DEPTH_COMPONENT, GL_FLOAT, image.depth.data());
    checkGlErrors("this picture");
    for (float& value : image.depth)
      value = value > 0.0f ? camera.near / value : std::numeric_limits<float>::infinity();
    return image;
  }

  ColorImage renderColor(const Scene& scene, const Camera& camera, const RenderOptions& options) {
    validateForImage(camera, "picture");
    validate(options, "picture");
    const std::lock_guard lock(mutex_);
    const EglContext::Current current(context_);
    const int scale = scaleFor(options.samples);
    const int width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
    checkSize(width * scale, height * scale);
    upload(scene);
    const std::array layers = {kDepthLayer, kColorLayers[0], kColorLayers[1]};
    blendTarget_.prepare(width * scale, height * scale, layers);
    glDrawBuffer(GL_NONE);
    drawDepth(camera, width * scale, height * scale, scene.surfels.size());
    blendDiscs(camera, width * scale, height * scale, scene.surfels.size());
    shadePicture(camera, options, scale);
    ColorImage image;
    image.width = camera.width;
    image.height = camera.height;
    image.rgba.resize(std::size_t{4} * camera.width * camera.height);
    glReadBuffer(GL_COLOR_ATTACHMENT0);
    glPixelStorei(GL_PACK_ALIGNMENT, 1);
    glReadPixels(0, 0, width, height, GL_RGBA, GL_FLOAT, image.rgba.data());
    checkGlErrors("this picture");
    return image;
  }

  [[nodiscard]] const std::string& driver() const { return driver_; }

 private:
  void makeArrays() {
    static_assert(std::is_standard_layout_v<Surfel>, "surfels are handed to OpenGL as they lie in memory");
    glGenVertexArrays(1, &discArray_);
    glGenVertexArrays(1, &emptyArray_);
    glGenBuffers(1, &surfelBuffer_);
    glGenBuffers(1, &kindBuffer_);
    glBindVertexArray(discArray_);
    glBindBuffer(GL_ARRAY_BUFFER, surfelBuffer_);
    const auto attribute = [](GLuint index, GLint count, std::size_t offset) {
      glEnableVertexAttribArray(index);
      glVertexAttribPointer(index, count, GL_FLOAT, GL_FALSE, sizeof(Surfel),
                            reinterpret_cast<const void*>(offset));
      glVertexAttribDivisor(index, 1);
    };
    attribute(0, 3, offsetof(Surfel, position));
    attribute(1, 3, offsetof(Surfel, normal));
    attribute(2, 1, offsetof(Surfel, radius));
    glBindBuffer(GL_ARRAY_BUFFER, kindBuffer_);
    glEnableVertexAttribArray(3);
    glVertexAttribPointer(3, 1, GL_UNSIGNED_BYTE, GL_FALSE, 1, nullptr);
    glVertexAttribDivisor(3, 1);
  }

  void checkSize(int width, int height) const {
    if (width > largest_ || height > largest_)
      throw InputError(fmt::format(
          "OpenGL: an image of {} x {} pixels (samples counted) is asked for; this driver's limit "
          "is {} a side",
          width, height, largest_));
  }

  void upload(const Scene& scene) {
    glBindBuffer(GL_ARRAY_BUFFER, surfelBuffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(scene.surfels.size_bytes()), scene.surfels.data(),
                 GL_STREAM_DRAW);
    kinds_.resize(scene.surfels.size());
    for (std::size_t i = 0; i < kinds_.size(); ++i)
      kinds_[i] = static_cast<std::uint8_t>(kindOf(scene, scene.surfels[i].primitive, scene.surfels[i].sign));
    glBindBuffer(GL_ARRAY_BUFFER, kindBuffer_);
    glBufferData(GL_ARRAY_BUFFER, static_cast<GLsizeiptr>(kinds_.size()), kinds_.data(), GL_STREAM_DRAW);
    checkGlErrors("this picture");
  }

  static void setCamera(const GlProgram& program, const Camera& camera, int width, int height) {
    const CameraFrame frame = frameOf(camera);
    setVector(program.at("eye"), frame.position);
    setVector(program.at("rightAxis"), frame.right);
    setVector(program.at("upAxis"), frame.up);
    setVector(program.at("forwardAxis"), frame.forward);
    glUniform2f(program.at("tangent"), static_cast<float>(frame.halfWidth),
                static_cast<float>(frame.halfHeight));
    glUniform2f(program.at("size"), static_cast<float>(width), static_cast<float>(height));
    glUniform2f(program.at("clip"), camera.near, camera.far);
  }

  void drawDiscs(std::size_t count) const {
    glBindVertexArray(discArray_);
    if (count > 0) glDrawArraysInstanced(GL_TRIANGLE_STRIP, 0, 4, static_cast<GLsizei>(count));
  }

  void drawDepth(const Camera& camera, int width, int height, std::size_t count) const {
    glViewport(0, 0, width, height);
    glDisable(GL_BLEND);
    glEnable(GL_DEPTH_TEST);
    glDepthMask(GL_TRUE);
    glDepthFunc(GL_GREATER);  // of equal ones the first stays
    glClearDepth(0.0);
    glClear(GL_DEPTH_BUFFER_BIT);
    depth_.use();
    setCamera(depth_, camera, width, height);
    drawDiscs(count);
  }

  void blendDiscs(const Camera& camera, int width, int height, std::size_t count) const {
    const std::array<GLenum, 2> buffers = {GL_COLOR_ATTACHMENT0, GL_COLOR_ATTACHMENT1};
    glDrawBuffers(2, buffers.data());
    // The depth texture is read by the shader, so it must not be attached while drawing.
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, 0, 0);
    glDisable(GL_DEPTH_TEST);
    glEnable(GL_BLEND);
    glBlendFunc(GL_ONE, GL_ONE);
    glClearColor(0, 0, 0, 0);
    glClear(GL_COLOR_BUFFER_BIT);
    glActiveTexture(GL_TEXTURE0);
    glBindTexture(GL_TEXTURE_2D, blendTarget_.texture(0));
    blend_.use();
    setCamera(blend_, camera, width, height);
    glUniform1i(blend_.at("nearest"), 0);
    drawDiscs(count);
    glFramebufferTexture2D(GL_FRAMEBUFFER, GL_DEPTH_ATTACHMENT, GL_TEXTURE_2D, blendTarget_.texture(0), 0);
  }

  void shadePicture(const Camera& camera, const RenderOptions& options, int scale) {
    const int width = static_cast<int>(camera.width), height = static_cast<int>(camera.height);
    const std::array layers = {kColorLayers[0]};
    pictureTarget_.prepare(width, height, layers);
    glDrawBuffer(GL_COLOR_ATTACHMENT0);
    glViewport(0, 0, width, height);
    glDisable(GL_BLEND);
    glDisable(GL_DEPTH_TEST);
    shade_.use();
    setCamera(shade_, camera, width, height);
    const char* const names[3] = {"nearest", "normals", "kinds"};
    for (int i = 0; i < 3; ++i) {
      glActiveTexture(GL_TEXTURE0 + static_cast<GLenum>(i));
      glBindTexture(GL_TEXTURE_2D, blendTarget_.texture(static_cast<std::size_t>(i)));
      glUniform1i(shade_.at(names[i]), i);
    }
    glUniform1i(shade_.at("scale"), scale);
    glUniform1i(shade_.at("occluded"), options.occlusion == Occlusion::ScreenSpace);
    glUniform3fv(shade_.at("baseColor"), 1, options.palette.base.data());
    glUniform3fv(shade_.at("addedColor"), 1, options.palette.added.data());
    glUniform3fv(shade_.at("carvedColor"), 1, options.palette.carved.data());
    glBindVertexArray(emptyArray_);
    glDrawArrays(GL_TRIANGLES, 0, 3);
    glActiveTexture(GL_TEXTURE0);
  }

  std::mutex mutex_;
  EglContext context_{GlVersion{.major = 3, .minor = 3}};  // everything below lives in it and is gone with it
  GlProgram depth_, blend_, shade_;
  Target depthTarget_, blendTarget_, pictureTarget_;
  GLuint discArray_ = 0, emptyArray_ = 0, surfelBuffer_ = 0, kindBuffer_ = 0;
  std::vector<std::uint8_t> kinds_;
  std::string driver_;
  GLint largest_ = 0;
};

GlRenderer::GlRenderer() : implementation_(std::make_unique<Implementation>()) {}
GlRenderer::~GlRenderer() = default;
GlRenderer::GlRenderer(GlRenderer&&) noexcept = default;
GlRenderer& GlRenderer::operator=(GlRenderer&&) noexcept = default;

DepthImage GlRenderer::renderDepth(std::span<const Surfel> surfels, const Camera& camera) {
  return implementation_->renderDepth(surfels, camera);
}

ColorImage GlRenderer::renderColor(const Scene& scene, const Camera& camera, const RenderOptions& options) {
  return implementation_->renderColor(scene, camera, options);
}

std::string GlRenderer::driver() const {
  return implementation_->driver();
}

}  // namespace restroke::points
