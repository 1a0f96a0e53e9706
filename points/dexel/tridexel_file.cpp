#include "points/dexel/tridexel_file.h"

#include <xxhash.h>
#include <zstd.h>

#include <algorithm>
#include <cerrno>
#include <fstream>
#include <memory>
#include <optional>
#include <system_error>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"
#include "implicit/process_memory.h"
#include "points/dexel/file_bytes.h"
#include "points/dexel/tridexel_body.h"

namespace restroke::points {

namespace {

constexpr std::string_view kMagic = "TRIDEXEL";
constexpr std::uint32_t kLastVersion = 2;
constexpr std::size_t kHeader = 40, kHashed = 32;
// Depths of neighbours differ by noise that no level packs: beyond this one zstd only takes longer.
constexpr int kLevel = 6;

std::uint64_t hashOf(std::string_view start, std::string_view frame) {
  const std::unique_ptr<XXH3_state_t, XXH_errorcode (*)(XXH3_state_t*)> state(XXH3_createState(),
                                                                              XXH3_freeState);
  XXH3_64bits_reset(state.get());
  XXH3_64bits_update(state.get(), start.data(), start.size());
  XXH3_64bits_update(state.get(), frame.data(), frame.size());
  return XXH3_64bits_digest(state.get());
}

// The body of a file whose header says that it is whole and unchanged.
struct Unpacked {
  std::uint32_t version;
  std::string body;
};
Unpacked unpacked(std::string_view contents, const std::filesystem::path& name) {
  const std::string where = fmt::format("{}: byte", name.string());
  ByteReader in(contents, where);
  const auto refuse = [&](std::size_t byte, const std::string& what) {
    throw InputError(fmt::format("{} {}: {}", where, byte, what));
  };
  if (contents.substr(0, kMagic.size()) != kMagic.substr(0, std::min(kMagic.size(), contents.size())))
    refuse(0, fmt::format("this is no tri-dexel model; those begin with \"{}\"", kMagic));
  if (contents.size() < kHeader)
    refuse(contents.size(), fmt::format("the file ends; its header must have {} bytes", kHeader));
  (void)in.take(kMagic.size(), "");
  const auto version = in.get<std::uint32_t>(""), reserved = in.get<std::uint32_t>("");
  const auto size = in.get<std::uint64_t>(""), packed = in.get<std::uint64_t>(""),
             hash = in.get<std::uint64_t>("");
  if (version < 1 || version > kLastVersion)
    refuse(8, fmt::format("this is version {} of the format; versions 1 to {} can be read", version,
                          kLastVersion));
  if (reserved != 0) refuse(12, fmt::format("there is {}; it must be 0", reserved));
  const std::string_view frame = contents.substr(kHeader);
  if (packed != frame.size())
    refuse(24, fmt::format("the packed part is said to have {} bytes and has {}; it must have as many",
                           packed, frame.size()));
  if (hashOf(contents.substr(0, kHashed), frame) != hash)
    refuse(32, "the checksum is another one than that of the contents; they must be as they were written");
  if (ZSTD_getFrameContentSize(frame.data(), frame.size()) != size ||
      ZSTD_findFrameCompressedSize(frame.data(), frame.size()) != frame.size())
    refuse(kHeader, fmt::format("there is no zstd frame of {} bytes that unpacks to {}; there must be one",
                                packed, size));
  if (const std::optional<std::size_t> available = availableBytes(); available && size > *available)
    refuse(16, fmt::format("the model unpacks to {} bytes; {} are free, and it must fit", size, *available));
  std::string body(static_cast<std::size_t>(size), '\0');
  const std::size_t got = ZSTD_decompress(body.data(), body.size(), frame.data(), frame.size());
  if (ZSTD_isError(got) || got != body.size())
    refuse(kHeader, fmt::format("zstd cannot unpack this ({}); it must be one zstd frame",
                                ZSTD_isError(got) ? ZSTD_getErrorName(got) : "too short"));
  return {version, std::move(body)};
}

}  // namespace

std::string formatTriDexel(const TriDexelDocument& document, const std::filesystem::path& name) {
  const std::string body = formatBody(document, name);
  std::string frame(ZSTD_compressBound(body.size()), '\0');
  const std::size_t packed = ZSTD_compress(frame.data(), frame.size(), body.data(), body.size(), kLevel);
  if (ZSTD_isError(packed)) throw InternalError(fmt::format("zstd: {}", ZSTD_getErrorName(packed)));
  frame.resize(packed);
  ByteWriter out;
  out.put(kMagic);
  out.put(versionFor(document));
  out.put(std::uint32_t{0});
  out.put(static_cast<std::uint64_t>(body.size()));
  out.put(static_cast<std::uint64_t>(frame.size()));
  out.put(hashOf(out.bytes(), frame));
  out.put(std::string_view(frame));
  return out.bytes();
}

TriDexelDocument parseTriDexel(std::string_view contents, const std::filesystem::path& name) {
  const Unpacked file = unpacked(contents, name);
  return parseBody(file.body, file.version,
                   fmt::format("{}: byte {} and on, unpacked, byte", name.string(), kHeader));
}

void writeTriDexel(const std::filesystem::path& path, const TriDexelDocument& document) {
  AtomicFile file(path);
  file.write(formatTriDexel(document, path));
  file.commit();
}

TriDexelDocument readTriDexel(const std::filesystem::path& path) {
  namespace fs = std::filesystem;
  std::error_code error;
  // A device may never end.
  if (const auto status = fs::status(path, error);
      fs::is_directory(status) || fs::is_character_file(status) || fs::is_block_file(status))
    throw InputError(fmt::format("{}: is a {}; a .tridexel file is needed", path.string(),
                                 fs::is_directory(status) ? "folder" : "device"));
  errno = 0;
  std::ifstream in(path, std::ios::binary);
  if (!in)
    throw InputError(fmt::format("{}: cannot read this file: {}", path.string(),
                                 std::generic_category().message(errno != 0 ? errno : EIO)));
  const std::string contents{std::istreambuf_iterator<char>(in), {}};
  if (in.bad()) throw InputError(fmt::format("{}: cannot read this file: input/output error", path.string()));
  return parseTriDexel(contents, path);
}

}  // namespace restroke::points
