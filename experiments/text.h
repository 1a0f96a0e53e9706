#pragma once
// Numbers and text for tables.

#include <cstddef>
#include <cstdint>
#include <functional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace restroke::experiments {

/// 1234567 as "1,234,567".
[[nodiscard]] std::string grouped(std::uint64_t number);

/// A field of a CSV file: quoted when it holds a comma, a quote or a line break (RFC 4180).
[[nodiscard]] std::string csvField(std::string_view text);

/// Text for HTML, between tags and in quoted attributes.
[[nodiscard]] std::string escapeHtml(std::string_view text);

/// RFC 4648, with padding.
[[nodiscard]] std::string base64(std::string_view bytes);

/// At most `most` (two or more) of the indices 0 to count - 1, evenly spread, first and last among them.
[[nodiscard]] std::vector<std::size_t> thinned(std::size_t count, std::size_t most);

/// The stem, or STEM-2, STEM-3 and so on: the first one that is not taken.
[[nodiscard]] std::string untakenName(const std::string& stem,
                                      const std::function<bool(std::string_view)>& taken);

/// Lines of equally wide columns; the first `left` columns are aligned to the left, the others to the right.
[[nodiscard]] std::string alignedTable(std::span<const std::vector<std::string>> lines, std::size_t left = 0);

}  // namespace restroke::experiments
