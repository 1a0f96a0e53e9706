#include "points/files/zip.h"

#include <zlib.h>

#include <algorithm>
#include <array>
#include <cstddef>
#include <functional>
#include <limits>

#include "implicit/errors.h"

namespace restroke::points {
namespace {

constexpr std::uint32_t kLocalHeader = 0x04034b50, kDirectoryEntry = 0x02014b50, kDirectoryEnd = 0x06054b50;
constexpr std::size_t kLocalHeaderSize = 30, kDirectoryEntrySize = 46, kDirectoryEndSize = 22;
/// MS-DOS date of 1980-01-01, the first that there is.
constexpr std::uint16_t kDate = 1 << 5 | 1;

/// Little-endian numbers; the caller has made sure that they are inside.
std::uint16_t u16(std::string_view bytes, std::size_t at) {
  const auto byte = [&](std::size_t i) { return static_cast<unsigned char>(bytes[at + i]); };
  return static_cast<std::uint16_t>(byte(0) | byte(1) << 8);
}
std::uint32_t u32(std::string_view bytes, std::size_t at) {
  return u16(bytes, at) | static_cast<std::uint32_t>(u16(bytes, at + 2)) << 16;
}

void append16(std::string& out, std::size_t value) {
  out.push_back(static_cast<char>(value & 0xff));
  out.push_back(static_cast<char>(value >> 8 & 0xff));
}
void append32(std::string& out, std::size_t value) {
  append16(out, value & 0xffff);
  append16(out, value >> 16 & 0xffff);
}

bool fits(std::string_view bytes, std::uint64_t at, std::uint64_t size) {
  return at <= bytes.size() && size <= bytes.size() - at;
}

/// Where the end record is, which a comment of up to 65535 bytes may follow.
std::size_t findDirectoryEnd(std::string_view bytes) {
  if (bytes.size() >= kDirectoryEndSize) {
    const std::size_t last = bytes.size() - kDirectoryEndSize;
    for (std::size_t back = 0; back <= std::min<std::size_t>(last, 65535); ++back)
      if (u32(bytes, last - back) == kDirectoryEnd && u16(bytes, last - back + 20) == back)
        return last - back;
  }
  throw InputError("a zip archive without its directory at the end; is the file complete?");
}

/// zlib's streams, which want to be closed.
class Stream {
 public:
  explicit Stream(bool packs) : packs_(packs) {
    // Negative: without zlib's own header, as in zip archives.
    const int result =
        packs ? deflateInit2(&z, Z_DEFAULT_COMPRESSION, Z_DEFLATED, -MAX_WBITS, 8, Z_DEFAULT_STRATEGY)
              : inflateInit2(&z, -MAX_WBITS);
    if (result != Z_OK) throw InternalError("zlib does not start");
  }
  ~Stream() {
    if (packs_)
      deflateEnd(&z);
    else
      inflateEnd(&z);
  }
  Stream(const Stream&) = delete;
  Stream& operator=(const Stream&) = delete;

  /// zlib does not write to what it reads, in spite of its type.
  void give(std::string_view input) {
    z.next_in = const_cast<Bytef*>(reinterpret_cast<const Bytef*>(input.data()));
    z.avail_in = static_cast<uInt>(input.size());
  }
  /// Where the next piece of output goes.
  template <std::size_t N>
  void take(std::array<char, N>& piece) {
    z.next_out = reinterpret_cast<Bytef*>(piece.data());
    z.avail_out = static_cast<uInt>(N);
  }

  z_stream z{};

 private:
  bool packs_;
};

using Piece = std::array<char, 1 << 16>;

std::string inflated(std::string_view packed, std::uint64_t limit, const std::string& name) {
  Stream stream(false);
  std::string out;
  Piece piece;
  stream.give(packed);
  for (int result = Z_OK; result != Z_STREAM_END;) {
    stream.take(piece);
    result = inflate(&stream.z, Z_NO_FLUSH);
    const std::size_t size = piece.size() - stream.z.avail_out;
    if ((result != Z_OK && result != Z_STREAM_END) || (result == Z_OK && size == 0))
      throw InputError(fmt::format("the zip member {} is damaged: it cannot be unpacked", name));
    if (out.size() + size > limit)
      throw InputError(
          fmt::format("the zip member {} unpacks to more than {} bytes, the limit", name, limit));
    out.append(piece.data(), size);
  }
  return out;
}

std::string deflated(std::string_view contents) {
  Stream stream(true);
  std::string out;
  Piece piece;
  stream.give(contents);
  for (int result = Z_OK; result != Z_STREAM_END;) {
    stream.take(piece);
    result = deflate(&stream.z, Z_FINISH);
    out.append(piece.data(), piece.size() - stream.z.avail_out);
  }
  return out;
}

std::uint32_t checksumOf(std::string_view bytes) {
  uLong sum = crc32(0, nullptr, 0);
  for (std::size_t at = 0; at < bytes.size();) {
    const std::size_t size = std::min<std::size_t>(bytes.size() - at, std::size_t{1} << 30);
    sum = crc32(sum, reinterpret_cast<const Bytef*>(bytes.data() + at), static_cast<uInt>(size));
    at += size;
  }
  return static_cast<std::uint32_t>(sum);
}

}  // namespace

bool isZip(std::string_view bytes) {
  return bytes.size() >= kLocalHeaderSize && u32(bytes, 0) == kLocalHeader;
}

std::vector<ZipMember> zipMembers(std::string_view bytes) {
  const std::size_t end = findDirectoryEnd(bytes);
  const std::size_t count = u16(bytes, end + 10);
  std::uint64_t at = u32(bytes, end + 16);
  std::vector<ZipMember> members;
  for (std::size_t i = 0; i < count; ++i) {
    if (!fits(bytes, at, kDirectoryEntrySize) || u32(bytes, at) != kDirectoryEntry)
      throw InputError(fmt::format("entry {} of the zip directory, at byte {}, is not one", i, at));
    const std::size_t nameSize = u16(bytes, at + 28);
    if (!fits(bytes, at + kDirectoryEntrySize, nameSize))
      throw InputError(fmt::format("entry {} of the zip directory, at byte {}, leaves the file", i, at));
    ZipMember m;
    m.flags = u16(bytes, at + 8);
    m.method = u16(bytes, at + 10);
    m.checksum = u32(bytes, at + 16);
    m.packedSize = u32(bytes, at + 20);
    m.size = u32(bytes, at + 24);
    m.offset = u32(bytes, at + 42);
    m.name = bytes.substr(at + kDirectoryEntrySize, nameSize);
    constexpr std::uint64_t kIsElsewhere = 0xffffffff;
    if (m.packedSize == kIsElsewhere || m.size == kIsElsewhere || m.offset == kIsElsewhere)
      throw InputError(
          fmt::format("the zip member {} is of the zip64 kind (4 GB or more); that is not read", m.name));
    at += kDirectoryEntrySize + nameSize + u16(bytes, at + 30) + u16(bytes, at + 32);
    members.push_back(std::move(m));
  }
  return members;
}

std::string unzip(std::string_view bytes, const ZipMember& member, std::uint64_t limit) {
  const auto fail = [&](const char* what) {
    throw InputError(fmt::format("the zip member {} {}", member.name, what));
  };
  if (member.flags & 1) fail("is encrypted; that is not read");
  if (member.method != 0 && member.method != Z_DEFLATED)
    fail("is packed in a way that is neither stored nor deflated");
  if (!fits(bytes, member.offset, kLocalHeaderSize) || u32(bytes, member.offset) != kLocalHeader)
    fail("does not begin where the directory says");
  const std::uint64_t begin =
      member.offset + kLocalHeaderSize + u16(bytes, member.offset + 26) + u16(bytes, member.offset + 28);
  if (!fits(bytes, begin, member.packedSize)) fail("leaves the file");
  const std::string_view packed = bytes.substr(begin, member.packedSize);
  if (member.method == 0 && packed.size() > limit) fail("is larger than the limit");
  std::string contents = member.method == 0 ? std::string(packed) : inflated(packed, limit, member.name);
  if (contents.size() != member.size || checksumOf(contents) != member.checksum)
    fail("is damaged: its size or checksum is not that of the directory");
  return contents;
}

std::string makeZip(const std::vector<ZipEntry>& entries) {
  std::string out, directory;
  for (const ZipEntry& entry : entries) {
    constexpr std::size_t kLargest = std::numeric_limits<std::uint32_t>::max() - 1;
    if (entry.contents.size() > kLargest)
      throw InputError(fmt::format("{} takes {} bytes; a zip member holds less than 4 GB", entry.name,
                                   entry.contents.size()));
    const std::string packed = deflated(entry.contents);
    if (out.size() > kLargest - packed.size() - entry.name.size() - kLocalHeaderSize)
      throw InputError("the zip archive would be 4 GB or more; it can be less");
    const std::size_t offset = out.size();
    std::string common;    // to both headers
    append16(common, 20);  // deflating needs version 2.0
    append16(common, 0);
    append16(common, Z_DEFLATED);
    append16(common, 0);
    append16(common, kDate);
    append32(common, checksumOf(entry.contents));
    append32(common, packed.size());
    append32(common, entry.contents.size());
    append16(common, entry.name.size());
    append16(common, 0);
    append32(out, kLocalHeader);
    for (const std::string& part : {std::cref(common), std::cref(entry.name), std::cref(packed)}) out += part;
    append32(directory, kDirectoryEntry);
    append16(directory, 20);
    directory += common;
    append16(directory, 0);  // comment
    append16(directory, 0);  // disk
    append16(directory, 0);  // internal attributes
    append32(directory, 0);  // external attributes
    append32(directory, offset);
    directory += entry.name;
  }
  const std::size_t begin = out.size();
  out += directory;
  append32(out, kDirectoryEnd);
  append32(out, 0);  // this disk and the directory's
  append16(out, entries.size());
  append16(out, entries.size());
  append32(out, directory.size());
  append32(out, begin);
  append16(out, 0);
  return out;
}

}  // namespace restroke::points
