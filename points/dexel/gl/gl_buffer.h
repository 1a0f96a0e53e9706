#pragma once
// Memory of the graphics card. Internal to points/dexel/gl; no OpenGL header is included here.

#include <cstddef>
#include <cstdint>
#include <memory>
#include <mutex>
#include <utility>
#include <vector>

namespace restroke::points {

/// What the buffers of one context share.
class GlMemory {
 public:
  /// `largestBlock`: bytes that a shader can see of a buffer at once.
  explicit GlMemory(std::size_t largestBlock) : largestBlock_(largestBlock) {}
  [[nodiscard]] std::size_t largestBlock() const { return largestBlock_; }
  /// Buffers end where no context is current: they are set aside, and deleted by the next one who has it.
  void setAside(unsigned name);
  /// The context must be current.
  void deleteWhatIsSetAside();

 private:
  std::size_t largestBlock_;
  std::mutex mutex_;
  std::vector<unsigned> names_;
};

/// A buffer. But for its end, everything needs the context to be current.
class GlBuffer {
 public:
  /// Whether shaders see all of it at once; then it cannot be larger than GlMemory::largestBlock.
  enum class Seen : std::uint8_t { Whole, InParts };
  explicit GlBuffer(std::shared_ptr<GlMemory> memory, Seen seen = Seen::Whole)
      : memory_(std::move(memory)), seen_(seen) {}
  ~GlBuffer();
  GlBuffer(GlBuffer&& other) noexcept { swap(other); }
  GlBuffer& operator=(GlBuffer&& other) noexcept {
    swap(other);
    return *this;
  }

  [[nodiscard]] std::size_t capacity() const { return capacity_; }
  /// Room for so many bytes; where that takes new memory, contents are lost. Throws InputError when there is
  /// none, or shaders would not see it.
  void reserve(std::size_t bytes);
  /// Reserves, then writes from the beginning.
  void write(const void* data, std::size_t bytes);
  /// Reserves, then fills the whole buffer.
  void fill(std::size_t bytes, std::uint32_t value);
  /// Waits for what was computed.
  void read(void* data, std::size_t offset, std::size_t bytes) const;
  [[nodiscard]] std::uint32_t readNumber(std::size_t index) const;
  /// For shaders, at a storage binding.
  void bind(unsigned binding) const;
  /// A part; `offset` is a multiple of 256.
  void bindPart(unsigned binding, std::size_t offset, std::size_t bytes) const;
  [[nodiscard]] unsigned name() const { return name_; }

 private:
  void swap(GlBuffer& other) noexcept;

  std::shared_ptr<GlMemory> memory_;
  Seen seen_ = Seen::Whole;
  unsigned name_ = 0;
  std::size_t capacity_ = 0;
};

}  // namespace restroke::points
