#pragma once
// An OpenGL context without a window. Internal to the OpenGL renderer; no OpenGL or EGL header is included
// here.

namespace restroke::points {

/// OpenGL 3.3 core through EGL, on Mesa's surfaceless platform. Contexts are independent of each other.
class EglContext {
 public:
  /// Throws InputError, with what EGL says, when there is no such context to be had.
  EglContext();
  ~EglContext();
  EglContext(const EglContext&) = delete;
  EglContext& operator=(const EglContext&) = delete;

  /// Makes the context current on the calling thread; what was current there before is so again at the end.
  class Current {
   public:
    explicit Current(const EglContext& context);
    ~Current();
    Current(const Current&) = delete;
    Current& operator=(const Current&) = delete;

   private:
    const EglContext& context_;
    void* formerDisplay_;
    void* formerContext_;
    void* formerDraw_;
    void* formerRead_;
    unsigned formerApi_;
  };

 private:
  void* display_ = nullptr;
  void* context_ = nullptr;
};

}  // namespace restroke::points
