#include "points/dexel/gl/gl_buffer.h"

#include <epoxy/gl.h>

#include <algorithm>
#include <utility>

#include "implicit/errors.h"
#include "points/images/gl_program.h"

namespace restroke::points {

void GlMemory::setAside(unsigned name) {
  const std::lock_guard lock(mutex_);
  names_.push_back(name);
}

void GlMemory::deleteWhatIsSetAside() {
  const std::lock_guard lock(mutex_);
  if (!names_.empty()) glDeleteBuffers(static_cast<GLsizei>(names_.size()), names_.data());
  names_.clear();
}

GlBuffer::~GlBuffer() {
  if (name_) memory_->setAside(name_);
}

void GlBuffer::swap(GlBuffer& other) noexcept {
  std::swap(memory_, other.memory_);
  std::swap(seen_, other.seen_);
  std::swap(name_, other.name_);
  std::swap(capacity_, other.capacity_);
}

void GlBuffer::reserve(std::size_t bytes) {
  if (name_ && bytes <= capacity_) return;
  // Half as much again, but not so much that shaders would not see it any more; of whole lines of memory.
  constexpr std::size_t kStep = 256;
  const auto rounded = [](std::size_t size) { return (size + kStep - 1) / kStep * kStep; };
  std::size_t size = rounded(std::max(kStep, bytes + bytes / 2));
  if (seen_ == Seen::Whole && size > memory_->largestBlock()) size = rounded(bytes);
  if (seen_ == Seen::Whole && size > memory_->largestBlock())
    throw InputError(fmt::format(
        "OpenGL: {} bytes are needed in one buffer; this driver's shaders see {} at most, so fewer lines or "
        "triangles are needed",
        size, memory_->largestBlock()));
  if (name_) glDeleteBuffers(1, &name_);
  name_ = 0;
  capacity_ = 0;
  glGenBuffers(1, &name_);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
  glBufferData(GL_SHADER_STORAGE_BUFFER, static_cast<GLsizeiptr>(size), nullptr, GL_DYNAMIC_COPY);
  checkGlErrors("these dexels");
  capacity_ = size;
}

void GlBuffer::write(const void* data, std::size_t bytes) {
  reserve(bytes);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
  if (bytes > 0) glBufferSubData(GL_SHADER_STORAGE_BUFFER, 0, static_cast<GLsizeiptr>(bytes), data);
}

void GlBuffer::fill(std::size_t bytes, std::uint32_t value) {
  reserve(bytes);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glClearBufferData(GL_SHADER_STORAGE_BUFFER, GL_R32UI, GL_RED_INTEGER, GL_UNSIGNED_INT, &value);
}

void GlBuffer::read(void* data, std::size_t offset, std::size_t bytes) const {
  RESTROKE_CHECK_LE(offset + bytes, capacity_);
  if (bytes == 0) return;
  glMemoryBarrier(GL_BUFFER_UPDATE_BARRIER_BIT);
  glBindBuffer(GL_SHADER_STORAGE_BUFFER, name_);
  glGetBufferSubData(GL_SHADER_STORAGE_BUFFER, static_cast<GLintptr>(offset), static_cast<GLsizeiptr>(bytes),
                     data);
}

std::uint32_t GlBuffer::readNumber(std::size_t index) const {
  std::uint32_t number = 0;
  read(&number, index * sizeof number, sizeof number);
  return number;
}

void GlBuffer::bind(unsigned binding) const {
  glBindBufferBase(GL_SHADER_STORAGE_BUFFER, binding, name_);
}

void GlBuffer::bindPart(unsigned binding, std::size_t offset, std::size_t bytes) const {
  RESTROKE_CHECK_LE(offset + bytes, capacity_);
  glBindBufferRange(GL_SHADER_STORAGE_BUFFER, binding, name_, static_cast<GLintptr>(offset),
                    static_cast<GLsizeiptr>(bytes));
}

}  // namespace restroke::points
