#include "points/images/egl_context.h"

#include <epoxy/egl.h>

#include <mutex>

#include "implicit/errors.h"

namespace restroke::points {
namespace {

[[noreturn]] void fail(const char* step) {
  throw InputError(
      fmt::format("OpenGL: {} failed (EGL error 0x{:04x}); an OpenGL driver for EGL is needed, for instance "
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

EglContext::EglContext(GlVersion version) : display_(sharedDisplay()) {
  const ThreadState former;
  const EGLint configAttributes[] = {EGL_SURFACE_TYPE, 0, EGL_RENDERABLE_TYPE, EGL_OPENGL_BIT, EGL_NONE};
  EGLConfig config = nullptr;
  EGLint count = 0;
  if (!eglChooseConfig(display_, configAttributes, &config, 1, &count) || count < 1) fail("eglChooseConfig");
  const EGLint contextAttributes[] = {EGL_CONTEXT_MAJOR_VERSION,
                                      version.major,
                                      EGL_CONTEXT_MINOR_VERSION,
                                      version.minor,
                                      EGL_CONTEXT_OPENGL_PROFILE_MASK,
                                      EGL_CONTEXT_OPENGL_CORE_PROFILE_BIT,
                                      EGL_NONE};
  context_ = eglCreateContext(display_, config, EGL_NO_CONTEXT, contextAttributes);
  if (context_ == EGL_NO_CONTEXT)
    fail(fmt::format("making an OpenGL {}.{} core context", version.major, version.minor).c_str());
}

EglContext::~EglContext() {
  if (context_) eglDestroyContext(display_, context_);
}

EglContext::ThreadState::ThreadState()
    : api_(eglQueryAPI()),
      display_(eglGetCurrentDisplay()),
      context_(eglGetCurrentContext()),
      draw_(eglGetCurrentSurface(EGL_DRAW)),
      read_(eglGetCurrentSurface(EGL_READ)) {
  // The API that eglCreateContext makes contexts of is a state of the thread.
  if (!eglBindAPI(EGL_OPENGL_API)) fail("eglBindAPI");
}

EglContext::ThreadState::~ThreadState() {
  if (context_ != EGL_NO_CONTEXT) {
    eglMakeCurrent(display_, draw_, read_, context_);
    eglBindAPI(api_);
    return;
  }
  // libEGL would free what it keeps for this thread both when the thread ends and when the process does, and
  // where those come together it frees it twice (libglvnd 1.6).
  eglReleaseThread();
  if (api_ != eglQueryAPI()) eglBindAPI(api_);
}

EglContext::Current::Current(const EglContext& context) {
  if (!eglMakeCurrent(context.display_, EGL_NO_SURFACE, EGL_NO_SURFACE, context.context_))
    fail("eglMakeCurrent");
}

}  // namespace restroke::points
