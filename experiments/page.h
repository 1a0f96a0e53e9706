#pragma once
// The shell of a report: one HTML page that needs nothing else, with tables, figures and pictures inside.

#include <span>
#include <string>
#include <string_view>
#include <utility>

#include "experiments/output.h"

namespace restroke::experiments {

/// Up to and with the heading. HTML 5, UTF-8, without scripts and without anything to fetch.
[[nodiscard]] std::string pageHead(std::string_view title);
[[nodiscard]] std::string_view pageEnd();

/// An image for src=.
[[nodiscard]] std::string dataUri(std::string_view type, std::string_view bytes);
/// An SVG file's text as a figure; nothing for an empty text.
[[nodiscard]] std::string figureHtml(std::string_view svg, std::string_view caption);

/// "Promised and measured", a row for each claim.
[[nodiscard]] std::string claimsSection(std::span<const Claim> claims);

/// "Where this comes from", with a line for each input (file name, hash).
[[nodiscard]] std::string originSection(const Setup& setup, const Provenance& p,
                                        std::span<const std::pair<std::string, std::string>> inputs);

}  // namespace restroke::experiments
