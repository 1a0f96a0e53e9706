#pragma once
// The body of a `.tridexel` file (tridexel_file.h has the format): tridexel_writer.cpp makes it,
// tridexel_reader.cpp reads it. Internal to points/dexel.

#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "points/dexel/dexel_document.h"

namespace restroke::points {

/// The lowest version of the format that can hold the document. O(operations).
[[nodiscard]] std::uint32_t versionFor(const TriDexelDocument& document);

/// In that version. Throws InputError as writeTriDexel does; `name` begins its sentences.
[[nodiscard]] std::string formatBody(const TriDexelDocument& document, const std::filesystem::path& name);

/// Throws InputError for what breaks a rule; `where` and the number of a byte begin its sentences.
[[nodiscard]] TriDexelDocument parseBody(std::string_view body, std::uint32_t version,
                                         const std::string& where);

/// By id, whether histories of lines may name it: not the initial solid, and of a run only the first. The
/// runs are of those operations.
[[nodiscard]] std::vector<std::uint8_t> namesInHistories(std::size_t operations,
                                                         std::span<const TriDexelDocument::Run> runs);

}  // namespace restroke::points
