#pragma once
// Programs and errors of OpenGL. Internal to what draws or computes with OpenGL; no OpenGL header is included
// here. Everything needs a current context (egl_context.h).

#include <string>

namespace restroke::points {

/// A linked program. Deleted with its context. Throws InternalError, with the driver's words, when a source
/// does not compile or the program does not link.
class GlProgram {
 public:
  GlProgram() = default;
  GlProgram(const std::string& vertex, const std::string& fragment);
  /// OpenGL 4.3.
  explicit GlProgram(const std::string& compute);
  void use() const;
  /// Location of a uniform, -1 where the program has none of that name.
  [[nodiscard]] int at(const char* name) const;

 private:
  unsigned program_ = 0;
};

/// Out of memory is the machine's: InputError, with what it was for. Anything else is our mistake:
/// InternalError.
void checkGlErrors(const char* purpose);

/// The driver's name and version, for reports.
[[nodiscard]] std::string glDriver();

}  // namespace restroke::points
