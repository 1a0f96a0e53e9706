#pragma once
// Numbers in the bytes of `.tridexel` files. Internal to points/dexel.

#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>
#include <utility>

#include "implicit/errors.h"

namespace restroke::points {

static_assert(std::endian::native == std::endian::little, "files are written as memory holds numbers");

template <class T>
concept FileNumber = std::integral<T> || std::floating_point<T>;

class ByteWriter {
 public:
  template <FileNumber T>
  void put(T value) {
    bytes_.append(reinterpret_cast<const char*>(&value), sizeof(T));
  }
  void put(std::string_view bytes) { bytes_.append(bytes); }
  [[nodiscard]] const std::string& bytes() const { return bytes_; }

 private:
  std::string bytes_;
};

/// Reads numbers one after the other; what is beyond the end is refused before anything is made of it.
class ByteReader {
 public:
  /// `where` begins sentences: the file, and which of its bytes are counted.
  ByteReader(std::string_view bytes, std::string where) : bytes_(bytes), where_(std::move(where)) {}

  [[nodiscard]] std::size_t left() const { return bytes_.size() - at_; }

  template <FileNumber T>
  [[nodiscard]] T get(std::string_view what) {
    need(1, sizeof(T), what);
    T value;
    std::memcpy(&value, bytes_.data() + at_, sizeof(T));
    at_ += sizeof(T);
    return value;
  }
  [[nodiscard]] std::string_view take(std::size_t count, std::string_view what) {
    need(count, 1, what);
    at_ += count;
    return bytes_.substr(at_ - count, count);
  }
  /// Refuses unless so many things of so many bytes each follow.
  void need(std::uint64_t count, std::size_t size, std::string_view what) const {
    if (count > left() / size)
      refuse(fmt::format("{} take {} x {} bytes, and {} are left; they must be there", what, count, size,
                         left()));
  }
  /// Throws the sentence with the place of the next byte.
  [[noreturn]] void refuse(const std::string& what) const {
    throw InputError(fmt::format("{} {}: {}", where_, at_, what));
  }

 private:
  std::string_view bytes_;
  std::string where_;
  std::size_t at_ = 0;
};

}  // namespace restroke::points
