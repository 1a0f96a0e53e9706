#pragma once
// Zip archives, as far as mesh formats need them: stored and deflated members. The format is described in
// PKWARE's APPNOTE.TXT; packing and unpacking is zlib's.

#include <cstdint>
#include <string>
#include <string_view>
#include <vector>

namespace restroke::points {

/// A member of an archive, as its central directory describes it.
struct ZipMember {
  std::string name;
  std::uint16_t method = 0;  ///< 0 stored, 8 deflated
  std::uint16_t flags = 0;
  std::uint32_t checksum = 0;
  std::uint64_t packedSize = 0;
  std::uint64_t size = 0;
  std::uint64_t offset = 0;  ///< of its local header, from the archive's first byte
};

/// Does it begin like an archive with at least one member?
[[nodiscard]] bool isZip(std::string_view bytes);

/// The members, in the order of the directory. Throws InputError, a sentence without the file's name: no
/// directory (a truncated file), a directory that leaves the file, more than 4 GB (zip64).
[[nodiscard]] std::vector<ZipMember> zipMembers(std::string_view bytes);

/// Unpacks a member. Throws InputError, a sentence without the file's name, when it is encrypted, packed in
/// another way, damaged (its checksum is looked at), or larger than `limit` bytes. Memory grows with what is
/// unpacked, never with what the directory claims.
[[nodiscard]] std::string unzip(std::string_view bytes, const ZipMember& member, std::uint64_t limit);

struct ZipEntry {
  std::string name;
  std::string contents;
};

/// An archive of deflated members, all dated 1980-01-01. Contents below 4 GB.
[[nodiscard]] std::string makeZip(const std::vector<ZipEntry>& entries);

}  // namespace restroke::points
