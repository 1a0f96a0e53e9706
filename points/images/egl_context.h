#pragma once
// An OpenGL context without a window. Internal to what draws or computes with OpenGL; no OpenGL or EGL header
// is included here.

namespace restroke::points {

/// A version of OpenGL, core profile.
struct GlVersion {
  int major = 3, minor = 3;
};

/// OpenGL core through EGL, on Mesa's surfaceless platform. Contexts are independent of each other.
class EglContext {
 public:
  /// A context of this version or one compatible with it. Throws InputError, with what EGL says, when there
  /// is no such context to be had.
  explicit EglContext(GlVersion version);
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// What EGL knows of the calling thread, as it is put back at the end; a thread that had no context keeps
  /// nothing of EGL's.
  class ThreadState {
   public:
    ThreadState();
    ~ThreadState();
    ThreadState(const ThreadState&) = delete;
    ThreadState& operator=(const ThreadState&) = delete;

   private:
    unsigned api_;
    void *display_, *context_, *draw_, *read_;
  };

  /// Makes the context current on the calling thread; what was current there before is so again at the end.
  class Current {
   public:
    explicit Current(const EglContext& context);

   private:
    ThreadState former_;
  };

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace restroke::points
