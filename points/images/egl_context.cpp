#include "points/images/egl_context.h"

#include <epoxy/egl.h>

#include <mutex>

#include "implicit/errors.h"

namespace restroke::points {
namespace {

[[noreturn]] void fail(const char* step) {
  throw InputError(fmt::format(
      "OpenGL: {} failed (EGL error 0x{:04x}); an OpenGL 3.3 driver for EGL is needed, for instance "
      "Mesa's software driver (libgl1-mesa-dri)",
      step, static_cast<unsigned>(eglGetError())));
}

/// One display serves all contexts of the process; it is never terminated, since that would end them all.
EGLDisplay sharedDisplay() {
  static std::mutex mutex;
  static EGLDisplay display = EGL_NO_DISPLAY;
  const std::lock_guard lock(mutex);
  if (display != EGL_NO_DISPLAY) return display;
  if (!epoxy_has_egl_extension(EGL_NO_DISPLAY, "EGL_MESA_platform_surfaceless"))
    throw InputError(
        "OpenGL: this EGL has no surfaceless platform (EGL_MESA_platform_surfaceless), which drawing without "
        "a "
        "display needs");
  const EGLDisplay candidate = eglGetPlatformDisplayEXT(EGL_PLATFORM_SURFACELESS_MESA, nullptr, nullptr);
  if (candidate == EGL_NO_DISPLAY) fail("eglGetPlatformDisplay");
  EGLint major = 0, minor = 0;
  if (!eglInitialize(candidate, &major, &minor)) fail("eglInitialize");
  if (!epoxy_has_egl_extension(candidate, "EGL_KHR_surfaceless_context"))
    throw InputError(
        "OpenGL: this EGL cannot make a context current without a surface (EGL_KHR_surfaceless_context)");
  return display = candidate;
}

}  // namespace

EglContext::EglContext() : display_(sharedDisplay()) {
  // The API that eglCreateContext makes contexts of is a state of the thread.
  const EGLenum formerApi = eglQueryAPI();
  if (!eglBindAPI(EGL_OPENGL_API)) fail("eglBindAPI");
  const EGLint configAttributes[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display_, configAttributes, &config, 1, &count) || count < 1) fail("eglChooseConfig");
  const EGLint contextAttributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                      3,
                                      EGL_CONTEXT_MINOR_VERSION,
                                      3,
                                      EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                      EGL_NONE};
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, contextAttributes);
  const bool made = context_ != EGL_NO_CONTEXT;
  if (!made) {
    eglBindAPI(formerApi);
    fail("eglCreateContext");
  }
  eglBindAPI(formerApi);
}

EglContext::~EglContext() {
  if (context_) eglDestroyContext(display_, context_);
}

EglContext::Current::Current(const EglContext& context) : context_(context), formerApi_(eglQueryAPI()) {
  if (!eglBindAPI(EGL_OPENGL_API)) fail("eglBindAPI");
  formerDisplay_ = eglGetCurrentDisplay();
  formerContext_ = eglGetCurrentContext();
  formerDraw_ = eglGetCurrentSurface(EGL_DRAW);
  formerRead_ = eglGetCurrentSurface(EGL_READ);
  if (!eglMakeCurrent(context.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_)) {
    eglBindAPI(formerApi_);
    fail("eglMakeCurrent");
  }
}

EglContext::Current::~Current() {
  if (formerContext_ != EGL_NO_CONTEXT)
    eglMakeCurrent(formerDisplay_, formerDraw_, formerRead_, formerContext_);
  else
    eglMakeCurrent(context_.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, EGL_NO_CONTEXT);
  eglBindAPI(formerApi_);
}

}  // namespace restroke::points
