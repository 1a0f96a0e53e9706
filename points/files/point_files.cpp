#include "points/files/point_files.h"

#include <array>
#include <bit>
#include <cmath>
#include <iterator>

#include "implicit/atomic_file.h"
#include "implicit/errors.h"

namespace restroke::points {
namespace {

/// x y z nx ny nz radius
using Row = std::array<float, 7>;

Row rowOf(const Surfel& s) {
  return {s.position.x, s.position.y, s.position.z, s.normal.x, s.normal.y, s.normal.z, s.radius};
}

void checkFinite(const std::filesystem::path& path, std::span<const Surfel> surfels) {
  for (std::size_t i = 0; i < surfels.size(); ++i)
    for (const float value : rowOf(surfels[i]))
      if (!std::isfinite(value))
        throw InputError(fmt::format("{}: point {} has the value {}; only finite numbers can be stored",
                                     path.string(), i, value));
}

/// fmt's default for float is the shortest text that reads back as the same number.
void appendText(fmt::memory_buffer& out, std::span<const float> values) {
  for (std::size_t i = 0; i < values.size(); ++i)
    fmt::format_to(std::back_inserter(out), "{}{}", values[i], i + 1 < values.size() ? ' ' : '\n');
}

void appendBinary(fmt::memory_buffer& out, std::span<const float> values) {
  for (const float value : values) {
    const auto bits = std::bit_cast<std::uint32_t>(value);
    const char bytes[4] = {static_cast<char>(bits & 0xff), static_cast<char>(bits >> 8 & 0xff),
                           static_cast<char>(bits >> 16 & 0xff), static_cast<char>(bits >> 24)};
    out.append(bytes, bytes + 4);
  }
}

}  // namespace

void writePly(const std::filesystem::path& path, std::span<const Surfel> surfels, const PlyOptions& options) {
  const bool ascii = options.format == PlyFormat::Ascii;
  fmt::memory_buffer out;
  const auto line = [&](std::string_view text) {
    out.append(text);
    out.push_back('\n');
  };
  line("ply");
  line(ascii ? "format ascii 1.0" : "format binary_little_endian 1.0");
  for (const std::string& comment : options.comments) {
    if (comment.find_first_of("\r\n") != std::string::npos)
      throw InputError(
          fmt::format("{}: a comment has a line break; a PLY header has one comment a line", path.string()));
    line("comment " + comment);
  }
  line(fmt::format("element vertex {}", surfels.size()));
  for (const char* name : {"x", "y", "z", "nx", "ny", "nz", "radius"})
    line(fmt::format("property float {}", name));
  line("end_header");
  checkFinite(path, surfels);
  out.reserve(out.size() + surfels.size() * (ascii ? 80 : sizeof(Row)));
  for (const Surfel& surfel : surfels)
    ascii ? appendText(out, rowOf(surfel)) : appendBinary(out, rowOf(surfel));
  writeFileAtomically(path, std::string_view(out.data(), out.size()));
}

void writeXyz(const std::filesystem::path& path, std::span<const Surfel> surfels) {
  checkFinite(path, surfels);
  fmt::memory_buffer out;
  out.reserve(surfels.size() * 70);
  for (const Surfel& surfel : surfels) {
    const Row row = rowOf(surfel);
    appendText(out, std::span(row).first(6));
  }
  writeFileAtomically(path, std::string_view(out.data(), out.size()));
}

}  // namespace restroke::points
