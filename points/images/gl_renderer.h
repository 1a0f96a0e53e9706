#pragma once
// Splats through OpenGL, without a display or a window (SPEC S7: the paper's depth buffer).

#include <memory>
#include <span>
#include <string>

#include "implicit/geometry/camera.h"
#include "points/images/image.h"
#include "points/images/scene.h"

namespace restroke::points {

/// An OpenGL 3.3 core context of its own, made through EGL (surfaceless), with the programs that draw discs.
/// On a machine without a graphics card Mesa's software driver serves.
///
/// Several renderers may exist in a process. One renderer may be used from any thread; calls wait for each
/// other. After a call the calling thread's former EGL context is current again. A thread on which a GLX
/// context is current cannot use it.
///
/// Results depend on the driver in their last bits: where that matters (retargeting), outcomes are recorded
/// (DESIGN invariant 5). How far the depths of CPU (cpu_renderer.h) and OpenGL agree, to which
/// tests/points/images_gl_test.cpp holds both: where they see the same disc, depths differ by at most
/// kGlDepthBound / c of the depth, c the cosine at which the disc is seen. At a disc's rim a pixel's centre
/// may be inside for one and outside for the other; such pixels, where coverage or the nearest disc differs,
/// are at most kGlRimPart of those covered.
class GlRenderer {
 public:
  /// Throws InputError when there is no EGL display or no OpenGL 3.3 context, with what EGL says.
  GlRenderer();
  ~GlRenderer();
  GlRenderer(GlRenderer&&) noexcept;
  GlRenderer& operator=(GlRenderer&&) noexcept;

  /// Depth of the nearest front-facing disc at each pixel's centre, read from a 32-bit float depth buffer
  /// that holds near / depth (so that precision is relative at any distance). The same discs as the CPU's
  /// renderDepth. Throws InputError when the camera is not valid, or its viewport larger than kMaxPixels or
  /// than the driver's limit.
  [[nodiscard]] DepthImage renderDepth(std::span<const Surfel> surfels, const Camera& camera);

  /// The colour picture in the look of the CPU's render: the same passes, lights and occlusion, with as many
  /// samples a pixel, rounded up to a square number at most 16. Errors as renderDepth, and options out of
  /// range.
  [[nodiscard]] ColorImage renderColor(const Scene& scene, const Camera& camera,
                                       const RenderOptions& options = {});

  /// The driver's name and version, for reports.
  [[nodiscard]] std::string driver() const;

 private:
  class Implementation;
  std::unique_ptr<Implementation> implementation_;
};

/// See GlRenderer. The depth bound is some 30 units in the last place of float32, measured 1.9e-6 with Mesa's
/// software driver on pictures of 1280 x 720 to 3000 x 2000; the part of the rims 3e-5 to 5e-5.
inline constexpr double kGlDepthBound = 3e-6;
inline constexpr double kGlRimPart = 1e-4;

}  // namespace restroke::points
