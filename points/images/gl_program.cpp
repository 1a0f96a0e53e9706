#include "points/images/gl_program.h"

#include <epoxy/gl.h>

#include <array>
#include <initializer_list>

#include "implicit/errors.h"

namespace restroke::points {
namespace {

GLuint compile(GLenum type, const std::string& source) {
  const GLuint shader = glCreateShader(type);
  const char* const text = source.c_str();
  glShaderSource(shader, 1, &text, nullptr);
  glCompileShader(shader);
  GLint good = 0;
  glGetShaderiv(shader, GL_COMPILE_STATUS, &good);
  if (good) return shader;
  std::array<char, 2048> log{};
  glGetShaderInfoLog(shader, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw InternalError(fmt::format("OpenGL: a shader does not compile: {}", log.data()));
}

GLuint link(std::initializer_list<GLuint> shaders) {
  const GLuint program = glCreateProgram();
  for (const GLuint shader : shaders) {
    glAttachShader(program, shader);
    glDeleteShader(shader);
  }
  glLinkProgram(program);
  GLint good = 0;
  glGetProgramiv(program, GL_LINK_STATUS, &good);
  if (good) return program;
  std::array<char, 2048> log{};
  glGetProgramInfoLog(program, static_cast<GLsizei>(log.size()), nullptr, log.data());
  throw InternalError(fmt::format("OpenGL: a program does not link: {}", log.data()));
}

}  // namespace

GlProgram::GlProgram(const std::string& vertex, const std::string& fragment)
    : program_(link({compile(GL_VERTEX_SHADER, vertex), compile(GL_FRAGMENT_SHADER, fragment)})) {}

GlProgram::GlProgram(const std::string& compute) : program_(link({compile(GL_COMPUTE_SHADER, compute)})) {}

void GlProgram::use() const {
  glUseProgram(program_);
}

int GlProgram::at(const char* name) const {
  return glGetUniformLocation(program_, name);
}

void checkGlErrors(const char* purpose) {
  const GLenum error = glGetError();
  if (error == GL_OUT_OF_MEMORY)
    throw InputError(fmt::format("OpenGL: the driver has not enough memory for {}", purpose));
  if (error != GL_NO_ERROR) throw InternalError(fmt::format("OpenGL: error 0x{:04x}", error));
}

std::string glDriver() {
  const auto text = [](GLenum name) {
    const GLubyte* const bytes = glGetString(name);
    return std::string(bytes ? reinterpret_cast<const char*>(bytes) : "?");
  };
  return text(GL_RENDERER) + ", OpenGL " + text(GL_VERSION);
}

}  // namespace restroke::points
