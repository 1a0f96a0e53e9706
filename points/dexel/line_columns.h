#pragma once
// The lines of a family as columns of a `.tridexel` file's body (tridexel_file.h has the format). Internal to
// points/dexel.

#include <cstddef>
#include <cstdint>
#include <span>

#include "points/dexel/dexels.h"
#include "points/dexel/file_bytes.h"

namespace restroke::points {

/// The lines' kind and their ends.
void putLines(ByteWriter& out, const Dexels& dexels);

/// What is known of lines before their ends are read.
struct LinesInFile {
  bool keepsOperations = true;
  std::uint32_t lastOperation = 0;  ///< the highest id that ends may refer to
};
/// Lines of width x height, whose kind has been read. Throws InputError for what breaks a rule.
[[nodiscard]] Dexels getLines(ByteReader& in, int width, int height, const LinesInFile& lines);

/// The histories of lines, which `dexels` keeps.
void putHistories(ByteWriter& out, const Dexels& dexels);
/// `dexels` keeps histories from now on: those that are read. `names`: by id, whether a history may name it
/// (those beyond it are refused).
void getHistories(ByteReader& in, Dexels& dexels, std::span<const std::uint8_t> names);

}  // namespace restroke::points
